"""Members of one and two dimensions in a closed loop conserve what a free system conserves."""

from __future__ import annotations

from loops import closed_loop, largest_changes

import visviva as vv


def test_closed_loop_of_beams_and_a_shell_conserves() -> None:
    """To round-off, over the start of the motion that ``campaign.loops`` follows over ten thousand steps."""
    system = closed_loop()
    found = largest_changes(system, 500)
    assert max(found.values()) < 1e-12, found


def test_parts_of_the_loop_deform() -> None:
    """Else there would be little to conserve: nearly all kinetic energy is that of tumbling."""
    system = closed_loop()
    result = vv.simulate(system, until=1.0, step=0.01, scheme=vv.EnergyMomentum())
    ledger = result.ledger
    assert max(ledger["potential_stored"]) > 0.03 * max(ledger["kinetic"])


def test_other_schemes_do_not_conserve() -> None:
    """What is measured tells schemes apart."""
    system = closed_loop()
    found = largest_changes(system, 100, scheme=vv.BackwardEuler())
    assert found["total"] > 1e-3
