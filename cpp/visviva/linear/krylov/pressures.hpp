// The pressures of a flow beside its velocities: what couples both, and P = C D^-1 B - E with the diagonal D
// of the velocities' block. A cycle or two of multigrid stand for P^-1; where pressures are few, or nobody
// makes aggregates, factors do.
#pragma once
#include "visviva/linear/krylov/multigrid.hpp"

namespace visviva {

class Pressures {
  public:
    explicit Pressures(const LinearChoice& choice) : choice_(choice) {}

    void number(const NodeMatrix& matrix);
    // `inverse` of D, by slot; false: see `message`.
    bool build(const NodeMatrix& matrix, const std::vector<double>& inverse);

    int n() const { return static_cast<int>(block_row_.size()); }
    std::size_t slot(int i) const { return static_cast<std::size_t>(block_row_[i]) * a_->rows; }
    bool is_stabilised() const { return is_stabilised_; }
    void solve(const std::vector<double>& s, std::vector<double>& t);  // t = P^-1 s
    void add_gradient(double factor, const std::vector<double>& s,
                      std::vector<double>& v) const;                              // v += factor B s
    void divergence(const std::vector<double>& v, std::vector<double>& s) const;  // s = C v

    void learn(int iterations);
    bool kept() const { return kept_; }  // what stands for P^-1 from an earlier matrix
    void forget();
    double memory() const;
    std::string message;

  private:
    void take();
    bool make_grids(const std::vector<double>& inverse);
    bool factor(const std::vector<double>& inverse);
    void assemble(const std::vector<double>& inverse, BlockRows<double>& p) const;
    std::vector<LinearChoice> factors() const;

    LinearChoice choice_;
    const BlockRows<double>* a_ = nullptr;
    std::vector<int> block_row_, number_;  // of every pressure, and back
    std::vector<std::int64_t> start_;      // per pressure: the nodes that it touches, its row C, its column B
    std::vector<int> node_;
    std::vector<float> row_, column_;
    bool is_stabilised_ = false, kept_ = false;
    std::unique_ptr<Grids> grids_;
    Csr pattern_;  // of what is factored
    std::vector<double> values_;
    Blocks blocks_;
    std::unique_ptr<LinearSolver> factors_;
};

}  // namespace visviva
