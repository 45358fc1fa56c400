// Heat across a contact: conduction by a conductance that depends on the pressure, and heat of friction.
#pragma once
#include <functional>
#include <memory>
#include <optional>

#include "visviva/contact/contact_term.hpp"
#include "visviva/contact/passage.hpp"

namespace visviva {

// Conductances of pressures, and their slopes.
using Conductance = std::function<void(const std::vector<double>& pressure, std::vector<double>& values,
                                       std::vector<double>& slopes)>;

/// Per form of the contact's vertices the unknown whose equation balances heat, or entropy, and that of the
/// temperature; -1 for what carries no heat.
struct ContactWarmth {
    std::vector<int> balance, temperature;
    // Of the bodies of both surfaces: whether they carry heat, and balance entropy, by temperatures at the
    // end.
    bool carries[2] = {true, true}, entropy[2] = {true, true};
    double share = 0.5;  // of the heat of friction that the first surface takes
};

class ContactHeat : public Term {
  public:
    ContactHeat(std::shared_ptr<ContactTerm> contact, ContactWarmth warmth)
        : contact_(std::move(contact)), warmth_(std::move(warmth)) {
        is_lasting = false, is_shown = true;
        surfaces_ = static_cast<int>(warmth_.balance.size());
        const std::size_t n = contact_->gaps().skin().unknown.size();  // frames behind the surfaces have none
        warmth_.balance.resize(n, -1), warmth_.temperature.resize(n, -1);
    }
    void set_conductance(Conductance f) { conductance_ = std::move(f); }

    void couple(Pattern& pattern) const override;
    void connect(const Pattern& pattern) override { pattern_ = pattern; }
    void residual(const Context&, double* r) override;
    void tangent(const Context&, double* values) override;
    void ledger(const Context&, const double* v1, LedgerSums&) override;

    /// Heat per time into the first surface by conduction in the last step, by its vertices.
    const std::vector<double>& conducted() const { return conducted_; }
    int work_account = -1;

  private:
    struct Flow;
    void evaluate(const Context&, bool gradients, bool by_rates = true);
    Flow flow(int A, const Context&, bool gradients) const;
    double temperature(int form, int side, const Context&) const;
    bool is_first(int vertex) const { return vertex < contact_->n(); }
    /// Whether the vertex is of the surface that carries heat, the first one of two; weights of what turns
    /// are those of its frame, which is behind the surfaces.
    bool is_heated(int vertex) const {
        return is_first(vertex) == warmth_.carries[0] && contact_->gaps().skin().first[vertex] < surfaces_;
    }
    static double rate(const Context&);
    template <class F>
    void each_warm(int A, F f) const;
    template <class F>
    void each_parted(const Context&, F f) const;

    std::shared_ptr<ContactTerm> contact_;
    ContactWarmth warmth_;
    Conductance conductance_;
    int surfaces_;  // forms of both surfaces
    std::optional<Pattern> pattern_;
    std::vector<Passage> passages_;
    std::vector<double> pressure_, conductances_, slopes_, conducted_;
};

}  // namespace visviva
