// Unilateral contact: gaps that must not become negative, kept so by multipliers with an active set or by a
// penalty, with forces whose momenta vanish and whose work is the change of the gaps.
#pragma once
#include <Eigen/Dense>
#include <cmath>
#include <ctime>
#include <optional>

#include "visviva/contact/friction.hpp"
#include "visviva/contact/gaps.hpp"
#include "visviva/term/pattern.hpp"
#include "visviva/term/term.hpp"

namespace visviva {

// With the traction of each gap from a slip that is elastic up to Coulomb's limit, or from multipliers that
// let nothing slip below it.
struct FrictionOptions {
    double coefficient = 0;
    std::vector<int> multiplier;    // first unknown of each gap's one or two; empty: elastic slip
    std::vector<double> stiffness;  // of each gap: traction per weighted displacement
    std::vector<double> inertia;    // and per weighted acceleration, of multipliers
};

struct ContactOptions {
    std::vector<int> multiplier;    // unknown of each gap; empty: penalty
    std::vector<double> stiffness;  // of each gap: pressure per weighted gap
    std::vector<double> area;       // of each vertex at rest
    bool conserving = false;        // gaps that are closed must not close further, open ones may
    // The first surface is that of a rigid body or of points: they leave with a share of the velocity that
    // they came with, and several of their vertices may press where fewer would do.
    bool rigid = false;
    double restitution = 0;
    bool presses_out = false;     // in time too, what overlaps at the start of a step is pushed apart
    std::vector<double> damping;  // of each gap: pressure per rate of penetration, beside a penalty
    FrictionOptions friction;
};

// CPU seconds that contact has taken, by what for.
struct ContactCosts {
    double search = 0, segments = 0, forces = 0;
};

class ContactTerm : public Term {
  public:
    ContactTerm(std::shared_ptr<Gaps> gaps, ContactOptions options, double reach);

    void pattern(std::vector<std::pair<int, int>>&) const override {}
    void set_positions(const std::int64_t*) override {}
    std::int64_t n_entries() const override { return 0; }
    void couple(Pattern& pattern) const override;
    void connect(const Pattern& pattern) override;
    bool search(const Way&) override;
    bool outdated() const override {
        return unsettled_ || active_ != active_at_tangent_ || slips_ != slips_at_tangent_;
    }
    bool amend(const Context&, double* values) override;
    void begin(const double* x0) override;
    void residual(const Context&, double* r) override;
    void tangent(const Context&, double* values) override;
    void ledger(const Context&, const double* v1, LedgerSums&) override;
    void accept(const Context&) override;
    Refusal refuse(const Context&) override;
    void write_memory(std::vector<double>& memory) const override;
    bool read_memory(const double*& memory) override;
    void hold() override;
    void release() override;
    bool is_lasting() const override { return false; }
    double resolution() const override { return gaps_->resolution(); }

    // At the last evaluation, by vertices of the first surface: pressure, weighted gap, area.
    const std::vector<double>& pressures() const { return S_; }
    const std::vector<double>& gap_values() const { return gap1_; }
    const std::vector<double>& areas() const { return area1_; }
    /// Tractions on the first surface, three numbers each, and whether what is in contact slips.
    std::vector<double> tractions() const;
    const std::vector<char>& slips() const { return slips_; }
    /// Gaps that the last iteration opened or closed, or made slip or stick.
    const std::vector<int>& unsettled() const { return unsettled_gaps_; }
    int n() const { return gaps_->n(); }
    /// Forces on all vertices in the last step, three numbers each: of the pressures, and of friction.
    const std::vector<double>& forces() const { return forces_; }
    const std::vector<double>& friction_forces() const { return friction_forces_; }
    const ContactCosts& costs() const { return costs_; }

    int work_account = -1, energy_account = -1, friction_account = -1, slip_energy_account = -1;

