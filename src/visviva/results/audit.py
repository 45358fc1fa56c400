"""The audit: what a run conserved, and a verdict on what it did not."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from visviva.body.mesh_body import MeshBody
from visviva.flow.fluid import Fluid
from visviva.results.groups import CONSERVED, LOOSE, NAMED, OVERSHOOT, ROUNDING, SUMMED, SWAYING, alone
from visviva.results.lags import Lag
from visviva.results.missed import PART
from visviva.results.naming import labels_of
from visviva.results.outside import outside
from visviva.results.second_law import changed, second_law
from visviva.results.spread import unbooked
from visviva.system.actuated import leaves_rates

if TYPE_CHECKING:
    from visviva.component.component import Component
    from visviva.output.labels import Labels
    from visviva.results.ledger import Ledger
    from visviva.results.result import Result
    from visviva.system.system import System

RINGS = "WRONG, as it rings after a sudden change: let that come over some steps, take shorter ones, or BackwardEuler"
SNAPPED = 0.3
"""Statics whose work misses more of the energies than this was not followed step by step."""
ROUNDED = 1e-3
"""Part of the energies that differences of them may miss, up to half of what they tell: small strains are rounded."""
PASSED = 0.07
"""Part of its momentum that fluid within a rigid body may lack: with marks as close as nodes it was less."""


UNPROMISED = "not meant to be conserved by this scheme, see how it falls with the step"
ASTRAY = (
    "WRONG, as this scheme neither conserves energy nor damps, and that went far astray: take shorter steps, or "
    "EnergyMomentum(), by which it is seen whether all work is booked"
)
UNTOLD = (
    "NOT CHECKED, as of functions that fail between the states, and of forces that do not tell what they act on, it is "
    "not known what trapezoidal sums of work along load steps miss: a force whose work is not booked could go unseen"
)
SERVED = (
    "NOT CHECKED of what hangs together with servos, where a force whose work is not booked could go unseen; of all "
    "else "
)
NOTHING = 1e-16
"""Relative errors below are written as none."""


@dataclass(frozen=True)
class Judgement:
    """A line of the audit: about what, the figures, and what to think of them.

    Attributes
    ----------
    what, figures : str
    verdict : str
        Begins with ``conserved``, ``fulfilled``, ``dissipated``, ``not meant to be`` or ``WRONG``.
    """

    what: str
    figures: str
    verdict: str

    @property
    def is_wrong(self) -> bool:
        """True if the user has to act."""
        return self.verdict.startswith("WRONG")

    def __str__(self) -> str:
        return f"{' '.join(filter(None, (self.what, self.figures)))}: {self.verdict}"


def audit(result: Result) -> str:
    """Audit of a run: what was done, and a line with a verdict about everything that may be conserved."""
    return "\n".join([*(f"  {line}" if k else line for k, line in enumerate(course(result))),
                      *(f"  {judged}" for judged in judgements(result))])  # fmt: skip


def course(result: Result) -> list[str]:
    """Lines on the course of a run: steps, size, solver, energies and works."""
    system, s, ledger = result.system, result.statistics, result.ledger
    labels = labels_of(system.units, result.scheme)
    works = ", ".join(f"{k} {energy(f'work_{k}', ledger, labels)}" for k in ledger.works) or "none"
    seconds = max(s.seconds, 1e-12)
    end = with_unit(f"{ledger.last('time'):.6g}", labels.unit("time"))
    clock = {"time": "t =", "state": "load parameter"}.get(labels.clock, labels.clock)
    moved = [f"initial state made consistent: {'; '.join(ledger.moves)}"] if ledger.moves else []
    heats = ", ".join(f"{k} {energy(f'heat_{k}', ledger, labels)}" for k in ledger.heats)
    supplied = [f"heat supplied to the system: {heats}"] if heats else []
    entropy = [changed(ledger, labels.unit("entropy"))] if ledger.entropy else []
    return [
        f"audit of {s.steps} steps to {clock} {end} with {result.scheme}",
        f"unknown coordinates n = {system.n_coordinates}, constraints m = {system.n_constraints}",
        *moved,
        f"linear solver for {system.linear_explanation}",
        f"Newton iterations per step {s.iterations / max(s.steps, 1):.2f}, steps retried {s.rejected}, "
        f"{seconds:.3g} s of computing ({1e6 * seconds / max(s.steps, 1):.3g} us per step){gauge_text(system)}",
        f"total energy {energy('total', ledger, labels, start=True)} -> {energy('total', ledger, labels)}",
        f"work done on the system: {works}",
        *supplied,
        *entropy,
    ]


def energy(name: str, ledger: Ledger, labels: Labels, *, start: bool = False) -> str:
    """An energy at the start or the end with its unit; what is rounding beside those in play is none."""
    value = ledger.first(name) if start else ledger.last(name)
    rounding = abs(value) <= ROUNDING * max(ledger.energy_scale, ledger.size(name))
    digits = 12 if name == "total" else 6
    return (
        f"{value:.{digits}g}"
        if start and not rounding
        else measured(0.0 if rounding else value, labels, digits)
    )


def measured(value: float, labels: Labels, digits: int = 6) -> str:
    """An energy with its unit."""
    return with_unit(f"{value:.{digits}g}", labels.unit("energy"))


def with_unit(text: str, unit: str) -> str:
    """A number with its unit, if there is one."""
    return f"{text} {unit}".rstrip()


def judgements(result: Result) -> list[Judgement]:
    """Verdicts on the energy, the momenta, equilibria and constraints of a run."""
    ledger, stability = result.ledger, result.stability
    scale = measured(ledger.energy_scale, labels_of(result.system.units, result.scheme), 4)
    first_law = "energy balance (first law)" if ledger.entropy or ledger.heats else "energy balance"
    found = [Judgement(first_law, f"closes to {told(ledger.imbalance())} of {scale}", energy_verdict(result))]
    if entropy := second_law(result):
        found.append(Judgement("entropy balance (second law)", *entropy))
    found += momentum_judgements(result)
    if result.statistics.swings:
        found.append(Judgement("changes", f"taken back by {result.statistics.swings} steps in a row", RINGS))
    found += [passing(lag) for lag in ledger.sizes.lags if lag.part > PASSED]
    if stability.equilibria:
        found.append(Judgement("equilibria", "", str(stability)))
    if result.system.n_constraints:
        found += constraint_judgements(result)
    return found


def passing(lag: Lag) -> Judgement:
    """Of a rigid body whose fluid inside does not move along."""
    wet = lag.wet
    return Judgement(
        f"fluid within {wet.body.label}",
        f"lacks {lag.part:.2g} of its momentum",
        f"WRONG, as it passes between the marks of {wet.label} and circulates there: {wet.closer}",
    )


def told(error: float) -> str:
    """A relative error; what is far below rounding is none."""
    return f"{error:.1e}" if error >= NOTHING else "0"


def constraint_judgements(result: Result) -> list[Judgement]:
    """Judge the violation of constraints at the ends of steps, and of their rates where the scheme enforces them."""
    figures, scheme = result.conservation(), result.scheme
    held, rates = figures["constraints"], figures["constraint rates"]
    found = [Judgement("constraints", f"hold to {told(held)} of their reach", fulfilled(held))]
    if not scheme.has_inertia:
        return found
    system = result.system
    projected = scheme.projects_velocity and (
        system.core.projects_rates or (system.projects(scheme) and not leaves_rates(system))
    )
    if rates <= CONSERVED or projected:
        verdict = fulfilled(rates)
    else:
        verdict = "not meant to be exact: this scheme holds positions; rates follow to its order in the step"
    figure = (
        f"hold to {told(rates)}" if verdict.startswith("fulfilled") or verdict.startswith("WRONG") else ""
    )
    return [*found, Judgement("their rates", figure, verdict)]


def fulfilled(error: float) -> str:
    """Verdict on equations that Newton's method solves."""
    if error <= CONSERVED:
        return "fulfilled"
    if error <= LOOSE:
        return "fulfilled as well as the tolerances of the solvers allow"
    return "WRONG, positions do not fit: tighten Newton(tolerance=...), or shorten the step"


