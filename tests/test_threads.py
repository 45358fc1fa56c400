"""Results are the same bits for any number of threads."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

RUN = """
import hashlib
import visviva as vv
rod = vv.Solid(mesh=vv.BoxMesh(size=(4, 1, 1), counts=(24, 12, 12)), material=vv.NeoHooke(young=1e3, poisson=0.3),
               density=1.0, angular_velocity=(0.1, 0.2, 2.0))
system = vv.System([rod, vv.Gravity()], vv.Newton(linear={linear}))
vv.simulate(system, until=0.03, step=0.01)
print(hashlib.sha256(system.x.tobytes() + system.v.tobytes() + system.core.energy.tobytes()).hexdigest())
"""


@pytest.mark.parametrize(
    "linear", ["None", "vv.Direct()", "vv.Iterative(method='gmres', preconditioner='block')"]
)
def test_bits_do_not_depend_on_threads(linear: str) -> None:
    """Assembly, products with vectors and ledger of 3456 elements."""

    def bits(threads: int) -> str:
        # threads that wait for each other shall not compute meanwhile
        more = {"OMP_NUM_THREADS": str(threads), "OMP_WAIT_POLICY": "passive"}
        environment = {**os.environ, **more}
        command = [sys.executable, "-c", RUN.format(linear=linear)]
        return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout

    assert bits(1) == bits(2) == bits(3)
