// Unilateral contact: gaps that must not become negative, kept so by multipliers with an active set or by a
// penalty, with forces whose momenta vanish and whose work is the change of the gaps.
#pragma once
#include <Eigen/Dense>
#include <cmath>
#include <memory>
#include <optional>

#include "visviva/base/stopwatch.hpp"
#include "visviva/contact/active_set.hpp"
#include "visviva/contact/contact_scatter.hpp"
#include "visviva/contact/friction.hpp"
#include "visviva/contact/gap_memory.hpp"
#include "visviva/contact/gaps.hpp"
#include "visviva/contact/hold.hpp"
#include "visviva/contact/passage.hpp"
#include "visviva/contact/piercing.hpp"
#include "visviva/contact/sags.hpp"
#include "visviva/contact/swept_search.hpp"
#include "visviva/term/term.hpp"

namespace visviva {

// With the traction of each gap from a slip that is elastic up to Coulomb's limit, or from multipliers that
// let nothing slip below it.
struct FrictionOptions {
    double coefficient = 0;
    std::vector<int> multiplier;    // first unknown of each gap's one or two; empty: elastic slip
    std::vector<double> stiffness;  // of each gap: traction per weighted displacement
    std::vector<double> inertia;    // and per weighted acceleration, of multipliers
    std::vector<double> most;       // of it where one side is rigid: what that one has, else 0
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
    double size = 0;              // of a vertex' share of the surface, by which gaps are told from rounding
    bool presses_out = false;     // in time too, what overlaps at the start of a step is pushed apart
    std::vector<double> damping;  // of each gap: pressure per rate of penetration, beside a penalty
    FrictionOptions friction;
};

// CPU seconds that contact has taken, by what for.
struct ContactCosts {
    double search = 0, segments = 0, forces = 0;
};

class ContactTerm : public Term, public NeighbourSearch, public TermMemory {
  public:
    ContactTerm(std::shared_ptr<Gaps> gaps, ContactOptions options, double reach);

    TermCapabilities capabilities() override { return {nullptr, this, this}; }
    void couple(Pattern& pattern) const override;
    void connect(const Pattern& pattern) override;
    bool find_neighbours(const Way&) override;
    bool is_outdated() const override { return active_.is_outdated() || slips_ != slips_at_tangent_; }
    bool update_tangent(const Context&, double* values) override;
    void begin(const double* x0) override;
    void residual(const Context&, double* r) override;
    void tangent(const Context&, double* values) override;
    void ledger(const Context&, const double* v1, LedgerSums&) override;
    void accept(const Context&) override;
    Refusal refuse(const Context&) override;
    void write_memory(std::vector<double>& memory) const override;
    bool read_memory(const double*& memory) override;
    std::any evaluation() const override;
    void restore_evaluation(const std::any&) override;
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
    /// Vertices that pressed on other facets in the last such iteration of a load step than where it began.
    const std::vector<int>& roaming() const { return roaming_; }
    int n() const { return gaps_->n(); }
    /// Forces on all vertices in the last step, three numbers each: of the pressures, and of friction.
    const std::vector<double>& forces() const { return forces_; }
    const std::vector<double>& friction_forces() const { return friction_forces_; }
    const ContactCosts& costs() const { return costs_; }
    const Gaps& gaps() const { return *gaps_; }

    /// Steps in which two rigid bodies sink into each other beside their gaps fail from now on.
    void watch(Piercing piercing) { piercing_ = std::move(piercing); }
    /// How deep gaps are closed in the last step.
    double deepest() const;
    /// Another contact of the same bodies, evaluated before this one, whose gaps see what the watch need not
    /// and share pressures with these.
    void stand_beside(std::shared_ptr<ContactTerm> other) {
        other->stands_beside_ = true;
        beside_ = std::move(other);
    }

    /// A contact between one of the bodies and another one, beside which this one's may be flush.
    void lie_beside(const ContactTerm& other) { fellows_.push_back(other.sags_); }
    /// Its other body, which may cover what the first (0) or second side, `own`, shows.
    void cover(int side, std::shared_ptr<Cover> own, std::shared_ptr<Cover> other) {
        gaps_->covers().add(side, std::move(own), std::move(other));
    }

    /// Data of all gaps for the heat that passes in the step under way. By rates, what friction makes is that
    /// of the rates of a scheme with a history at its end, which increments lag behind by half a step.
    void find_passages(const Context&, bool gradients, bool by_rates, std::vector<Passage>& out);
    /// Multipliers of a gap, of pressure and then of traction, and which of a passage's three one is.
    std::vector<int> multipliers(int A) const { return scatter_.multipliers(A); }
    int multiplier_place(std::size_t m) const { return static_cast<int>(m) + (has_multipliers() ? 0 : 1); }

    int work_account = -1, energy_account = -1, friction_account = -1, slip_energy_account = -1;

