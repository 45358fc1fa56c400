// Preconditioner of mixtures that separate, [B  M/h; M -A] of potentials and contents: M of mass, B of
// diffusion, A of the energy's second derivatives. Block triangular, [M 0; B S] with the Schur complement
//     S = M/h + B M^-1 A  taken as  H M^-1 H with H = M / sqrt(h) + sqrt(beta) B,
// where beta B is what of A is no multiple of M (Axelsson, Boyanova, Kronbichler, Neytcheva & Wu 2013): right
// for long steps and short ones. H is solved by a cycle of multigrid, M by a polynomial.
#include <algorithm>
#include <cmath>

#include "visviva/linear/krylov/precondition.hpp"

namespace visviva {

namespace {

using Vector = std::vector<double>;

// A block as values on the pattern that all four share.
void multiply(const Csr& p, const Vector& a, const Vector& x, Vector& y) {
    for (int i = 0; i < p.n; ++i) {
        double sum = 0;
        for (auto k = p.row[i]; k < p.row[i + 1]; ++k) sum += a[k] * x[p.col[k]];
        y[i] = sum;
    }
}

double product(const Vector& a, const Vector& b) {
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
    return sum;
}

class Mixture : public Preconditioning {
  public:
    explicit Mixture(const LinearChoice& choice) : inner_(make_multigrid(choice)) {}

    bool build(const NodeMatrix& matrix) override {
        if (pattern_.n == 0 && !number(matrix)) return false;
        take_blocks(matrix.blocks());
        const double per_step = product(rate_, mass_) / product(mass_, mass_);
        const double bb = product(flow_, flow_), bm = product(flow_, mass_), mm = product(mass_, mass_);
        const double ab = product(energy_, flow_), am = product(energy_, mass_);
        const double beta = (ab * mm - am * bm) / (bb * mm - bm * bm);
        if (!(per_step > 0 && beta > 0)) return message = "these are no contents with potentials", false;
        for (std::size_t k = 0; k < mass_.size(); ++k)
            half_[k] = std::sqrt(per_step) * mass_[k] + std::sqrt(beta) * flow_[k];
        nodes_.fill(half_.data());
        bound_mass();
        if (inner_->build(nodes_)) return true;
        return message = inner_->message, false;
    }

    // mu = M^-1 r2, c = S^-1 (r1 - B mu)
    void apply(const double* r, double* z) override {
        for (int i = 0; i < pattern_.n; ++i) b_[i] = r[potential_[i]];
        solve_mass(b_, x_);
        for (int i = 0; i < pattern_.n; ++i) z[potential_[i]] = x_[i];
        multiply(pattern_, flow_, x_, y_);
        for (int i = 0; i < pattern_.n; ++i) b_[i] = r[content_[i]] - y_[i];
        inner_->apply(b_.data(), x_.data());
        multiply(pattern_, mass_, x_, b_);
        inner_->apply(b_.data(), x_.data());
        for (int i = 0; i < pattern_.n; ++i) z[content_[i]] = x_[i];
    }

    void learn(int iterations) override { inner_->learn(iterations); }
    bool kept() const override { return inner_->kept(); }
    void forget() override { inner_->forget(); }
    double memory() const override { return inner_->memory() + 40.0 * static_cast<double>(mass_.size()); }
    const char* name() const override { return "contents by their complement with multigrid"; }

