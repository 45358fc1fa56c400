// A batch of equal elements with assumed strains and an energy quadratic in them: shells.
#pragma once
#include <vector>

#include "visviva/base/aligned.hpp"
#include "visviva/point/assumed_dispatch.hpp"
#include "visviva/term/slots.hpp"
#include "visviva/term/term.hpp"

namespace visviva {

struct AssumedData {
    int n, n_slots, n_samples, n_strains;
    const int* index;       // [element][slot]
    const double* weights;  // [sample][slot]
    std::vector<AssumedProduct> products;
    const double *stiffness, *reference;  // [element][a <= b], [element][strain]
};

class AssumedTerm : public Term, public MeshAssembly {
  public:
    explicit AssumedTerm(const AssumedData& data);
    TermCapabilities capabilities() override { return {this, nullptr, nullptr, nullptr}; }
    void couple(Pattern& pattern) const override { slots_.couple(pattern); }
    void connect(const Pattern& pattern) override;
    void residual(const Context&, double* r) override;
    void tangent(const Context& c, double* values) override { linearise(c, nullptr, values); }
    void clear_rows(const Pattern& pattern, std::vector<char>& cleared) override {
        slots_.clear_rows(pattern, cleared);
    }
    void linearise(const Context&, double* r, double* values) override;
    void ledger(const Context&, const double* v1, LedgerSums&) override;

    int energy_account = -1;

  private:
    Slots slots_;
    AssumedView view_;
    std::vector<AssumedProduct> products_;
    std::vector<AssumedRange> seen_, touched_;
    std::vector<char> couples_;
    std::vector<double> weights_;
    Aligned<double> stiffness_, reference_, out_;
};

}  // namespace visviva
