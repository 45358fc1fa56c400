// A batch of equal solid elements: strain energy, inertia and damping in one pass.
#pragma once
#include <string>
#include <vector>

#include "visviva/solid/solid.hpp"
#include "visviva/solid/solid_dispatch.hpp"
#include "visviva/term/law_callback.hpp"
#include "visviva/term/slots.hpp"
#include "visviva/term/term.hpp"

namespace visviva {

/// Data of a batch; arrays as given by Python, [element][...].
struct SolidData {
    int n, n_nodes, n_pressures, n_points, dim, n_par;
    MaterialKind kind;
    bool small;
    const int* index;  // [element][node, then pressure] first unknown
    const double *gradients, *hoop,
        *volume;  // [element][point][node][dim], [element][point][node], [element][point]
    const double *mass, *par, *damping;  // [element][pair], [element][parameter], [element][3]
    // Of bricks, in place of gradients and volumes: [element][node][3], see BrickShapes; without mass or with
    // `mass` null
    const double *places, *slopes, *weight, *mass_shapes;
};

class SolidTerm : public Term, public MeshAssembly {
  public:
    explicit SolidTerm(const SolidData& data);

    void set_callback(LawCallback f);
    void set_start_stress(bool on) { view_.start_stress = on; }
    bool start_stress() const { return view_.start_stress; }
    // F-bar: gradients [element][node][dim] and hoop weights [element][node] at the centres
    void set_centre(const double* gradients, const double* hoop);
    // Mixed: [element][point][pressure] and [element][pressure][pressure]; see SolidView
    void set_pressure(const double* shape, const double* compliance, int measure, bool multiplier);
    void set_thermal(const double* strain);  // [element][point]
    void set_plane_stress(bool on) { view_.plane_stress = on; }

    TermCapabilities capabilities() override { return {this, nullptr, nullptr}; }
    void couple(Pattern& pattern) const override { slots_.couple(pattern); }
    void connect(const Pattern& pattern) override;
    void residual(const Context&, double* r) override;
    void tangent(const Context&, double* values) override;
    void clear_rows(const Pattern& pattern, std::vector<char>& cleared) override {
        slots_.clear_rows(pattern, cleared);
    }
    void linearise(const Context&, double* r, double* values) override;
    void ledger(const Context&, const double* v1, LedgerSums&) override;
    Refusal refuse(const Context&) override;

    int n() const { return view_.n; }
    int n_nodes() const { return view_.n_nodes; }
    int n_points() const { return view_.n_points; }
    int dim() const { return view_.dim; }
    // Forces on elements begin ... end - 1 (begin a multiple of eight) at the configuration x, without
    // inertia and damping: fields at their points [element][point][solid_field_rows], or the forces on their
    // nodes [element][node][dim].
    void fields(const double* x, int begin, int end, double* out);
    void forces(const double* x, int begin, int end, double* out);

    // Accounts and component of the whole batch: strain energy, kinetic energy, work of damping.
    int strain_account = -1, kinetic_account = -1, damping_account = -1, owner = 0;
    std::vector<int> numbers;  // [element] within its component, for messages

  private:
    void keep_geometry(const SolidData& data);
    void call_back(const Context&, bool want_tangent);
    void strains_at_centres(const Context&);
    using At = void (*)(const SolidView&, const Step&, const Vectors&, int begin, int end, double* out);
    void at_rest(At, const double* x, int begin, int end, std::int64_t per_element, double* out);
    int n_strains() const { return view_.centre_G ? 12 : 6; }  // of a user's energy

    Slots slots_;  // nodes, then pressures
    SolidView view_;
    BrickShapes brick_;
    const MixedKernels* mixed_ = nullptr;
    LawCallback callback_;
    Aligned<double> X_, G_, H_, w_, thermal_, mass_, par_, damping_, smallest_;
    Aligned<double> centre_G_, centre_H_, shape_, compliance_;
    Aligned<double> c0_, ct_, c1_, user_W_, user_S_, user_D_;
    std::vector<int> index_, pressure_index_;
};

}  // namespace visviva