def energy_verdict(result: Result) -> str:
    """Judge the defect of the energy balance by what the scheme promises.

    Conserved, dissipated by the scheme, not meant to be conserved by it, or wrong.
    """
    ledger, scheme = result.ledger, result.scheme
    gained, lost = (
        x / ledger.energy_scale for x in (ledger.greatest("imbalance"), -ledger.least("imbalance"))
    )
    leaking = next(alone(ledger, scheme), "")
    if leaking and (not scheme.conserves_energy or max(gained, lost) <= LOOSE):
        return leaking
    if max(gained, lost) <= CONSERVED:
        return "conserved"
    if scheme.conserves_energy and max(gained, lost) <= LOOSE:
        return "conserved as well as the tolerances of the solvers allow"
    if not scheme.has_inertia:
        return statics_verdict(result, max(gained, lost))
    if excuse := next(excuses(result, gained, lost), ""):
        return leaking or excuse
    if scheme.conserves_energy:
        return (
            "WRONG, as this scheme conserves energy: the work of some force is not booked, or its stress is no "
            "discrete gradient of its energy"
        )
    if not scheme.dissipates:
        return UNPROMISED if max(gained, lost) <= SWAYING else ASTRAY
    if gained > OVERSHOOT * lost + CONSERVED:
        if scheme.order > 1 and gained <= SWAYING:
            return UNPROMISED
        return (
            "WRONG, as this scheme is to dissipate energy, and there was more than before: take shorter steps"
        )
    return "dissipated by the scheme"


