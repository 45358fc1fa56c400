// Materials that tests share, and their answers as matrices.
#pragma once
#include "dense.hpp"
#include "visviva/material/response.hpp"

namespace visviva::isa_test {

using Eigen::Matrix3d, Eigen::MatrixXd, Eigen::VectorXd;
using Six = Eigen::Matrix<double, 6, 1>;

struct Material {
    std::string name;
    MaterialKind kind;
    std::vector<double> par;
};

inline Six tensor(const Matrix3d& a) {
    Six s;
    for (int k = 0; k < 6; ++k) s[k] = a(voigt_a[k], voigt_b[k]);
    return s;
}
inline Matrix3d matrix(const Six& s) {
    Matrix3d a;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) a(i, j) = s[voigt[i][j]];
    return a;
}

inline std::vector<double> fibres(const Matrix3d& turn) {
    std::vector<double> all;
    for (double angle : {0.5, -0.9}) {
        const Eigen::Vector3d a = turn * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.2).normalized();
        const Six s = tensor(a * a.transpose());
        all.insert(all.end(), s.begin(), s.end());
    }
    return all;
}

inline Material holzapfel_fibres(const Matrix3d& turn) {
    Material m{"holzapfel", MaterialKind::holzapfel, {1.1, 0.7, 1.9, 0.1, 6, 2}};
    for (double a : fibres(turn)) m.par.push_back(a);
    return m;
}

inline const std::vector<Material> materials = {
    {"hooke", MaterialKind::hooke, {3, 1.2}},
    {"neo-hooke", MaterialKind::neo_hooke, {1.2, 3, 0}},
    {"neo-hooke, simo", MaterialKind::neo_hooke, {1.2, 3, 2}},
    {"mooney", MaterialKind::mooney, {0.7, 0.3, 2 * 0.7 + 4 * 0.3, 4, 1}},
    {"isochoric", MaterialKind::isochoric, {0.6, 0.2, 0.1, 0.3, 5, 0}},
    {"gent", MaterialKind::gent, {1.3, 20, 4, 2}},
    {"ogden", MaterialKind::ogden, {4, 1, 1, 1.1, 1.8, 0.3, -2.2, 0.2, 5}},
    {"ogden, not split", MaterialKind::ogden, {4, 0, 0, 1.1, 1.8, 0.3, -2.2, 0, 1}},
    {"blatz-ko", MaterialKind::blatz_ko, {1.4, 0.8}},
    holzapfel_fibres(Matrix3d::Identity()),
};

struct Parameters {
    V p[material_max_parameters] = {};
    explicit Parameters(const std::vector<double>& par) {
        for (std::size_t k = 0; k < par.size(); ++k) p[k] = broadcast(par[k]);
    }
};

struct Answer {
    double W;
    Six s;
    Eigen::Matrix<double, 6, 6> d;  // over tensor components
};

inline Answer answer(const Response& r) {
    Answer a{r.W[W - 1], {}, {}};
    for (int k = 0; k < 6; ++k) {
        a.s[k] = r.s[k][W - 1];
        for (int l = k; l < 6; ++l) a.d(k, l) = a.d(l, k) = r.d[packed(6, k, l)][W - 1];
    }
    return a;
}

inline Answer respond_to(const Material& m, const Six& c) {
    V x[6];
    for (int k = 0; k < 6; ++k) x[k] = broadcast(c[k]);
    Response r;
    respond<true>(m.kind, x, Parameters(m.par).p, r);
    return answer(r);
}

/// Differences vary a component on both sides of the diagonal at once.
inline Six multiplicities() { return Six(1, 1, 1, 2, 2, 2); }

}  // namespace visviva::isa_test
