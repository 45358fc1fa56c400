"""The second law in the audit: that entropy is produced and never lost, and that its balance closes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from visviva.results.ledger import STILL

if TYPE_CHECKING:
    from visviva.results.ledger import Ledger
    from visviva.results.result import Result

KEPT = 1e-9
"""Relative errors up to this are those of rounding and of Newton's method, see `audit`."""
LOOSE = 1e-6
"""The same of loose tolerances, in many steps."""


def entropy_scale(ledger: Ledger) -> float:
    """Scale of errors of entropy: the largest of its swing, its production and its supply.

    Where hardly any passes a millionth of what there is, or of what doubled temperatures would add, which are exact to
    rounding only.
    """
    sums = [ledger.size(name) for name in ledger.entropy.sums]
    still = STILL * max(ledger.size("entropy"), ledger.entropy.size)
    return float(max([ledger.swing("entropy"), *sums, still, np.finfo(float).tiny]))


def changed(ledger: Ledger, unit: str) -> str:
    """Changes of the entropy, in words."""
    parts = ", ".join(
        f"{name.removeprefix('entropy_').replace('_', ' by ', 1)} {ledger.last(name):.6g}"
        for name in ledger.entropy.sums
    )
    behind = f" {unit}" if unit else ""
    return f"entropy {ledger.first('entropy'):.6g} -> {ledger.last('entropy'):.6g}{behind}: {parts or 'none arose'}"


def second_law(result: Result) -> tuple[str, str] | None:
    """Figures and verdict on the second law; None where nothing carries heat."""
    ledger = result.ledger
    if not ledger.entropy:
        relative = [c.label for c in result.system.components if c.carries_heat]
        if not relative:
            return None
        return "", (
            f"not meant to be judged: {relative[0]} balances heat, at temperatures that may be relative, so that "
            "there is no entropy in the ledger"
        )
    scale = entropy_scale(ledger)
    lost, error = ledger.greatest("defect_entropy") / scale, ledger.size("entropy_imbalance") / scale
    if lost > LOOSE:
        return f"loses {lost:.1e} of {scale:.4g} in a step", (
            "WRONG, as entropy never falls but to the outside: temperatures or conductivities are not positive, or "
            "some term that says it produces entropy takes it"
        )
    figures = f"closes to {error if error >= 1e-16 else 0:.1e} of {scale:.4g}, and no step loses any"
    return figures, verdict(error, one_step=result.scheme.conserves_energy)


def verdict(error: float, *, one_step: bool) -> str:
    """Verdict on the balance of entropy, where none was lost."""
    if error <= KEPT:
        return "fulfilled"
    if not one_step:
        return "not meant to be exact: rates of this scheme are no differences over steps, see how it falls with them"
    if error <= LOOSE:
        return "fulfilled as well as the tolerances of the solvers allow"
    return "WRONG, as what terms bring is what the entropy changes by: some term is not booked"