def statics_verdict(result: Result, missed: float) -> str:
    """Judge what works along load steps miss of the energies, which contents change as well."""
    ledger, scale = result.ledger, result.ledger.energy_scale
    sums = ledger.sizes.missed
    if sums is not None and sums.lacking > max(LOOSE * scale, min(PART * sums.most, ROUNDED * scale)):
        may = ledger.sizes.unbooked.stored + CONSERVED * scale
        if (why := unbooked(result.system.components)) and sums.lacking <= may:
            return exempted(why)
        return (
            f"WRONG, as the balance lacks {told(sums.lacking / scale)} beside what trapezoidal sums of work along "
            "these load steps miss: the work of some force is not booked, or its stress is not that of its energy"
        )
    apart = () if sums is None else sums.apart
    if sums is not None and np.isnan(sums.lacking) and (apart or sums.serves or missed <= SNAPPED):
        return UNTOLD
    served = SERVED if sums is not None and sums.serves else ""
    if (sums.most / scale if sums is not None and (apart or served) else missed) > SNAPPED:
        return (
            "WRONG, if load steps were short: take shorter ones, and if that stays so, the structure snapped to an "
            "equilibrium far away: follow its path with vv.arc_length, or take the snap in steps of dynamics"
        )
    if apart:
        return f"{served}not meant to be exact: load steps take no time, and {', and '.join(apart)}"
    return f"{served}not meant to be exact: work along the load steps is a trapezoidal sum, of second order in them"


def exempted(why: Mapping[Component, str]) -> str:
    """Verdict on a balance that components have no accounts for."""
    return f"not meant to be exact: {', '.join([f'{c.label} {said}' for c, said in why.items()][:NAMED])}"


def excuses(result: Result, gained: float, lost: float) -> Iterator[str]:
    """Why the energy need not balance, as far as what is named can bring that about."""
    ledger, scheme = result.ledger, result.scheme
    own, lacking = ledger.sizes.spread, ledger.sizes.unbooked
    brought, scale = sum(map(ledger.swing, ledger.brought)), ledger.energy_scale
    why = unbooked(result.system.components)
    stored_or_gone = (lacking.stored + lacking.done) / scale
    if why and gained <= lacking.stored / scale and (scheme.dissipates or lost <= stored_or_gone):
        yield exempted(why)
    if scheme.conserves_energy:
        return
    did = [name for name in ledger.brought if ledger.swing(name) > CONSERVED * ledger.energy_scale]
    of = " and ".join(dict.fromkeys(name.split("_", 1)[1] for name in did))
    if CONSERVED < gained <= SUMMED * brought / scale:
        yield f"not meant to be exact: work of {of} is a sum over steps, see how it falls with the step"
    by_spread = (own.done + SUMMED * max(own.stored, ledger.heat_inside)) / scale
    if scheme.dissipates and gained <= by_spread and (gained > CONSERVED or ledger.entropy or ledger.heats):
        yield UNPROMISED  # it damps motion, the rest either way


