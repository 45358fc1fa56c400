// Solvers in the order of preference: where one fails, the next takes over, and says so.
#include <algorithm>

#include "visviva/linear/staggered.hpp"

namespace visviva {

namespace {

class Cascade : public LinearSolver, public SolverSequence {
  public:
    explicit Cascade(const std::vector<LinearChoice>& choices) : choices_(choices) {
        report_.name = "none yet";
    }

    void analyze(const Csr& pattern, const Blocks& blocks) override {
        pattern_ = &pattern, blocks_ = &blocks;
        solver_.reset(), report_ = {}, report_.name = "none yet";
        at_ = 0, served_ = 0, patience_ = 16;
    }

    // After the present solver has served for long enough, the preferred one is tried again: with twice the
    // patience every time that it fails.
    bool factor(const double* values, const Place& place) override {
        values_ = values;
        left_.clear();
        if (at_ > 0 && ++served_ > patience_) at_ = 0, served_ = 0, patience_ *= 2;
        if (choices_[at_].last_resort && !is_allowed_) at_ = 0, served_ = 0;
        return attempt([&] { return solver_->factor(values_, place); });
    }

    bool solve(const double* r, const Place& place, double* d, double tolerance) override {
        if (solver_->solve(r, place, d, tolerance)) return take_report(true);
        if (is_last()) return take_report(false);
        note();
        ++at_;
        return attempt([&] { return solver_->factor(values_, place) && solver_->solve(r, place, d, 0); });
    }

    void forget() override {
        if (solver_) solver_->forget();
    }
    LinearCapabilities capabilities() override { return {nullptr, this}; }
    std::vector<double> state() const override {
        std::vector<double> all = {static_cast<double>(at_), static_cast<double>(served_),
                                   static_cast<double>(patience_)};
        if (const SolverSequence* of = sequence()) {
            const std::vector<double> more = of->state();
            all.insert(all.end(), more.begin(), more.end());
        }
        return all;
    }
    void allow_last_resort(bool on) override { is_allowed_ = on; }
    void set_state(const std::vector<double>& s) override {
        at_ = std::min(static_cast<std::size_t>(s[0]), choices_.size() - 1), served_ = static_cast<int>(s[1]),
        patience_ = static_cast<int>(s[2]);
        if (s.size() <= own) return;
        prepare();
        if (SolverSequence* of = sequence()) of->set_state({s.begin() + own, s.end()});
    }

  private:
    // From the present solver on, until one succeeds.
    template <class F>
    bool attempt(F&& works) {
        for (;; ++at_) {
            prepare();
            if (works()) return take_report(true);
            if (is_last()) return take_report(false);
            note();
        }
    }

    // Of the solver that serves, if it has some itself.
    SolverSequence* sequence() const {
        return solver_ && prepared_ == at_ ? solver_->capabilities().sequence : nullptr;
    }

    bool is_last() const {
        return at_ + 1 == choices_.size() || (choices_[at_ + 1].last_resort && !is_allowed_);
    }

    void prepare() {
        if (solver_ && prepared_ == at_) return;
        solver_.reset();  // its memory first
        auto solver = make_linear({choices_[at_]});
        solver->analyze(*pattern_, *blocks_);
        solver_ = std::move(solver), prepared_ = at_;
    }

    void note() { left_ += solver_->report().name + " was left: " + solver_->report().message + "; "; }

    // That of the solver that serves; where it succeeds, with why others were left.
    bool take_report(bool succeeded) {
        report_ = solver_->report();
        if (succeeded) report_.message = left_;
        return succeeded;
    }

    static constexpr std::size_t own = 3;  // numbers of the state
    std::vector<LinearChoice> choices_;
    std::unique_ptr<LinearSolver> solver_;
    const Csr* pattern_ = nullptr;
    const Blocks* blocks_ = nullptr;
    const double* values_ = nullptr;
    std::size_t at_ = 0, prepared_ = 0;
    int served_ = 0, patience_ = 16;
    bool is_allowed_ = true;
    std::string left_;  // which solvers, and why
};

std::unique_ptr<LinearSolver> make_one(const LinearChoice& choice) {
    switch (choice.backend) {
        case Backend::cholesky:
            return make_cholesky(choice);
        case Backend::pardiso:
            return make_pardiso(choice);
        case Backend::krylov:
            return make_krylov(choice);
        case Backend::staggered:
            return make_staggered(choice);
        case Backend::outside:
            return choice.outside();
        case Backend::sparse_lu:
            break;
    }
    auto lu = make_sparse_lu(true, choice.memory_limit);
    lu->regularization = choice.regularization;
    return lu;
}

}  // namespace

std::unique_ptr<LinearSolver> make_linear(const std::vector<LinearChoice>& in_order) {
    if (in_order.size() == 1) return make_one(in_order.front());
    return std::make_unique<Cascade>(in_order);
}

}  // namespace visviva
