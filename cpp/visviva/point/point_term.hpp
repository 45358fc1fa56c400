// A batch of equal elements of one physics: fields, strains and an energy at quadrature points, inertia,
// history.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "visviva/base/aligned.hpp"
#include "visviva/point/point_dispatch.hpp"
#include "visviva/term/law_callback.hpp"
#include "visviva/term/slots.hpp"
#include "visviva/term/term.hpp"

namespace visviva {

/// Nodes of a group [element][...] as Python gives them.
struct PointGroupData {
    int n_nodes;
    bool is_position;
    const double* weights;  // [element][point][node][column]
    const double* mass;     // [element][pair], or null
};

struct PointData {
    PhysicsKind kind;
    int n, n_points, n_slots;
    const int* index;  // [element][slot]: groups one after the other, nodes of each
    std::vector<PointGroupData> groups;
    const double *volume, *par, *reference;  // [element][point], [..][parameter], [..][strain] or null
};

class PointTerm : public Term,
                  public MeshAssembly,
                  public TermMemory,
                  public TermHistory,
                  public IterationLimit {
  public:
    /// Throws std::invalid_argument if groups or parameters are not those of the physics.
    explicit PointTerm(const PointData& data);

    /// The energy is evaluated outside the core, with internal variables of its own that begin at `start`
    /// [variable].
    void set_callback(LawCallback f, const std::vector<double>& start);

    /// Parameters, the same at all points, that follow signals: (place, signal). The energy that their change
    /// gives to what stands still is work of an account.
    void drive(std::vector<std::pair<int, int>> places, int account);

    /// The value of a group (its first column) changes by `reach` at most in an iteration; and where its
    /// parameters have logarithms (mixture.hpp), goes nine tenths of the way to their ends at most.
    void limit(int group, double reach) { limited_ = group, reach_ = reach; }
    double share(const double* x1, const double* d) const override;

    TermCapabilities capabilities() override {
        return {this, nullptr, this, this, limited_ < 0 ? nullptr : this};
    }
    void couple(Pattern& pattern) const override { slots_.couple(pattern); }
    void connect(const Pattern& pattern) override;
    void residual(const Context&, double* r) override;
    void tangent(const Context& c, double* values) override { linearise(c, nullptr, values); }
    void clear_rows(const Pattern& pattern, std::vector<char>& cleared) override {
        slots_.clear_rows(pattern, cleared);
    }
    void linearise(const Context&, double* r, double* values) override;
    void ledger(const Context&, const double* v1, LedgerSums&) override;
    Refusal refuse(const Context&) override;
    void accept(const Context&) override;
    void write_memory(std::vector<double>&) const override;
    bool read_memory(const double*& memory) override;
    void write_history(std::vector<double>&) const override;
    void read_history(const double*& history) override;
    void return_to(Past) override;

    /// Internal variables after the last accepted step: [block][point][variable][8], or of energies outside
    /// the core [variable][block][point][8].
    const Aligned<double>& history() const { return history0_; }
    int n_strains() const { return kernels_.shape.n_energy; }
    int n_history() const { return n_history_; }
    bool is_called() const { return static_cast<bool>(callback_); }

    int energy_account = -1, kinetic_account = -1, dissipation_account = -1, owner = 0;

  private:
    void start(const Context&);
    void call_back(const Context&, bool want_tangent);
    void call_unheated(LawArguments);
    void set_driven(const double* signals);
    double energy_at(const Context&, const double* x, const double* signals);

    std::vector<std::pair<int, int>> driven_;
    int drive_account_ = -1;
    int n_history_ = 0, limited_ = -1;
    double reach_ = 0;
    std::vector<char> lost_way_;
    double lost_ = 0;  // by internal variables in the step
    Slots slots_;
    PointView view_;
    const PointKernels& kernels_;
    LawCallback callback_;
    Aligned<double> weights_[point_max_groups], mass_[point_max_groups], w_, par_, reference_, out_;
    // Internal variables now, at the end of the step last evaluated, at the start of the step accepted last,
    // and when the last tangent was made.
    Aligned<double> history0_, history1_, before_, at_tangent_;
    Aligned<double> e0_, et_, e1_, called_W_, called_s_, called_T_, called_lost_;
    Aligned<double> unheated_e_, unheated_W_, unheated_s_;
};

}  // namespace visviva
