// Solvers and processes written in Python; the interpreter's lock is taken for every call.
#include "outside.hpp"

#include <numeric>

#include "arrays.hpp"

using namespace visviva;

namespace {

class Outside : public LinearSolver {
  public:
    explicit Outside(const std::shared_ptr<nb::object>& make) {
        nb::gil_scoped_acquire gil;
        solver_ = kept((*make)());
        take_report();
    }

    void analyze(const Csr& pattern, const Blocks& blocks) override {
        nb::gil_scoped_acquire gil;
        n_ = pattern.equation.size(), n_entries_ = pattern.col.size();
        const auto rows = static_cast<std::size_t>(pattern.n),
                   n_modes = static_cast<std::size_t>(blocks.n_modes);
        std::vector<int> equation(rows);
        std::iota(equation.begin(), equation.end(), 0);
        std::vector<double> modes(rows * n_modes, 0.0);
        blocks.modes(equation, modes.data());
        const std::vector<int> multiplier(blocks.multiplier.begin(), blocks.multiplier.end()),
            algebraic(blocks.algebraic.begin(), blocks.algebraic.end());
        nb::dict of;
        of["node"] = seen(blocks.node), of["place"] = seen(blocks.place);
        of["modes"] = seen(modes.data(), {rows, n_modes});
        of["multiplier"] = seen(multiplier), of["algebraic"] = seen(algebraic);
        of["scale"] = seen(blocks.scale);
        solver_->attr("analyze")(seen(pattern.row), seen(pattern.col), seen(pattern.unknown), of);
        take_report();
    }
    bool factor(const double* values, const Place&) override {
        nb::gil_scoped_acquire gil;
        const bool regular = nb::cast<bool>(solver_->attr("factor")(seen(values, {n_entries_})));
        take_report();
        return regular;
    }
    bool solve(const double* r, const Place&, double* d, double tolerance) override {
        nb::gil_scoped_acquire gil;
        const bool solved = nb::cast<bool>(
            solver_->attr("solve")(seen(r, {n_}), nb::cast(view(d, n_, nb::none())), tolerance));
        take_report();
        return solved;
    }
    void forget() override {
        nb::gil_scoped_acquire gil;
        solver_->attr("forget")();
    }

  private:
    void take_report() {
        report_.name = nb::cast<std::string>(solver_->attr("name"));
        report_.message = nb::cast<std::string>(solver_->attr("message"));
        report_.n_iterations = nb::cast<int>(solver_->attr("iterations"));
    }

    std::shared_ptr<nb::object> solver_;
    std::size_t n_ = 0, n_entries_ = 0;
};

class OutsideProcesses : public Processes {
  public:
    explicit OutsideProcesses(nb::object processes) : processes_(kept(std::move(processes))) {}

    std::vector<char> own(const std::vector<int>& unknowns, int n) override {
        nb::gil_scoped_acquire gil;
        return flags_of(nb::cast<Ints>(processes_->attr("own")(seen(unknowns), n)));
    }
    void sum(double* values, std::size_t n) override {
        nb::gil_scoped_acquire gil;
        processes_->attr("sum")(view(values, n, nb::none()));
    }
    double largest(double value) override {
        nb::gil_scoped_acquire gil;
        return nb::cast<double>(processes_->attr("largest")(value));
    }
    void share(double* d, std::size_t n) override {
        nb::gil_scoped_acquire gil;
        processes_->attr("share")(view(d, n, nb::none()));
    }
    void tell(std::string& words, int& number) override {
        nb::gil_scoped_acquire gil;
        const auto told = nb::cast<nb::tuple>(processes_->attr("tell")(words, number));
        words = nb::cast<std::string>(told[0]), number = nb::cast<int>(told[1]);
    }

  private:
    std::shared_ptr<nb::object> processes_;
};

}  // namespace

OutsideSolver outside_solver(nb::object make) {
    return [shared = kept(std::move(make))] { return std::make_unique<Outside>(shared); };
}

std::unique_ptr<Processes> outside_processes(nb::object processes) {
    return std::make_unique<OutsideProcesses>(std::move(processes));
}
