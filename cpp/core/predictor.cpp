#include "predictor.hpp"

#include <algorithm>

namespace visviva {

namespace {

// Weights of the last, the last but one, ... increment when so many are known: polynomial extrapolation.
constexpr double weights[4][3] = {{0, 0, 0}, {1, 0, 0}, {2, -1, 0}, {3, -3, 1}};

void cross(const double* a, const double* b, double* c) {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

// Sum of d_i x e_i over the directors.
void turning(const RigidUnknowns& body, const double* d, const double* e, double* sum) {
    sum[0] = sum[1] = sum[2] = 0;
    for (int k = 0; k < 3; ++k) {
        const int* q = body.q + 3 + 3 * k;
        const double a[3] = {d[q[0]], d[q[1]], d[q[2]]}, b[3] = {e[q[0]], e[q[1]], e[q[2]]};
        double c[3];
        cross(a, b, c);
        for (int i = 0; i < 3; ++i) sum[i] += c[i];
    }
}

}  // namespace

void Predictor::resize(int n_unknowns, std::vector<RigidUnknowns> rigid) {
    rigid_ = std::move(rigid);
    for (auto& a : dx_) a.assign(n_unknowns, 0.0);
    for (auto& a : turn_) a.assign(3 * rigid_.size(), 0.0);
    known_ = 0;
}

void Predictor::predict(int begin, int end, double h, const double* v, double* dx) const {
    const double* w = weights[usable(h)];
    const double *a = dx_[0].data(), *b = dx_[1].data(), *c = dx_[2].data();
    switch (usable(h)) {
        case 0:
            for (int i = begin; i < end; ++i) dx[i] = h * v[i];
            break;
        case 3:
            for (int i = begin; i < end; ++i) dx[i] = w[0] * a[i] + w[1] * b[i] + w[2] * c[i];
            break;
        default:
            for (int i = begin; i < end; ++i) dx[i] = w[0] * a[i] + w[1] * b[i];
    }
}

void Predictor::predict_multipliers(int begin, int end, double h, double* dx) const {
    const double* w = weights[std::max(usable(h) - 1, 0)];
    for (int i = begin; i < end; ++i) dx[i] = w[0] * dx_[0][i] + w[1] * dx_[1][i];
}

void Predictor::predict_rotations(double h, const double* x, const double* v, double* dx) const {
    const double* w = weights[usable(h)];
    for (std::size_t body = 0; body < rigid_.size(); ++body) {
        double t[3];
        if (usable(h) == 0) {  // angular velocity d_i x d_i' / 2
            turning(rigid_[body], x, v, t);
            for (double& c : t) c *= 0.5 * h;
        } else {
            for (int c = 0; c < 3; ++c) {
                const std::size_t k = 3 * body + c;
                t[c] = w[0] * turn_[0][k] + w[1] * turn_[1][k] + w[2] * turn_[2][k];
            }
        }
        const double f = 1 / (1 + 0.25 * (t[0] * t[0] + t[1] * t[1] + t[2] * t[2]));
        for (int k = 0; k < 3; ++k) {
            const int* q = rigid_[body].q + 3 + 3 * k;
            const double d[3] = {x[q[0]], x[q[1]], x[q[2]]};
            double once[3], twice[3];
            cross(t, d, once);
            cross(t, once, twice);
            for (int c = 0; c < 3; ++c) dx[q[c]] = f * (once[c] + 0.5 * twice[c]);
        }
    }
}

void Predictor::record(const double* x0, const double* dx, double h) {
    if (h != h_) known_ = 0;
    h_ = h, known_ = std::min(known_ + 1, 3);
    std::rotate(dx_, dx_ + 2, dx_ + 3);
    std::rotate(turn_, turn_ + 2, turn_ + 3);
    std::copy(dx, dx + dx_[0].size(), dx_[0].begin());
    for (std::size_t body = 0; body < rigid_.size(); ++body) {
        // sum d_i x (d_i + dd_i) = 2 sin(angle) n, sum d_i . dd_i = 2 (cos(angle) - 1); Cayley's is 2
        // tan(angle/2) n
        double s[3], trace = 4;
        turning(rigid_[body], x0, dx, s);
        for (int k = 3; k < 12; ++k) trace += x0[rigid_[body].q[k]] * dx[rigid_[body].q[k]];
        for (int c = 0; c < 3; ++c) turn_[0][3 * body + c] = 2 * s[c] / std::max(trace, 1e-3);
    }
}

void Predictor::write(std::vector<double>& memory) const {
    memory.push_back(known_), memory.push_back(h_);
    for (const auto& a : dx_) memory.insert(memory.end(), a.begin(), a.end());
    for (const auto& a : turn_) memory.insert(memory.end(), a.begin(), a.end());
}

const double* Predictor::read(const double* memory) {
    known_ = static_cast<int>(*memory++), h_ = *memory++;
    auto take = [&memory](std::vector<double>& a) {
        std::copy(memory, memory + a.size(), a.begin());
        memory += a.size();
    };
    for (auto& a : dx_) take(a);
    for (auto& a : turn_) take(a);
    return memory;
}

}  // namespace visviva
