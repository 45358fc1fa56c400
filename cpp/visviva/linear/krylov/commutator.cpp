// Preconditioner of flows [F B; C E]: block triangular, [F B; 0 -S] with incomplete factors of the
// velocities' F. The Schur complement S = C F^-1 B - E of the pressures is taken as
//     S^-1 = P^-1 (C D^-1 F D^-1 B) P^-1 with P = C D^-1 B and the diagonal D of F,
// the least-squares commutator (Elman, Howle, Shadid, Shuttleworth & Tuminaro 2006), which is right for long
// steps and short ones; with stabilised elements (E is not zero) as P = C D^-1 B - E (SIMPLE).
#include <algorithm>

#include "visviva/linear/krylov/incomplete.hpp"
#include "visviva/linear/krylov/pressures.hpp"

namespace visviva {

namespace {

// Breadth first from a node of low degree (Cuthill & McKee 1969): incomplete factors lose less.
std::vector<int> ordered(const BlockRows<double>& a, const std::vector<char>& left_out) {
    std::vector<int> order, seeds, near;
    std::vector<char> seen = left_out;
    auto degree = [&](int i) { return a.row[i + 1] - a.row[i]; };
    for (int i = 0; i < a.n(); ++i)
        if (!left_out[i]) seeds.push_back(i);
    std::sort(seeds.begin(), seeds.end(), [&](int i, int j) { return degree(i) < degree(j); });
    for (int seed : seeds) {
        if (seen[seed]) continue;
        seen[seed] = 1;
        order.push_back(seed);
        for (std::size_t at = order.size() - 1; at < order.size(); ++at) {
            near.clear();
            for (auto k = a.row[order[at]]; k < a.row[order[at] + 1]; ++k)
                if (!seen[a.col[k]]) seen[a.col[k]] = 1, near.push_back(a.col[k]);
            std::sort(near.begin(), near.end(), [&](int i, int j) { return degree(i) < degree(j); });
            order.insert(order.end(), near.begin(), near.end());
        }
    }
    return order;
}

class Commutator : public Preconditioning {
  public:
    explicit Commutator(const LinearChoice& choice) : pressures_(choice) {}

    bool build(const NodeMatrix& matrix) override {
        matrix_ = &matrix, a_ = &matrix.blocks();
        if (order_.empty()) number();
        take_diagonal();
        if (!factors_.build(velocities())) return message = "incomplete LU met a zero pivot", false;
        if (!pressures_.build(matrix, inverse_)) return message = pressures_.message, false;
        return true;
    }

    void apply(const double* r, double* z) override {
        const int m = a_->rows;
        for (int i = 0; i < pressures_.n(); ++i) s_[i] = r[pressures_.slot(i)];
        complement();
        std::copy(r, r + a_->size(), rest_.begin());
        pressures_.add_gradient(-1.0, s_, rest_);
        for (std::size_t k = 0; k < order_.size(); ++k)
            std::copy_n(&rest_[slot(order_[k])], m, &in_order_[k * m]);
        factors_.apply(in_order_.data(), solved_.data());
        for (std::size_t k = 0; k < order_.size(); ++k) std::copy_n(&solved_[k * m], m, z + slot(order_[k]));
        for (int i = 0; i < pressures_.n(); ++i) {
            std::copy_n(r + pressures_.slot(i), m, z + pressures_.slot(i));  // padding
            z[pressures_.slot(i)] = s_[i];
        }
    }

    void learn(int iterations) override { pressures_.learn(iterations); }
    bool kept() const override { return pressures_.kept(); }
    void forget() override { pressures_.forget(); }
    double memory() const override { return factors_.memory() + pressures_.memory(); }
    const char* name() const override {
        return pressures_.is_stabilised() ? "velocities by incomplete factors, pressures by SIMPLE"
                                          : "velocities by incomplete factors, pressures by the commutator";
    }

  private:
    std::size_t slot(int node) const { return static_cast<std::size_t>(node) * a_->rows; }

    void number() {
        const std::vector<char>& algebraic = matrix_->algebraic();
        pressures_.number(*matrix_);
        order_ = ordered(*a_, algebraic);
        number_.assign(a_->n(), -1);
        for (std::size_t k = 0; k < order_.size(); ++k) number_[order_[k]] = static_cast<int>(k);
        for (auto* v : {&rest_, &image_}) v->assign(a_->size(), 0.0);
        in_order_.assign(order_.size() * a_->rows, 0.0), solved_ = in_order_;
        s_.assign(pressures_.n(), 0.0), t_ = s_;
    }

    void take_diagonal() {
        const int m = a_->rows;
        inverse_.assign(a_->size(), 0.0);
        for (int i : order_) {
            const auto k =
                std::lower_bound(a_->col.begin() + a_->row[i], a_->col.begin() + a_->row[i + 1], i) -
                a_->col.begin();
            for (int c = 0; c < m; ++c)
                if (const double d = a_->block(k)[c * m + c]; d != 0) inverse_[slot(i) + c] = 1 / d;
        }
    }

    // F in its order
    BlockRows<double> velocities() const {
        BlockRows<double> f;
        const int m = a_->rows;
        f.rows = f.cols = m;
        std::vector<std::int64_t> from;
        std::vector<std::pair<int, std::int64_t>> row;
        for (int i : order_) {
            row.clear();
            for (auto k = a_->row[i]; k < a_->row[i + 1]; ++k)
                if (const int j = number_[a_->col[k]]; j >= 0) row.emplace_back(j, k);
            std::sort(row.begin(), row.end());
            for (const auto& [j, k] : row) f.col.push_back(j), from.push_back(k);
            f.row.push_back(static_cast<std::int64_t>(f.col.size()));
        }
        f.allocate();
        for (std::size_t k = 0; k < from.size(); ++k) std::copy_n(a_->block(from[k]), m * m, f.block(k));
        return f;
    }

    // s becomes -S^-1 s
    void complement() {
        if (s_.empty()) return;
        pressures_.solve(s_, t_);
        if (!pressures_.is_stabilised()) {
            std::fill(rest_.begin(), rest_.end(), 0.0);
            pressures_.add_gradient(1.0, t_, rest_);
            for (std::size_t i = 0; i < rest_.size(); ++i) rest_[i] *= inverse_[i];
            matrix_->multiply(rest_.data(), image_.data());
            for (std::size_t i = 0; i < image_.size(); ++i) image_[i] *= inverse_[i];
            pressures_.divergence(image_, s_);
            pressures_.solve(s_, t_);
        }
        for (std::size_t i = 0; i < s_.size(); ++i) s_[i] = -t_[i];
    }

    const NodeMatrix* matrix_ = nullptr;
    const BlockRows<double>* a_ = nullptr;
    std::vector<int> order_, number_;  // block rows of velocities, and back
    Pressures pressures_;
    IncompleteFactors factors_;
    std::vector<double> inverse_, rest_, image_, in_order_, solved_, s_, t_;
};

}  // namespace

std::unique_ptr<Preconditioning> make_commutator(const LinearChoice& choice) {
    return std::make_unique<Commutator>(choice);
}

}  // namespace visviva
