"""The audit: what a run conserved, and a verdict on what it did not."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from visviva.results.result import Result
    from visviva.system.system import System

CONSERVED = 1e-9
"""Relative errors up to this are those of rounding and of Newton's method."""
LOOSE = 1e-6
"""Errors of schemes that conserve energy up to this may be those of loose tolerances, in many steps."""
SNAPPED = 0.3
"""Statics whose work misses more of the energies than this was not followed step by step."""
SUMMED = 0.1
"""Part of all work done by which its sums over steps may miss it: more is not resolved by the steps."""
OVERSHOOT = 0.1
"""Part of the energy lost so far that schemes may give back which dissipate over many steps, but not in each."""


def audit(result: Result) -> str:
    """What was conserved, in ten lines."""
    system, s, ledger = result.system, result.statistics, result.ledger
    f = result.conservation()
    works = ", ".join(f"{k} {ledger.last(f'work_{k}'):.6g}" for k in ledger.works) or "none"
    seconds = max(s.seconds, 1e-12)
    moved = [f"  initial state moved onto the constraints: {'; '.join(ledger.moves)}"] if ledger.moves else []
    return "\n".join(
        [
            f"audit of {s.steps} steps to t = {system.time:.6g} with {result.scheme}",
            f"  unknown coordinates n = {system.n_coordinates}, constraints m = {system.n_constraints}",
            *moved,
            f"  linear solver for {system.linear_explanation}",
            f"  Newton iterations per step {s.iterations / max(s.steps, 1):.2f}, steps retried {s.rejected}, "
            f"{seconds:.3g} s ({1e6 * seconds / max(s.steps, 1):.3g} us per step){gauge_text(system)}",
            f"  total energy {ledger.first('total'):.12g} -> {ledger.last('total'):.12g}",
            f"  work done on the system: {works}",
            f"  energy balance closes to {f['energy']:.1e} of {ledger.energy_scale:.4g}: {energy_verdict(result)}",
            *momentum_lines(result),
            *([f"  equilibria: {system.stepper.stability}"] if system.stepper.stability.equilibria else []),
            f"  constraints hold (relative) to {f['constraints']:.1e}, "
            f"their rates to {f['constraint rates']:.1e}",
        ]
    )


def energy_verdict(result: Result) -> str:
    """Whether the energy balance closes as the scheme promises.

    Conserved, dissipated by the scheme, not meant to be conserved by it, or wrong.
    """
    ledger, scheme = result.ledger, result.scheme
    gained, lost = (
        x / ledger.energy_scale for x in (ledger.greatest("imbalance"), -ledger.least("imbalance"))
    )
    if max(gained, lost) <= CONSERVED:
        return "conserved"
    if scheme.conserves_energy and max(gained, lost) <= LOOSE:
        return "conserved as well as the tolerances of the solvers allow"
    if scheme.conserves_energy:
        return (
            "WRONG, as this scheme conserves energy: the work of some force is not booked, or its stress is no "
            "discrete gradient of its energy"
        )
    if not scheme.has_inertia and max(gained, lost) > SNAPPED:
        return (
            "WRONG, if load steps were short: most likely the structure snapped to an equilibrium far away; follow "
            "its path with vv.arc_length, or take the snap in steps of dynamics"
        )
    if not scheme.has_inertia:
        return "not meant to be exact: work along the load steps is a trapezoidal sum, of second order in their length"
    missed = SUMMED * sum(ledger.swing(f"work_{k}") for k in ledger.works) / ledger.energy_scale
    if CONSERVED < gained <= missed:
        of = " and ".join(ledger.works)
        return f"not meant to be exact: work of {of} is a sum over steps, see how it falls with the step"
    if not scheme.dissipates:
        return "not meant to be conserved by this scheme, see how it falls with the step"
    if gained > OVERSHOOT * lost + CONSERVED:
        return (
            "WRONG, as this scheme is to dissipate energy, and there was more than before: take shorter steps"
        )
    return "dissipated by the scheme"


def momentum_lines(result: Result) -> list[str]:
    """Changes of the momenta that there are, and which of them were conserved; statics has none."""
    if not result.scheme.has_inertia:
        return []
    figures, lines = result.conservation(), []
    for (kind, name), axes in zip(
        (("momentum", "linear"), ("angular", "angular")), axes_of(result.system), strict=True
    ):
        changes = {c: figures[f"{kind}_{c}"] for c in axes}
        if not changes:
            continue
        kept = [c for c, change in changes.items() if change <= CONSERVED]
        verdict = f"conserved along {', '.join(kept)}" if kept else "changed from outside along all axes"
        if len(kept) == len(changes):
            verdict = "conserved"
        text = "  ".join(f"{c} {change:.1e}" for c, change in changes.items())
        lines.append(f"  {f'{name} momentum changes (relative)':<36} {text}: {verdict}")
    return lines


def axes_of(system: System) -> tuple[str, str]:
    """Axes along which linear and angular momentum can be there: in the plane and about revolutions not all."""
    if any(getattr(c, "axisymmetric", False) for c in system.components):
        return "y", ""
    moving = [f for f in system.model.fields if f.order == 2]
    if moving and all(f.node == 2 for f in moving):
        return "xy", "z"
    return "xyz", "xyz"


def gauge_text(system: System) -> str:
    """What components show of the last step, behind a bar or an audit's line.

    Examples
    --------
    >>> import visviva as vv
    >>> square = vv.RectangleMesh(size=(1, 1), counts=(4, 4))
    >>> stream = {"velocity": (2, 0, 0), "periodic": (("x0", "x1"), ("y0", "y1"))}
    >>> system = vv.System([vv.Fluid(mesh=square, density=1.0, viscosity=1.0, **stream)])
    >>> _ = vv.simulate(system, until=0.1, step=0.1)
    >>> gauge_text(system)
    ', CFL 0.8'
    """
    return "".join(f", {name} {value:.2g}" for name, value in system.gauges().items())
