// The iterative linear solver: a Krylov method with a preconditioner, to a residual that is checked and never
// taken from a recursion.
#include "visviva/linear/krylov/krylov.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace visviva {

namespace {

constexpr double single_suffices = 3e-5;  // tolerances that leave room for products in single precision

class Krylov : public LinearSolver {
  public:
    explicit Krylov(const LinearChoice& choice)
        : choice_(choice),
          preconditioning_(make_preconditioning(choice)),
          matrix_(
              choice.tolerance >= single_suffices,
              choice.preconditioner == Preconditioner::saddle ||
                  choice.preconditioner == Preconditioner::augmented,
              choice.preconditioner == Preconditioner::multigrid ? choice.borrow_from : NodeMatrix::never) {
        describe();
    }

    void analyze(const Csr& pattern, const Blocks& blocks) override {
        matrix_.analyze(pattern, blocks);
        preconditioning_ = make_preconditioning(choice_);
        describe();
        for (auto* v : {&b_, &x_, &r_}) v->assign(matrix_.size(), 0.0);
    }

    bool factor(const double* values, const Place&) override {
        report_.message.clear();
        if (!matrix_.fill(values))
            return report_.message = "the tangent holds values that are not finite", false;
        return build();
    }

    bool solve(const double* r, const Place&, double* d, double tolerance) override {
        report_.message.clear();
        report_.tolerance = std::max(tolerance, choice_.tolerance);
        report_.n_iterations = 0;
        matrix_.gather(r, b_.data());
        const double size = norm(b_);
        if (!std::isfinite(size)) return report_.message = "the right-hand side is not finite", false;
        std::fill(x_.begin(), x_.end(), 0.0);
        bool solved = size == 0 || iterate(size);
        if (!solved && preconditioning_->kept()) {  // it was made for an earlier matrix
            preconditioning_->forget();
            std::fill(x_.begin(), x_.end(), 0.0);
            solved = build() && iterate(size);
        }
        if (!solved) return false;
        if (size > 0) preconditioning_->learn(iterations_to_tolerance());
        matrix_.scatter(x_.data(), d);
        return true;
    }

    void forget() override { preconditioning_->forget(); }

  private:
    void describe() {
        const char* method = choice_.method == KrylovMethod::cg      ? "conjugate gradients, "
                             : choice_.method == KrylovMethod::gmres ? "GMRES, "
                                                                     : "BiCGStab, ";
        report_.name = std::string(method) + preconditioning_->name();
        report_.memory =
            8.0 * static_cast<double>(matrix_.blocks().value.size()) + preconditioning_->memory();
    }

    bool build() {
        const bool built = preconditioning_->build(matrix_);
        describe();
        if (!built) report_.message = preconditioning_->message;
        return built;
    }

    // Runs of the method, each from the true residual, until that is small enough.
    bool iterate(double size) {
        double now = 1, before = 2;
        const char* trouble = nullptr;
        report_.n_iterations = 0;
        r_ = b_;
        if (preconditioning_->starts_exact())
            preconditioning_->apply(b_.data(), x_.data()), now = residual() / size;
        for (; now > report_.tolerance && report_.n_iterations < choice_.max_iterations && !trouble;) {
            if (choice_.method != KrylovMethod::gmres && now > 0.9 * before) break;
            KrylovRun run{matrix_,
                          *preconditioning_,
                          0.9 * report_.tolerance * size,
                          choice_.max_iterations - report_.n_iterations,
                          x_,
                          r_,
                          basis_};
            start(run);
            trouble = run.trouble;
            report_.n_iterations += std::max(run.iterations, 1);
            before = now, now = residual() / size;
        }
        return now <= report_.tolerance || failed(trouble, now);
    }

    void start(KrylovRun& run) const {
        switch (choice_.method) {
            case KrylovMethod::cg:
                return conjugate_gradients(run);
            case KrylovMethod::gmres:
                return gmres(run, choice_.restart);
            case KrylovMethod::bicgstab:
                return bicgstab(run);
        }
    }

    // What solutions of less than the full tolerance would have taken to it.
    int iterations_to_tolerance() const {
        return static_cast<int>(
            std::lround(report_.n_iterations * std::log(choice_.tolerance) / std::log(report_.tolerance)));
    }

    // In double precision, whatever that of products is: a pressure that is nearly free to shift leaves more
    // of itself in single precision than the tolerance.
    double residual() {
        matrix_.multiply_double(x_.data(), r_.data());
        for (std::size_t i = 0; i < r_.size(); ++i) r_[i] = b_[i] - r_[i];
        return norm(r_);
    }

    bool failed(const char* trouble, double residual) {
        char text[200];
        std::snprintf(text, sizeof text, "%s: %s after %d iterations, with %.1e of the residual left",
                      report_.name.c_str(), trouble ? trouble : "no convergence", report_.n_iterations,
                      residual);
        return report_.message = text, false;
    }

    LinearChoice choice_;
    std::unique_ptr<Preconditioning> preconditioning_;
    NodeMatrix matrix_;
    std::vector<double> b_, x_, r_;
    std::vector<std::vector<double>> basis_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_krylov(const LinearChoice& choice) {
    return std::make_unique<Krylov>(choice);
}

}  // namespace visviva