def momentum_judgements(result: Result) -> list[Judgement]:
    """Verdicts on the momenta that there are; statics has none."""
    if not result.scheme.has_inertia:
        return []
    kinds = (("momentum", "linear"), ("angular", "angular"))
    axes = zip(kinds, axes_of(result.system), strict=True)
    return [
        momentum_judgement(result, kind, f"{name} momentum", along) for (kind, name), along in axes if along
    ]


def momentum_judgement(result: Result, kind: str, what: str, axes: str) -> Judgement:
    """Along which axes a momentum was conserved, and why not along the others."""
    changes = {c: result.ledger.drift(f"{kind}_{c}") for c in axes}
    text = f"changes by {', '.join(f'{c} {told(change)}' for c, change in changes.items())}"
    verdicts: dict[str, str] = {}
    for c, change in changes.items():
        said = reason(result, kind, c, change)
        verdicts[said] = verdicts.get(said, "") + c
    if len(verdicts) == 1 and not (only := next(iter(verdicts))).startswith("not meant"):
        return Judgement(what, text, only)
    ranked = sorted(
        verdicts, key=lambda said: [said.startswith(first) for first in ("not", "conserved", "WRONG")]
    )
    return Judgement(what, text, "; ".join(placed(said, verdicts[said]) for said in ranked))


def placed(verdict: str, axes: str) -> str:
    """A verdict with the axes that it is about behind its first words."""
    for words in ("WRONG", "conserved", "not meant to be exact", "not meant to be"):
        if verdict.startswith(words):
            return f"{words} along {', '.join(axes)}{verdict.removeprefix(words)}"
    raise AssertionError(verdict)


def reason(result: Result, kind: str, axis: str, change: float) -> str:
    """Judge the relative change of a momentum along an axis."""
    if change <= CONSERVED:
        return "conserved"
    place = 0 if kind == "momentum" else 1
    actors = [c for c, axes in outside(result.system) if axis in axes[place]]
    if actors:
        named = ", ".join(c.label for c in actors[:NAMED]) + (", ..." if len(actors) > NAMED else "")
        return f"not meant to be: from outside act{'s' if len(actors) == 1 else ''} {named}"
    convected = [c.label for c in result.system.components if isinstance(c, Fluid) and c.convection]
    if convected:  # by its skew form, which keeps energy whatever the mesh
        return f"not meant to be exact: convection in {convected[0]} keeps energy, and momentum as its mesh gets finer"
    if not result.scheme.conserves_momenta and kind == "angular":
        return "not meant to be: this scheme does not conserve it, see how it falls with the step"
    if change <= LOOSE:
        return "conserved as well as the tolerances of the solvers allow"
    return "WRONG, as nothing acts from outside: some force is not equal and opposite to its reaction"


def figures(result: Result) -> dict[str, Any]:
    """Numbers of a run for its summary."""
    s = result.statistics
    return {
        "coordinates": result.system.n_coordinates,
        "constraints": result.system.n_constraints,
        "linear solver": result.system.linear_explanation,
        "steps": s.steps,
        "iterations": s.iterations,
        "factorizations": s.factorizations,
        "rejected": s.rejected,
        "seconds": s.seconds,
        "conservation": result.conservation(),
    }


def axes_of(system: System) -> tuple[str, str]:
    """Axes along which linear and angular momentum can be there: in the plane and about revolutions not all."""
    if any(isinstance(c, MeshBody) and c.axisymmetric for c in system.components):
        return "y", ""
    moving = [f for f in system.model.fields if f.order == 2]
    if moving and all(f.node == 2 for f in moving):
        return "xy", "z"
    return "xyz", "xyz"


def gauge_text(system: System) -> str:
    """Notes of components on the last step, printed behind a bar or an audit's line.

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