  private:
    // What the multipliers of a gap add to the tangent: by the stencil's positions, and on its forces.
    struct Border {
        Eigen::MatrixXd row, column, square;
    };
    // Elastic tractions, two numbers each, belong to a configuration of the vertices.
    struct Record {
        std::vector<double> X, traction;
    };
    // What an evaluation has left.
    struct Held {
        std::vector<double> S, gap1, area1, forces, friction_forces;
        std::vector<char> active, slips;
        std::vector<Grip> grips;
        std::vector<Traction> traction;
    };
    // Where a gap's part of the tangent is among the values.
    struct Places {
        bool known = false;
        std::vector<int> stencil;
        std::vector<std::int64_t> blocks, border;
    };
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    bool has_multipliers() const { return !options_.multiplier.empty(); }
    bool has_friction() const { return options_.friction.coefficient > 0; }
    bool has_tangential() const { return !options_.friction.multiplier.empty(); }
    bool has_history() const { return has_friction() && !has_tangential(); }
    std::vector<int> multipliers(int A) const;
    int n_multipliers() const;
    bool rebounds() const { return options_.rigid && has_multipliers(); }
    // Rigid bodies are pushed out of each other in the first step: what impacts leave later is not.
    bool pushes_out() const { return options_.presses_out && !pushed_out_; }
    // Whether gaps close freely, and are held from then on.
    bool holds(const Context& c) const {
        return (options_.conserving || rebounds()) && c.step.motion[0][0] != 0;
    }
    bool is_discrete(const Step& s) const { return s.stress == Stress::discrete_gradient; }
    double theta(const Step& s) const { return has_multipliers() ? s.theta_g : s.theta; }
    bool read_search(const double*& memory);
    int beyond(const double* X, double margin) const;
    Refusal refused(int vertex, const std::string& why) const;
    int passes(const std::vector<Approach>&, int n_parts);
    double depth(int A, const std::vector<double>& gap, const std::vector<double>& area) const;
    void evaluate(const Context&, bool chooses, bool gradients = false);
    void settle();
    void find_gaps();
    void find_gradients();
    template <class F>
    void segments(F f);
    double augmentation(int A, const Context&) const;
    void choose_active(const Context&);
    bool wants_pressure(int A, const Context&) const;
    double least_gap(int A, const Context&) const;
    double rebound(int A, const Context&) const;
    bool closed(int A) const;
    double ease(int A, const Context&) const;
    void find_rates(const Context&);
    double slack(int A, const Context&) const;
    void cover(const Context&);
    bool is_covered(int A, const std::vector<double>& area) const;
    void find_masses(bool gradients);
    double size(int A) const { return std::sqrt(area1_[A]); }  // of a vertex's share of the surface
    void forget_gradients() { known_at_.clear(), massed_.clear(), rates_at_.clear(); }
    void recall();
    void keep(const Context&);
    void rub(int A, const Context&);
    void book(const Context&, LedgerSums&);
    bool collides(int A, const Context&) const;
    bool closes(int A, const Context&) const;
    bool begins_with_impact(const Context&) const;
    // Whether what sticks is held by the inertia of rigid bodies alone.
    bool is_inertial(const Context&) const;
    Eigen::Vector2d trial(int A, const Context&);
    Sliding slip(int A) const;
    void find_redundant();
    Eigen::Vector3d touching_point(int A) const;
    double yields(int A, int i, const Context&) const;
    void find_way(const Context&);
    Impact impact(int A, const Eigen::VectorXd& f) const;
    void add_to_vertices(int A, const Eigen::VectorXd& f, std::vector<double>& sum) const;
    void press(int A, const Context&, double gap_theta);
    void press_discretely(int A, const Context&);
    double potential(int A, double gap) const;
    void force(int A, const Context&, Eigen::VectorXd& f) const;
    Eigen::Map<Matrix> stiffness(int A, const Context&, const Eigen::VectorXd& g1, const Eigen::VectorXd& f);
    const Places& places(int A);
    void scatter_stiffness(int A, double* values);
    Border border(int A, const Context&, const Eigen::VectorXd& g1, const Eigen::VectorXd& f) const;
    double tangential(int A, const Context&) const;
    void add_friction(int A, const Context&, const Eigen::VectorXd& g1, Eigen::Ref<Matrix> K, Border&) const;
    void scatter(int A, const Border&, double* values);
    void narrow();
    void book_friction(int A, const Context&, const std::vector<double>& way, LedgerSums&);
    Sliding sliding(int A) const { return sliding(A, stencil_of(A, D_)); }
    Sliding sliding(int A, const Eigen::VectorXd& D) const;
    double slip_work(int A, const std::vector<double>& way) const;
    Eigen::VectorXd stencil_of(int A, const std::vector<double>& X) const;
    template <class F>
    void each_form(const std::vector<int>& vertices, F f) const;
    void couple_vertices(Pattern& pattern) const;

    std::shared_ptr<Gaps> gaps_;
    ContactOptions options_;
    double reach_;
    std::vector<double> from_, to_;  // what the last search swept
    std::vector<double> X0_, X1_, Xt_, D_;
    std::vector<double> known_;     // where gap1_ and area1_ were evaluated
    std::vector<double> narrowed_;  // the end of the step for which stencils were made
    std::vector<double> known_at_;  // where the gradients of at_theta_ were evaluated,
    std::vector<char> known_of_;    // and of which gaps
    ContactCosts costs_;
    std::vector<double> rate0_, V0_, rates_at_, rates_of_;  // of closed gaps, where X0_ and V0_ were these
    std::vector<double> gap0_, area0_, gap1_, area1_, gapt_;
    std::vector<double> S_, dS_gap_, R_;  // pressure, its derivative by the gap, residual of the multiplier
    std::vector<double> forces_, friction_forces_;
    std::vector<double> mean_way_;  // increments by the mean of the velocities before and after a step
    Held held_;
    std::vector<char> active_, active_at_tangent_, slips_, slips_at_tangent_;
    std::vector<char> covered_;  // whether so much of a vertex' area is, in this step, that it may carry
    int changes_ = -1;           // of the active set since the step began; -1: not chosen yet
    bool unsettled_ = false, pushed_out_ = false, impacts_ = false;
    std::vector<int> unsettled_gaps_;
    std::vector<Gap> at_start_, at_theta_, at_end_;
    std::vector<Grip> grips_, masses_;
    std::vector<double> massed_;         // the start of the step for which masses were made
    std::vector<Eigen::Vector2d> base_;  // tractions before the step's slip: elastic ones or multipliers
    std::vector<Eigen::Vector2d> free_;  // unit vectors along which an impact lets slip turn round, or 0
    std::vector<Eigen::Vector2d> redundant_;  // parts of the tractions of what sticks that move nothing
    std::vector<double> carried_;        // of the velocities before the step in what must not slip
    std::vector<Traction> traction_;
    std::vector<double> elastic_;       // at the start of the step
    std::vector<double> stored_;        // energy of elastic slip at the end of the step last booked
    Record now_, before_, at_tangent_;  // the latest, the one before, that of the kept tangent
    std::optional<Pattern> pattern_;
    std::vector<Places> places_;
    std::vector<std::int64_t> border_places_;  // what the multipliers' rows and columns have been written to
};

}  // namespace visviva
