#include "visviva/linear/reduce/reduction.hpp"

#include <algorithm>

namespace visviva {

// Numbers the equations that are not gone as those of what is left, whose pattern is still to be found.
void Reduction::number_left(const Csr& full, const std::vector<char>& gone) {
    full_ = &full, left_ = {};
    kept_.assign(full.n, -1);
    left_.equation.assign(full.equation.size(), -1);
    for (int i = 0; i < full.n; ++i) {
        if (gone[i]) continue;
        kept_[i] = left_.n++;
        left_.equation[full.unknown[i]] = kept_[i];
        left_.unknown.push_back(full.unknown[i]);
    }
}

bool Reduction::solve(const double* r, const Place& place, double* d, LinearSolver& rest, double tolerance) {
    right_.assign(r, r + full_->equation.size());
    right_.push_back(0.0);  // element slots of nothing may point there
    condense(right_);
    if (!rest.solve(right_.data(), place, d, tolerance)) return false;
    recover(r, d);
    return true;
}

std::int64_t place_of(const Csr& csr, int row, int col) {
    const auto begin = csr.col.begin() + csr.row[row], end = csr.col.begin() + csr.row[row + 1];
    const auto found = std::lower_bound(begin, end, col);
    return found != end && *found == col ? found - csr.col.begin() : -1;
}

namespace {

Blocks left_blocks(const Blocks& blocks, const std::vector<int>& kept, int n_left) {
    Blocks b = blocks;
    b.node.clear(), b.place.clear(), b.algebraic.clear(), b.scale.clear();
    // first equations of nodes, and at last the number of equations
    for (std::size_t k = 0; k + 1 < blocks.node.size(); ++k) {
        const auto begin = kept.begin() + blocks.node[k], end = kept.begin() + blocks.node[k + 1];
        const auto first = std::find_if(begin, end, [](int equation) { return equation >= 0; });
        if (first != end) b.node.push_back(*first);
    }
    if (!blocks.node.empty()) b.node.push_back(n_left);
    std::vector<int> rows;
    for (std::size_t i = 0; i < kept.size(); ++i) {
        if (kept[i] < 0) continue;
        rows.push_back(static_cast<int>(i));
        if (!blocks.place.empty()) b.place.push_back(blocks.place[i]);
        if (!blocks.algebraic.empty()) b.algebraic.push_back(blocks.algebraic[i]);
        if (!blocks.scale.empty()) b.scale.push_back(blocks.scale[i]);
    }
    b.modes = rows_of(blocks.modes, std::move(rows));
    return b;
}

class ReducedSolver : public LinearSolver {
  public:
    ReducedSolver(std::shared_ptr<Reduction> reduction, std::unique_ptr<LinearSolver> rest,
                  std::function<bool(bool)> agree)
        : reduction_(std::move(reduction)), rest_(std::move(rest)), agree_(std::move(agree)) {
        take_report();
    }

    void analyze(const Csr&, const Blocks& blocks) override {
        blocks_ = left_blocks(blocks, reduction_->kept(), reduction_->left().n);
        rest_->analyze(reduction_->left(), blocks_);
        take_report();
    }
    bool factor(const double* values, const Place& place) override {
        const bool regular =
            agree_(reduction_->reduce(values)) && rest_->factor(reduction_->values().data(), place);
        take_report();
        return regular;
    }
    bool solve(const double* r, const Place& place, double* d, double tolerance) override {
        const bool solved = reduction_->solve(r, place, d, *rest_, tolerance);
        take_report();
        return solved;
    }
    void forget() override { rest_->forget(); }
    LinearCapabilities capabilities() override { return rest_->capabilities(); }

  private:
    void take_report() {
        report_ = rest_->report();
        report_.name += reduction_->name();
        if (reduction_->message().empty()) return;
        report_.message = reduction_->message();
        report_.singular_unknown = reduction_->singular_unknown();
    }

    std::shared_ptr<Reduction> reduction_;
    std::unique_ptr<LinearSolver> rest_;
    std::function<bool(bool)> agree_;
    Blocks blocks_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_reduced(std::shared_ptr<Reduction> reduction,
                                           std::unique_ptr<LinearSolver> rest,
                                           std::function<bool(bool here)> agree) {
    return std::make_unique<ReducedSolver>(std::move(reduction), std::move(rest), std::move(agree));
}

}  // namespace visviva