  private:
    // Result of the last evaluation.
    struct Evaluation {
        std::vector<double> S, gap1, area1, forces, friction_forces;
        std::vector<char> active, slips;
        std::vector<Grip> grips;
        std::vector<Traction> traction;
    };
    using Border = ContactScatter::Border;
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    bool has_multipliers() const { return !options_.multiplier.empty(); }
    bool has_friction() const { return options_.friction.coefficient > 0; }
    bool has_tangential() const { return !options_.friction.multiplier.empty(); }
    bool has_history() const { return has_friction() && !has_tangential(); }
    bool rebounds() const { return options_.rigid && has_multipliers(); }
    // Rigid bodies are pushed out of each other in the first step: what impacts leave later is not.
    bool pushes_out() const { return options_.presses_out && !pushed_out_; }
    // Whether gaps close freely, and are held from then on.
    bool holds(const Context& c) const { return (options_.conserving || rebounds()) && !c.step.is_static(); }
    bool is_discrete(const Step& s) const { return s.stress == Stress::discrete_gradient; }
    int vertex_of(int gap) const;
    Refusal refused(int vertex, const std::string& why) const;
    Refusal refused(const double* place, int vertex, const std::string& why) const;
    int passes(const std::vector<Approach>&, int n_parts);
    Piercing::Finding look(const Context&);
    double depth(int A, const std::vector<double>& gap, const std::vector<double>& area) const;
    void evaluate(const Context&, bool chooses, bool gradients = false);
    void settle();
    void find_sags();
    Sags sags_at(const std::vector<double>& X, const std::vector<double>& gap,
                 const std::vector<double>& area, const std::vector<double>& pressed);
    void find_landing(const Context&);
    int lands_beside();
    void share_sags();
    void find_gaps();
    void find_gradients();
    // Time spent in the segments, and not in the forces around them.
    template <class F>
    void segments(F f) {
        double spent = 0;
        {
            const Stopwatch watch(spent);
            f();
        }
        costs_.segments += spent, costs_.forces -= spent;
    }
    double augmentation(int A, const Context&) const;
    void update_active_set(const Context&);
    bool wants_pressure(int A, const Context&) const;
    double least_gap(int A, const Context&) const;
    double rebound(int A, const Context&) const;
    double sink(int A, const Context&) const;
    void keep_landings();
    void carry_landings(const std::vector<long>& places, const std::vector<double>& gap,
                        const std::vector<double>& area);
    void carry_tractions(const std::vector<long>& places);
    bool hands_over() const { return sags() && (beside_ || stands_beside_); }
    Hold hold(int A, const Gap&) const;
    std::vector<Hold> held() const;
    void let_go_of(const std::vector<Hold>& held);
    void find_come();
    void hand_over();
    void go_on(const Hold& own);
    bool closed(int A) const;
    double compliance(int A, const Context&) const;
    bool is_rigid_pair() const;
    void subtract_idle(const Context&, double* r) const;
    void find_rates(const Context&);
    double slack(int A, const Context&) const;
    void find_covered(const Context&);
    bool is_covered(int A, const std::vector<double>& area) const;
    void find_masses(bool gradients);
    void forget_gradients() { known_at_.clear(), massed_.clear(), rates_at_.clear(); }
    void find_rubbed(const Context&);
    void find_traction(int A, const Context&);
    void add_to_ledger(const Context&, LedgerSums&);
    double let_go(const Context&) const;
    bool collides(int A, const Context&) const;
    bool closes(int A, const Context&) const;
    bool rubs_in_impact(const Context&) const;
    bool may_rest(const Context&) const;
    void find_resting(const Context&);
    bool slides_straight() const;
    // Whether rigid bodies lie in each other as deep as a penalty lets them.
    bool sags() const { return options_.rigid && !has_multipliers(); }
    // And others may be flush with them.
    bool lies_beside() const { return options_.rigid && !fellows_.empty(); }
    bool keeps_slides() const { return rebounds() && has_tangential(); }
    void keep_slides();
    bool has_several() const;
    bool gives_energy(const Context&);
    int rubs_too_late(const Context&) const;
    int climbs(const Context&) const;
    void note_attempt(double h);
    Eigen::Vector2d trial(int A, const Context&);
    Sliding slip(int A) const;
    void find_mean_increments(const Context&);
    Impact impact(int A, const Eigen::VectorXd& f) const;
    void add_to_vertices(int A, const Eigen::VectorXd& f, std::vector<double>& sum) const;
    void press(int A, const Context&, double gap_theta);
    void press_discretely(int A, const Context&);
    double potential(int A, double gap) const;
    void force(int A, const Context&, Eigen::VectorXd& f) const;
    Eigen::Map<Matrix> stiffness(int A, const Context&, const Eigen::VectorXd& g1, const Eigen::VectorXd& f);
    Border border(int A, const Context&, const Eigen::VectorXd& g1, const Eigen::VectorXd& f) const;
    // Whether rigid bodies press, or press and rub, by multipliers, which their inertia alone answers to.
    bool answers_by_inertia(const Context&) const;
    bool is_inertial(const Context&) const;
    double exchange(int A, const Context&) const;
    double tangential(int A, const Context&) const;
    void add_friction(int A, const Context&, const Eigen::VectorXd& g1, Eigen::Ref<Matrix> K, Border&) const;
    void narrow();
    void book_friction(int A, const Context&, const std::vector<double>& way, LedgerSums&);
    Sliding sliding(int A) const { return sliding(A, stencil_of(A, D_)); }
    Sliding sliding(int A, const Eigen::VectorXd& D) const;
    double slip_work(int A, const std::vector<double>& way) const;
    double rubbed(int A, const Context&, const std::vector<double>& way) const;
    void differentiate_rubbed(int A, const Context&, const Eigen::RowVectorXd& pressure,
                              const std::vector<double>& along, double by_step, Passage&) const;
    Eigen::VectorXd stencil_of(int A, const std::vector<double>& X) const;
    static Eigen::Map<const Eigen::VectorXd> as_vector(const std::vector<double>& a) {
        return {a.data(), static_cast<Eigen::Index>(a.size())};
    }
    static constexpr double touching = 1e-9;  // part of a vertex's share of the surface

