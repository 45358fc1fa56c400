// Heat between the nodes of an immersed body and the fluid where they are.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "visviva/flow/immersed_term.hpp"
#include "visviva/term/pattern.hpp"

namespace visviva {

/// Per point that follows the fluid: the unknown whose equation balances heat, or entropy, that of the
/// temperature, and the heat per time and difference of temperatures. Temperatures of the fluid are numbered
/// like its velocities.
struct ImmersedWarmth {
    std::vector<int> balance, temperature;
    std::vector<double> conductance;
    bool entropy = false;
    int flow_start = 0, heat_start = 0, dim = 3;
    int of_velocity(int unknown) const { return heat_start + (unknown - flow_start) / dim; }
};

class ImmersedHeat : public Term {
  public:
    ImmersedHeat(std::shared_ptr<ImmersedTerm> body, ImmersedWarmth warmth)
        : body_(std::move(body)), warmth_(std::move(warmth)) {
        is_lasting = false;
    }
    void couple(Pattern&) const override;
    void connect(const Pattern& pattern) override { pattern_ = pattern; }
    void residual(const Context&, double* r) override;
    void tangent(const Context&, double* values) override;
    void ledger(const Context&, const double*, LedgerSums&) override {}

  private:
    template <class F>
    void each(const Context&, F f) const;

    std::shared_ptr<ImmersedTerm> body_;
    ImmersedWarmth warmth_;
    std::optional<Pattern> pattern_;
};

}  // namespace visviva
