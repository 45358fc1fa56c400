"""Fingerprint of a run, in words that can be compared: every argument of every component, by value.

Values are told as in ``base/told.py``; components that arguments refer to are told by name, for their own arguments are
compared beside.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import visviva
from visviva.base.told import arguments_of, shortened
from visviva.system.agreement import Arguments, differing, names_of, told, told_components

if TYPE_CHECKING:
    from visviva.study.study import Study


def fingerprint(study: Study) -> tuple[Arguments, list[str]]:
    """All arguments of a study, and names of those that cannot be told.

    Returns
    -------
    arguments : dict of str to dict of str to str
        By component and argument; "study" has those of the study, "Newton" those of the solver.
    untold : list of str
        Such as ``force: force (a TextIOWrapper cannot be compared)``.
    """
    system, untold = study.system, list[str]()
    names = names_of(system.components) | {id(system): "the system", id(study): "the study"}
    options = {name: getattr(study, name) for name in ("step", "scheme", "adaptive")} | {
        "fields": study.stored
    }
    probes = {f"probe {k}": p for k, p in study.probes.items()}
    found: Arguments = {"visviva": {"version": visviva.__version__}}
    found["study"] = told("study", options | probes, names, untold)
    found["Newton"] = told("Newton", arguments_of(system.newton), names, untold)
    found["system"] = {"order of components": shortened(", ".join(c.label for c in system.components))}
    found |= told_components(system.components, names, untold)
    for c in system.components:
        if "__dataclass_fields__" not in vars(type(c)):
            untold.append(f"{c.label}: attributes of {type(c).__name__}, which is no dataclass")
    return found, untold


def changes(before: Arguments, now: Arguments) -> list[str]:
    """Differences, one line each: the component, its argument, both values."""
    found = [f"{owner} is missing" for owner in before if owner not in now]
    found += [f"{owner} is new" for owner in now if owner not in before]
    earlier = {owner: before.get(owner, arguments) for owner, arguments in now.items()}
    return found + [f"{owner}: {name} was {a}, is {b}" for owner, name, a, b in differing(earlier, now)]
