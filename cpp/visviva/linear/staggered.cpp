// Mechanics and heat in turn. With entropies as unknowns the first are those without exchange of heat, which
// are stiffer than at given temperatures: sweeps contract however strong the coupling is (Armero & Simo
// 1992).
#include "visviva/linear/staggered.hpp"

#include <algorithm>
#include <cmath>

namespace visviva {

namespace {

using Vector = std::vector<double>;

constexpr int most = 30;  // sweeps, which take as long as factors of all equations

double norm(const Vector& r) {
    double sum = 0;
    for (double x : r) sum += x * x;
    return std::sqrt(sum);
}

// A block of the matrix by rows.
struct Part {
    Csr pattern;                     // rows and columns numbered within the fields
    std::vector<std::int64_t> from;  // where its values are in those of the whole
    Vector value;

    void fill(const double* values) {
        value.resize(from.size());
        for (std::size_t k = 0; k < from.size(); ++k) value[k] = values[from[k]];
    }
    void end_row() { pattern.row.push_back(static_cast<std::int64_t>(from.size())); }
};

// The equations of one field, which may be none: what solves them, what is left of them, and what was found.
struct Field {
    std::vector<int> equation;  // of the whole
    Part own, other;            // columns of this field, and of the other one
    Blocks blocks;
    std::unique_ptr<LinearSolver> solver;
    Vector r, d, sum;
    double given = 0;  // the largest residual that it had to solve

    void begin(const double* residual, const std::vector<int>& unknown) {
        for (std::size_t i = 0; i < r.size(); ++i) r[i] = residual[unknown[equation[i]]];
        std::fill(sum.begin(), sum.end(), 0.0);
        given = norm(r);
    }
    // What the solution leaves is small, and taken for nothing.
    bool solve(const Place& place, double tolerance) {
        if (equation.empty()) return true;
        given = std::max(given, norm(r));
        if (!solver->solve(r.data(), place, d.data(), tolerance)) return false;
        for (std::size_t i = 0; i < r.size(); ++i) sum[i] += d[i];
        std::fill(r.begin(), r.end(), 0.0);
        return true;
    }
    // Adds what the increment of the other field has changed.
    void take(const Field& from) {
        for (int i = 0; i < other.pattern.n; ++i)
            for (auto k = other.pattern.row[i]; k < other.pattern.row[i + 1]; ++k)
                r[i] += other.value[k] * from.d[other.pattern.col[k]];
    }
};

class Staggered : public LinearSolver, public SolverSequence {
  public:
    explicit Staggered(const LinearChoice& choice) : choice_(choice) {
        for (int k = 0; k < 2; ++k) field_[k].solver = make_linear(choice_.parts[k]);
        take_report();
    }

    void analyze(const Csr& pattern, const Blocks& blocks) override {
        whole_ = &pattern;
        std::vector<int> at(pattern.n);
        for (Field& f : field_) f.equation.clear(), f.own = {}, f.other = {};
        for (int i = 0; i < pattern.n; ++i) {
            auto& equation = field_[is_second(i)].equation;
            at[i] = static_cast<int>(equation.size()), equation.push_back(i);
        }
        for (int k = 0; k < 2; ++k) {
            Field& f = field_[k];
            take_rows(f, k, at);
            take_blocks(f, blocks);
            for (auto* v : {&f.r, &f.d, &f.sum}) v->assign(f.equation.size(), 0.0);
            if (!f.equation.empty()) f.solver->analyze(f.own.pattern, f.blocks);
        }
        take_report();
    }

    bool factor(const double* values, const Place& place) override {
        for (Field& f : field_) {
            if (f.equation.empty()) continue;
            f.own.fill(values), f.other.fill(values);
            const bool regular = f.solver->factor(f.own.value.data(), place);
            take_report();
            if (!regular) return failed(f);
        }
        return true;
    }

    bool solve(const double* r, const Place& place, double* d, double tolerance) override {
        for (Field& f : field_) f.begin(r, whole_->unknown);
        const double enough = std::max(tolerance, choice_.tolerance);
        int n_iterations = 0;
        auto& [mechanics, heat] = field_;
        for (int k = 0; k < most; ++k) {
            for (Field* f : {&mechanics, &heat}) {
                const bool solved = f->solve(place, tolerance);
                n_iterations += f->solver->report().n_iterations;
                if (!solved) return take_report(), failed(*f);
                (f == &heat ? mechanics : heat).take(*f);
            }
            if (norm(mechanics.r) <= enough * mechanics.given) {
                take_report(), report_.n_iterations = n_iterations;
                for (const Field& f : field_)
                    for (std::size_t i = 0; i < f.sum.size(); ++i)
                        d[whole_->unknown[f.equation[i]]] = f.sum[i];
                return true;
            }
        }
        report_.message = "mechanics and heat in turn: no convergence in " + std::to_string(most) + " sweeps";
        return false;
    }

