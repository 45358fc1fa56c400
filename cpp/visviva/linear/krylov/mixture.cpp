// Preconditioner of mixtures that separate, [M -A; B M/h] of potentials and contents: M of mass, B of
// diffusion, A of the energy's second derivatives. With beta B, what of A is no multiple of M, and potentials
// in units of sqrt(beta/h) it is taken as
//     [M -K; K M + 2 K],  K = sqrt(beta h) B,
// right for long steps and short ones, which takes two solutions with H = M + K, and none with M (Axelsson,
// Boyanova, Kronbichler, Neytcheva & Wu 2013; Axelsson, Farouq & Neytcheva 2016). Where all of H's spectrum
// is narrow, as in steps that resolve the interfaces, a polynomial stands for its inverse, else a cycle of
// multigrid.
#include <algorithm>
#include <cmath>

#include "visviva/linear/krylov/multigrid.hpp"
#include "visviva/linear/krylov/smoother.hpp"

namespace visviva {

namespace {

using Vector = std::vector<float>;

constexpr float reduction = 0.1F;  // of errors by the polynomial
constexpr int highest_degree = 9;  // up to which it takes less than multigrid

class Mixture : public Preconditioning {
  public:
    explicit Mixture(const LinearChoice& choice) : grids_(make_grids(choice.aggregator)) {}

    bool build(const NodeMatrix& matrix) override {
        const BlockRows<double>& a = matrix.blocks();
        if (slots_.empty() && !number(matrix)) return false;
        if (!weigh(a)) return message = "these are no contents with potentials", false;
        const double share = std::sqrt(beta_ / per_step_);
        double largest = 0;
        for (std::size_t k = 0; k < a.col.size(); ++k) {
            half_.value[k] = value(a, k, potential, potential) + share * value(a, k, content, potential);
            largest = std::max(largest, half_.value[k]);
        }
        scale_ = 1 / largest;
        // Volumes of small units are nothing in single precision.
        for (std::size_t k = 0; k < a.col.size(); ++k) {
            half_.value[k] *= scale_;
            coupling_.value[k] = static_cast<float>(scale_ * share * value(a, k, content, potential));
        }
        return build_inverse();
    }

    // H w = f + g, H c = g - K w of the residuals f and g; then the potential is w - c.
    void apply(const double* r, double* z) override {
        const std::size_t n = 2 * b_.size();
        const double unit = std::sqrt(beta_ * per_step_);
        double largest = 0;
        for (std::size_t i = 0; i < b_.size(); ++i)
            largest = std::max({largest, std::abs(r[2 * i + slots_[content]]) / per_step_,
                                std::abs(r[2 * i + slots_[potential]]) / unit});
        if (largest == 0) return std::fill(z, z + n, 0.0);
        const double of_potentials = 1 / (largest * unit), of_contents = 1 / (largest * per_step_);
        for (std::size_t i = 0; i < b_.size(); ++i) {
            g_[i] = static_cast<float>(of_contents * r[2 * i + slots_[content]]);
            b_[i] = static_cast<float>(of_potentials * r[2 * i + slots_[potential]]) + g_[i];
        }
        solve(b_, w_);
        multiply(coupling_, w_, b_, [&](std::size_t i) { b_[i] = g_[i] - b_[i]; });
        solve(b_, c_);
        for (std::size_t i = 0; i < b_.size(); ++i) {
            z[2 * i + slots_[content]] = largest * scale_ * c_[i];
            z[2 * i + slots_[potential]] = largest * scale_ * unit * (w_[i] - c_[i]);
        }
    }

    double memory() const override {
        return (polynomial_ ? polynomial_->memory() : grids_->memory()) +
               20.0 * static_cast<double>(half_.col.size());
    }
    const char* name() const override { return "contents beside their potentials"; }

  private:
    enum Place { content, potential };

    // Of the coupling of two nodes: the row of the one by the column of the other.
    double value(const BlockRows<double>& a, std::size_t k, Place row, Place column) const {
        return a.value[4 * k + 2 * slots_[column] + slots_[row]];
    }

    // All nodes have a content and a potential, and in the same order.
    bool number(const NodeMatrix& matrix) {
        const BlockRows<double>& a = matrix.blocks();
        const auto& kinds = matrix.kinds();
        const int first = a.rows == 2 && kinds[0] == NodeMatrix::Kind::algebraic ? 1 : 0;
        bool fits = a.rows == 2;
        for (std::size_t i = 0; fits && i < kinds.size(); i += 2)
            fits = kinds[i + first] == NodeMatrix::Kind::differential &&
                   kinds[i + 1 - first] == NodeMatrix::Kind::algebraic;
        if (!fits) return message = "these are no contents with as many potentials, and nothing else", false;
        slots_ = {first, 1 - first};
        half_.row = coupling_.row = a.row, half_.col = coupling_.col = a.col;
        half_.allocate(), coupling_.allocate();
        for (Vector* v : {&b_, &g_, &w_, &c_}) v->resize(a.n());
        for (auto* v : {&wide_b_, &wide_x_}) v->resize(a.n());
        return true;
    }

    // M / h over M, and the share of B in A beside one of M, by least squares over the entries.
    bool weigh(const BlockRows<double>& a) {
        double bb = 0, bm = 0, mm = 0, ab = 0, am = 0, rm = 0;
        for (std::size_t k = 0; k < a.col.size(); ++k) {
            const double m = value(a, k, potential, potential), b = value(a, k, content, potential);
            const double second = -value(a, k, potential, content);
            bb += b * b, bm += b * m, mm += m * m, ab += second * b, am += second * m;
            rm += value(a, k, content, content) * m;
        }
        per_step_ = rm / mm, beta_ = (ab * mm - am * bm) / (bb * mm - bm * bm);
        return per_step_ > 0 && beta_ > 0;
    }

    bool build_inverse() {
        polynomial_ = std::make_unique<Smoother>(half_, 1.0);
        if (polynomial_->damp_all(reduction) <= highest_degree) return true;
        polynomial_.reset();
        return grids_->build(half_, {}) || (message = grids_->message, false);
    }

    void solve(const Vector& b, Vector& x) {
        if (polynomial_) {
            polynomial_->smooth(b, x, true);
        } else {
            std::copy(b.begin(), b.end(), wide_b_.begin());
            grids_->apply(wide_b_.data(), wide_x_.data());
            std::transform(wide_x_.begin(), wide_x_.end(), x.begin(),
                           [](double v) { return static_cast<float>(v); });
        }
    }

    std::unique_ptr<Grids> grids_;
    std::unique_ptr<Smoother> polynomial_;
    std::vector<int> slots_;  // of a node's content and potential
    BlockRows<double> half_;  // and `coupling_`: H and K by the largest entry of H
    BlockRows<float> coupling_;
    std::vector<double> wide_b_, wide_x_;
    Vector b_, g_, w_, c_;
    double scale_ = 1, per_step_ = 1, beta_ = 1;
};

}  // namespace

std::unique_ptr<Preconditioning> make_mixture(const LinearChoice& choice) {
    return std::make_unique<Mixture>(choice);
}

}  // namespace visviva