    std::shared_ptr<Gaps> gaps_;
    ContactOptions options_;
    SweptSearch search_;
    std::optional<Piercing> piercing_;
    std::shared_ptr<ContactTerm> beside_;
    GapMemory pressed_;  // of what sags, pressures
    struct StepSags {
        Sags start, end, landing;
    };
    double landed_in_ = 0;  // the length of the step for which its landing is known
    std::shared_ptr<StepSags> sags_ = std::make_shared<StepSags>();  // of its own gaps
    std::vector<std::shared_ptr<const StepSags>> fellows_;
    std::vector<double> shared_sags_;  // the start of the step for which those of all were put together
    bool stands_beside_ = false;
    ActiveSet active_;
    ContactScatter scatter_;
    std::vector<double> X0_, X1_, Xt_, D_;
    std::vector<double> Xr_;        // where surfaces rub
    std::vector<double> known_;     // where gap1_ and area1_ were evaluated
    std::vector<double> narrowed_;  // the end of the step for which stencils were made
    std::vector<double> known_at_;  // where the gradients of at_theta_ were evaluated,
    std::vector<char> known_of_;    // and of which gaps
    ContactCosts costs_;
    std::vector<double> rate0_, V0_, rates_at_, rates_of_;  // of closed gaps, where X0_ and V0_ were these
    std::vector<double> gap0_, area0_, gap1_, area1_, gapt_;
    std::vector<double> S_, dS_gap_, R_;  // pressure, its derivative by the gap, residual of the multiplier
    std::vector<double> forces_, friction_forces_;
    std::vector<double> mean_increments_;  // increments by the mean of the velocities before and after a step
    std::vector<char> slips_, slips_at_tangent_;
    std::vector<char> covered_;  // whether so much of a vertex' area is, in this step, that it may carry
    bool pushed_out_ = false, is_rigid_pair_ = false;
    bool is_balance_ = false;  // whether the last step was a load step
    // Of rigid bodies, by area: the gap at which a vertex first carried since it was open, else `in_flight`.
    GapMemory landings_;
    static constexpr double in_flight = -HUGE_VAL;
    double let_go_ = 0;  // energy that a penalty had at the end of the last step in what has slid off an edge
    std::vector<Hold> lost_, come_;  // what held it, and what has come to lie in the other body elsewhere
    void find_roaming();
    std::vector<int> unsettled_gaps_, roaming_;
    std::vector<double> tried_at_;  // where the last attempt at a step began, and how long it was
    double tried_ = 0;
    bool retried_ = false;  // whether a longer step from here has been tried in vain
    std::vector<Gap> at_start_, at_theta_, at_end_;
    std::vector<Grip> grips_, masses_;
    std::vector<double> massed_;         // the start of the step for which masses were made
    std::vector<Eigen::Vector2d> base_;  // tractions before the step's slip: elastic ones or multipliers
    std::vector<Eigen::Vector2d> free_;  // unit vectors along which an impact lets slip turn round, or 0
    std::vector<double> carried_;        // of the velocities before the step in what must not slip
    std::vector<char> rests_;            // whether what sticks has come to rest at the end of the step
    GapMemory slid_;  // 1 where a velocity along the surface may be left, of gaps that slipped
    std::vector<Traction> traction_;
    GapMemory elastic_;           // tractions of elastic slip, two for each gap
    std::vector<double> stored_;  // energy of elastic slip at the end of the step last booked
};

}  // namespace visviva