    void forget() override {
        for (Field& f : field_) f.solver->forget();
    }
    LinearCapabilities capabilities() override { return {nullptr, this}; }
    std::vector<double> state() const override {
        std::vector<double> all;
        for (const Field& f : field_)
            if (const auto* sequence = f.solver->capabilities().sequence) {
                const std::vector<double> own = sequence->state();
                all.insert(all.end(), own.begin(), own.end());
            }
        return all;
    }
    void set_state(const std::vector<double>& all) override {
        auto at = all.begin();
        for (Field& f : field_)
            if (auto* sequence = f.solver->capabilities().sequence) {
                const auto size = static_cast<std::ptrdiff_t>(sequence->state().size());
                sequence->set_state({at, at + size});
                at += size;
            }
    }
    void allow_last_resort(bool on) override {
        for (Field& f : field_)
            if (auto* sequence = f.solver->capabilities().sequence) sequence->allow_last_resort(on);
    }

  private:
    bool is_second(int equation) const { return choice_.is_second[whole_->unknown[equation]] != 0; }

    void take_rows(Field& f, int which, const std::vector<int>& at) const {
        for (Part* p : {&f.own, &f.other}) p->end_row();
        for (const int i : f.equation) {
            for (auto k = whole_->row[i]; k < whole_->row[i + 1]; ++k) {
                const int j = whole_->col[k];
                Part& to = is_second(j) == which ? f.own : f.other;
                to.pattern.col.push_back(at[j]), to.from.push_back(k);
            }
            for (Part* p : {&f.own, &f.other}) p->end_row();
        }
        for (Part* p : {&f.own, &f.other}) p->pattern.n = static_cast<int>(f.equation.size());
        for (int i = 0; i < f.own.pattern.n; ++i)
            f.own.pattern.equation.push_back(i), f.own.pattern.unknown.push_back(i);
    }

    // What is known of equations and unknowns, by those of the field.
    void take_blocks(Field& f, const Blocks& from) const {
        Blocks& b = f.blocks = {};
        b.n_modes = from.n_modes;
        std::vector<int> node(whole_->n);
        for (std::size_t k = 0; k + 1 < from.node.size(); ++k)
            std::fill(node.begin() + from.node[k], node.begin() + from.node[k + 1], static_cast<int>(k));
        for (std::size_t i = 0; i < f.equation.size(); ++i) {
            const int e = f.equation[i];
            if (!from.node.empty() && (i == 0 || node[e] != node[f.equation[i - 1]]))
                b.node.push_back(static_cast<int>(i));
            if (!from.place.empty()) b.place.push_back(from.place[e]);
            if (!from.algebraic.empty()) b.algebraic.push_back(from.algebraic[e]);
            if (!from.scale.empty()) b.scale.push_back(from.scale[e]);
            if (!from.multiplier.empty()) b.multiplier.push_back(from.multiplier[whole_->unknown[e]]);
        }
        b.modes = rows_of(from.modes, f.equation);
        if (!from.node.empty()) b.node.push_back(static_cast<int>(f.equation.size()));
    }

    void take_report() {
        const LinearReport &first = field_[0].solver->report(), &second = field_[1].solver->report();
        report_ = {};
        report_.name = "mechanics by " + first.name + ", heat by " + second.name + " in turn";
        report_.message = first.message + second.message;
        report_.memory = first.memory + second.memory;
        report_.tolerance = choice_.tolerance;
    }
    bool failed(const Field& f) {
        const LinearReport& report = f.solver->report();
        report_.message = report.message;
        if (report.singular_unknown >= 0)
            report_.singular_unknown = whole_->unknown[f.equation[report.singular_unknown]];
        return false;
    }

    LinearChoice choice_;
    const Csr* whole_ = nullptr;
    Field field_[2];
};

}  // namespace

std::unique_ptr<LinearSolver> make_staggered(const LinearChoice& choice) {
    return std::make_unique<Staggered>(choice);
}

}  // namespace visviva
