// Maxwell branches that heat: their energy is dissipated into the entropy of a solid, and their times shift
// with its temperature.
#pragma once
#include "visviva/point/branch.hpp"
#include "visviva/point/maps.hpp"
#include "visviva/point/pairings.hpp"

namespace visviva::VISVIVA_ISA {

/// (C, theta, s): positions with the C of a map, the temperature of the step, the entropy whose balance takes
/// the heat.
template <class Base>
struct HeatedBranchMap : Layout<HeatedBranchMap<Base>> {
    static constexpr int first = Base::n_local;
    static constexpr int n_groups = 3, n_components = Base::n_components + 2, n_local = first + 2,
                         n_strains = 8;
    static constexpr Group groups[] = {Base::groups[0], {1, 1, 0, true}, {1, 1, 1}};
    static constexpr double origin(int j) { return j < first ? Base::origin(j) : 0.0; }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        Base::strains(y, e);
        e[6] = y[first], e[7] = y[first + 1];
    }
};

/// Dependence of the time of relaxation on the temperature, time a(theta): none, ln a = -c1 (theta -
/// theta_r) / (c2 + theta - theta_r) (Williams, Landel & Ferry), or ln a = c1 (1 / theta - 1 / theta_r)
/// (Arrhenius).
enum class TimeShift : int { none = 0, wlf = 1, arrhenius = 2 };

/// 1 / a, and d ln(1 / a) / d theta. Below the pole of the law of Williams, Landel & Ferry nothing flows.
VISVIVA_INLINE void faster(TimeShift kind, V c1, V c2, V reference, V theta, V& factor, V& slope) {
    factor = broadcast(1.0), slope = V{};
    if (kind == TimeShift::wlf) {
        const V rise = theta - reference, sum = c2 + rise;
        const VI flows = sum > 1e-3 * c2;
        const V safe = select(flows, sum, broadcast(1.0)), log = select(flows, c1 * rise / safe, V{});
        factor = select(flows & (log > -600.0), vexp(vmax(log, broadcast(-600.0))), V{});
        slope = select(flows, c1 * c2 / (safe * safe), V{});
    } else if (kind == TimeShift::arrhenius) {
        const VI hot = theta > 0.0;
        const V safe = select(hot, theta, broadcast(1.0)), log = c1 * (1.0 / reference - 1.0 / safe);
        factor = select(hot & (log > -600.0), vexp(vmax(log, broadcast(-600.0))), V{});
        slope = select(hot, c1 / (safe * safe), V{});
    }
}

/// The energy of a branch, whose strains are C and theta although it depends on C alone: the place of the
/// stress of theta is that of the heat per time, -dW/dA : A'. Parameters: those of a branch, then kind of the
/// shift of its times, c1, c2, theta_r.
struct HeatedBranchEnergy : PlainEnergy {
    static constexpr int n = 13, n_internal = 6, shift = branch::n_par, max_par = shift + 4;
    const V* p;
    explicit HeatedBranchEnergy(const V* par) : p(par) {}

    static void without_temperature(const V* z, V* c) {
        for (int k = 0; k < 6; ++k) c[k] = z[k], c[6 + k] = z[7 + k];
    }
    template <bool second>
    void evaluate(const V* z, Potential<n>& to) const {
        static_assert(!second);
        V c[12];
        Potential<12> w;
        without_temperature(z, c);
        BranchEnergy(p).evaluate<false>(c, w);
        to.W = w.W;
    }
};

/// A branch as it is at a temperature.
struct BranchAt {
    V par[branch::n_par], slope;
    BranchAt(const V* p, V theta) {
        constexpr int shift = HeatedBranchEnergy::shift;
        V factor;
        faster(static_cast<TimeShift>(static_cast<int>(p[shift][0])), p[shift + 1], p[shift + 2],
               p[shift + 3], theta, factor, slope);
        for (int k = 0; k < branch::n_par; ++k) par[k] = p[k];
        par[branch::fluidity] *= factor;
    }
    BranchEnergy energy() const { return BranchEnergy(par, slope); }
};

/// The end of a step at a point, see `evolve`: the branch's own, with the heat and what it changes by. What
/// the branch loses is heat, so that its internal variables leave no stress behind. Heat per time is that of
/// the last stage: where forces balance at the end of a step, so does entropy.
template <bool tangent>
VI evolve(const HeatedBranchEnergy& energy, const Step& step, int active, const V* z0, V* z1, V* zt, V* s,
          V* T, V& lost) {
    constexpr int n = HeatedBranchEnergy::n;
    const BranchAt early(energy.p, z0[6] + first_stage * (z1[6] - z0[6])), late(energy.p, z1[6]);
    const BranchEnergy own = late.energy();
    V e0[12], e1[12], et[12], stress[12], moduli[144];
    HeatedBranchEnergy::without_temperature(z0, e0), HeatedBranchEnergy::without_temperature(z1, e1);
    HeatedBranchEnergy::without_temperature(zt, et);
    Evolution<BranchEnergy> at{own, step, e0, e1, et, stress, moduli, step.h > 0 ? step.h : 0};
    const VI done = evolve<tangent>(early.energy(), at, active, lost);
    const double per_time = at.dt > 0 ? 1 / at.dt : 0;
    for (int k = 0; k < 6; ++k)
        s[k] = stress[k], s[7 + k] = V{}, z1[7 + k] = e1[6 + k], zt[7 + k] = et[6 + k];
    s[6] = per_time * at.lost(), lost = V{};  // it becomes heat
    if constexpr (tangent) {
        const double share = at.ends() ? 1.0 : step.theta;
        for (int k = 0; k < n * n; ++k) T[k] = V{};
        for (int i = 0; i < 6; ++i)
            for (int j = 0; j < 7; ++j) {
                V sum{}, inner = j < 6 ? moduli[12 * (6 + i) + j] : V{};
                for (int m = 0; m < 6; ++m) {
                    sum -= share * moduli[12 * i + 6 + m] * at.X[7 * m + j];
                    inner -= share * moduli[12 * (6 + i) + 6 + m] * at.X[7 * m + j];
                }
                T[n * i + j] = j < 6 ? moduli[12 * i + j] : sum;  // by strains it is condensed
                const V moved = at.X[7 * i + j] - at.by_ahead[7 * i + j];
                T[n * 6 + j] += per_time * (stress[6 + i] * moved - inner * at.change(i));
            }
    }
    return done;
}

/// The heat per time of a branch, by the temperature of the step, is entropy that arises.
struct HeatingPairing {
    static constexpr bool is_gradient = false;
    template <class State>
    static VISVIVA_INLINE void forces(const State& z, typename State::T* f) {
        for (int k = 0; k < 6; ++k) f[k] = z.s(k);
        f[6] = 0.0 * z.e(6);
        f[7] = -1.0 * (z.s(6) / z.e(6));
    }
    template <class State>
    static VISVIVA_INLINE V dissipated(const State&) {
        return V{};
    }
};

}  // namespace visviva::VISVIVA_ISA