  private:
    // The k-th content belongs to the k-th potential, and all four blocks have one pattern.
    bool number(const NodeMatrix& matrix) {
        const BlockRows<double>& a = matrix.blocks();
        Csr p;
        std::vector<int> at(a.n());
        content_.clear(), potential_.clear();
        for (int i = 0; i < a.n(); ++i) {
            auto& of = matrix.algebraic()[i] ? potential_ : content_;
            at[i] = static_cast<int>(of.size()), of.push_back(i);
        }
        bool fits = a.rows == 1 && content_.size() == potential_.size();
        p.n = static_cast<int>(potential_.size()), p.row.assign(1, 0);
        for (int i = 0; fits && i < p.n; ++i) {
            std::size_t contents = 0;
            for (auto k = a.row[potential_[i]]; k < a.row[potential_[i] + 1]; ++k)
                if (matrix.algebraic()[a.col[k]])
                    p.col.push_back(at[a.col[k]]);
                else
                    ++contents;
            p.row.push_back(static_cast<std::int64_t>(p.col.size()));
            fits = contents == p.col.size() - p.row[i] &&
                   a.row[content_[i] + 1] - a.row[content_[i]] == static_cast<std::int64_t>(2 * contents);
        }
        if (!fits) return message = "these are no contents with as many potentials, and nothing else", false;
        pattern_ = std::move(p);
        for (auto* v : {&mass_, &flow_, &energy_, &rate_, &half_}) v->assign(pattern_.col.size(), 0.0);
        for (auto* v : {&b_, &x_, &y_, &step_, &rest_}) v->assign(pattern_.n, 0.0);
        is_potential_ = matrix.algebraic();
        nodes_.analyze(pattern_, {});
        return true;
    }

    void take_blocks(const BlockRows<double>& a) {
        for (int i = 0; i < pattern_.n; ++i) {
            auto m = pattern_.row[i], e = m, b = m, r = m;
            for (auto k = a.row[potential_[i]]; k < a.row[potential_[i] + 1]; ++k)
                is_potential_[a.col[k]] ? mass_[m++] = a.value[k] : energy_[e++] = -a.value[k];
            for (auto k = a.row[content_[i]]; k < a.row[content_[i] + 1]; ++k)
                is_potential_[a.col[k]] ? flow_[b++] = a.value[k] : rate_[r++] = a.value[k];
        }
    }

    // Largest eigenvalue of the mass with its diagonal inverted, by Gershgorin's circles.
    void bound_mass() {
        inverse_.assign(pattern_.n, 0.0), largest_ = 1;
        for (int i = 0; i < pattern_.n; ++i) {
            double sum = 0, diagonal = 1;
            for (auto k = pattern_.row[i]; k < pattern_.row[i + 1]; ++k) {
                sum += std::abs(mass_[k]);
                if (pattern_.col[k] == i) diagonal = mass_[k];
            }
            inverse_[i] = 1 / diagonal, largest_ = std::max(largest_, sum / diagonal);
        }
    }

    // x = p(M) b with Chebyshev's polynomial between the largest eigenvalue and a share of it, which is one
    // where the mass is diagonal.
    void solve_mass(const Vector& b, Vector& x) {
        constexpr int degree = 6;
        constexpr double spread =
            8;  // the largest eigenvalue times the smallest one's inverse is at most its square
        const double lower = largest_ > 1 + 1e-9 ? largest_ / std::min(27.0, spread * largest_) : 1;
        const double middle = 0.5 * (largest_ + lower),
                     half = std::max(0.5 * (largest_ - lower), 1e-9 * middle);
        double rho = half / middle;
        rest_ = b;
        std::fill(x.begin(), x.end(), 0.0);
        for (int k = 0; k < degree; ++k) {
            const double next = 1 / (2 * middle / half - rho);
            const double old = k == 0 ? 0 : next * rho, add = k == 0 ? 1 / middle : 2 * next / half;
            if (k > 0) rho = next;
            for (int i = 0; i < pattern_.n; ++i)
                step_[i] = old * step_[i] + add * inverse_[i] * rest_[i], x[i] += step_[i];
            if (largest_ <= 1 + 1e-9 || k + 1 == degree) return;
            multiply(pattern_, mass_, step_, y_);
            for (int i = 0; i < pattern_.n; ++i) rest_[i] -= y_[i];
        }
    }

    std::unique_ptr<Preconditioning> inner_;
    Csr pattern_;
    NodeMatrix nodes_;
    std::vector<char> is_potential_;
    std::vector<int> content_, potential_;
    Vector mass_, flow_, energy_, rate_, half_, inverse_, b_, x_, y_, step_, rest_;
    double largest_ = 1;
};

}  // namespace

std::unique_ptr<Preconditioning> make_mixture(const LinearChoice& choice) {
    return std::make_unique<Mixture>(choice);
}

}  // namespace visviva
