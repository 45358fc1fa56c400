"""Processes of MPI that share one system: sums over them, and what belongs to whom."""

from __future__ import annotations

import builtins
import os
import re
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from hashlib import sha256
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from visviva.base import errors
from visviva.base.errors import InputError
from visviva.base.processes import last_words
from visviva_petsc import refuse_thread
from visviva_petsc.failing import PATIENCE
from visviva_petsc.partition import parts_of
from visviva_petsc.window import LENGTH, Window

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

RAISED = re.compile(r"Traceback [^\n]*\n(?:  [^\n]*\n)*(\w+)(?::\s*(.*))?", re.DOTALL)
"""What the core knows of an error of Python: where it comes from, its class and what it says."""
NUMBER = re.compile(r"0x[0-9a-f]+|\b(?:nan|inf)\b|[+-]?\d[\d.e+-]*")
"""What may differ in what one error says in several processes: numbers, and addresses."""
LOOK = 0.5
"""Seconds between looks at what others do for whom this one waits."""
ASKED = 20
"""Times that MPI is asked between looks whether others have come: it does its work when asked, and who had no processor
for seconds has not heard of what came in the meantime."""
BUSY = 0.1
"""Seconds of waiting that are not slept away."""
CURE = (
    "Each runs the whole script, and has to do the same: none may catch an error that others do not have and go on, or "
    "go on alone"
)


class World:
    """Processes of a communicator, as `visviva.base.world.World` describes them.

    Attributes
    ----------
    own : int
        The system's number of this process, which what it forks has not.
    failing, leaving, asking
        Where those meet that fail, that come to their end, that begin what all do together.
    met : float
        When all were together last.
    noted : str
        Error that this one has met since.
    is_inside : bool
        Whether all have begun the same, in which the core does more together.
    """

    def __init__(self, comm: Any) -> None:
        self.comm = comm
        self.rank, self.size, self.own = comm.rank, comm.size, os.getpid()
        self.failing, self.leaving, self.asking = comm.Dup(), comm.Dup(), comm.Dup()
        self.met, self.noted, self.is_inside = time.monotonic(), "", False
        self.window = Window(comm)
        comm.Barrier()

    @contextmanager
    def doing(self, what: str) -> Iterator[None]:
        """Inside, all do `what` together; whoever begins something else is refused."""
        self.begin(what)
        outer, self.is_inside = self.is_inside, True
        try:
            yield
        except BaseException as error:
            self.note(error)
            raise
        finally:
            self.is_inside = outer

    def begin(self, what: str) -> None:
        """Wait until all begin `what`.

        Raises
        ------
        InputError
            If another one begins something else, or this one cannot take part.
        """
        self.refuse_apart(what)
        self.window.begin(what)
        own = np.frombuffer(sha256(what.encode()).digest(), dtype=np.int64)
        theirs = np.empty((self.size, len(own)), dtype=np.int64)
        self.wait(self.asking.Iallgather(own, theirs), what)
        if (theirs != own).any():
            self.refuse(what)
        self.noted = ""

    def refuse_apart(self, what: str) -> None:
        """Refuse what this one is to do with others, if it was forked, or does something by itself."""
        if os.getpid() != self.own:
            raise InputError(
                f"a process that was forked is none of the {self.size} that share the systems made before: make its own"
            )
        refuse_thread(what)
        if asking := errors.called_apart():
            raise InputError(
                f"{asking} cannot {what}: each process comes to that by itself, and may wait for ever for others that "
                "do not; ask them in a motion or a probe, which all call together"
            )

    def wait(self, arrived: Any, what: str) -> None:
        """Wait for the others, as long as they may come; one that waits for this one elsewhere never will."""
        start = looked = time.monotonic()
        asked, left = 0, 0
        while not arrived.Test():
            now, asked = time.monotonic(), asked + 1
            waited = now - start
            if now - looked > LOOK and asked > ASKED:
                looked, asked = now, 0
                other = self.window.left_behind()
                left = 0 if other is None else left + 1
                if other is not None and left * LOOK >= PATIENCE:  # who has been told of this one goes on
                    self.part(what, *other)
            if waited > BUSY:
                time.sleep(min(waited / 10, 0.01))
            else:
                os.sched_yield()

    def part(self, what: str, other: int, theirs: str) -> None:
        """End all: another one waits within what this one has left."""
        print(
            f"process {self.rank} of {self.size} is to {what}{self.noted}, and process {other} waits for it, to "
            f"{theirs}. {CURE}",
            file=sys.stderr,
        )
        self.abort(1)

    def refuse(self, what: str) -> None:
        """Refuse what all are to do, as it is not the same; all come here."""
        first, *others = self.asking.allgather((what, self.noted))
        self.noted = ""
        k, other = next((k, other) for k, other in enumerate(others, 1) if other[0] != first[0])
        raise InputError(
            f"processes differ: process 0 is to {first[0]}{first[1]}, process {k} to {other[0]}{other[1]}. {CURE}"
        )

    def note(self, error: BaseException) -> None:
        """Remember an error of this one, to be told should it go on with something else than the others."""
        text = " ".join(str(error).split())
        self.noted = f" (after {type(error).__name__}: {text[:200]})"

    def joint(self, what: str) -> Any:
        """The communicator, for what all do together now."""
        self.begin(what)
        return self.going_on()

    def within(self, what: str) -> Any:
        """The same for the core, which does alike in all within what they have begun, and is not asked again."""
        if not self.is_inside:
            return self.joint(what)
        self.refuse_apart(what)
        return self.going_on()

    def going_on(self) -> Any:
        """The communicator, of which others may see that this one waits in it."""
        self.met = time.monotonic()
        self.window.go_on()
        return self.comm

    def leave(self) -> tuple[int, str] | None:
        """Wait until all have come to their end; or until one waits for this one, which is told with what it does."""
        arrived = self.leaving.Ibarrier()
        while not arrived.Test():
            if (other := self.window.ahead()) is not None:
                return other
            time.sleep(0.05)
        self.window.free()
        return None

    def sum(self, values: Array) -> None:
        """Sum an array over the processes, in place."""
        self.joint(f"add up {np.size(values)} numbers").Allreduce(MPI.IN_PLACE, values)

    def largest(self, value: float) -> float:
        """The largest of their numbers."""
        return float(self.joint("find the largest of their numbers").allreduce(value, MPI.MAX))

    def first(self, value: Any) -> Any:
        """What the first of them has."""
        return self.joint("hear from the first").bcast(value)

    def together(self, values: Any) -> list[Any]:
        """What they have, in their order."""
        return list(self.joint("exchange what they have").allgather(values))

    def parts(self, grid: Any) -> Ints:
        """Number of the process that each cell (n_cells,) of a mesh belongs to."""
        return np.asarray(self.first(parts_of(grid, self.size) if self.rank == 0 else None))

    def meets(self) -> bool:
        """Whether all of them come here, by an error, before patience ends."""
        return self.arrive(self.failing.Ibarrier(), self.met)

    def differs(self, own: str) -> bool:
        """Where all have met, whether this one failed by something else than the first, but for numbers."""
        mine = np.frombuffer(NUMBER.sub("", own).encode()[:LENGTH].ljust(LENGTH, b"\0"), dtype=np.uint8)
        theirs = mine.copy()
        if not self.arrive(self.failing.Ibcast(theirs), self.met):
            return True
        differs = bool((theirs != mine).any())
        if differs:
            time.sleep(0.2)  # the first tells its own before
        return differs

    def arrive(self, arrived: Any, met: float) -> bool:
        """Whether others come, who were together at this time, before patience ends.

        Who has worked for a minute since then waits for another: others may have had more to do.
        """
        start = time.monotonic()
        patience = max(PATIENCE, start - met)
        while not arrived.Test():
            if time.monotonic() - start > patience:
                return False
            time.sleep(0.01)
        return True

    def failures(self, own: str) -> list[str]:
        """What all of them have failed by, in their order; nothing of those that have not.

        One that has failed ends all where others do not come here: they are left in what it has left.
        """
        met, comm = self.met, self.within("tell whether they could solve")
        words = np.frombuffer(own.encode()[:LENGTH].ljust(LENGTH, b"\0"), dtype=np.uint8)
        theirs = np.empty((self.size, LENGTH), dtype=np.uint8)
        arrived = comm.Iallgather(words, theirs)
        if own and not self.arrive(arrived, met):
            print(
                f"process {self.rank} of {self.size} could not solve with the others: {own}", file=sys.stderr
            )
            self.abort(1)
        arrived.Wait()
        return [bytes(row).rstrip(b"\0").decode(errors="replace") for row in theirs]

    def abort(self, code: int) -> None:
        """End all of them, whatever they wait for."""
        last_words()
        self.comm.Abort(code)

    def of_core(self) -> Owners:
        """What the core of a system is told of them."""
        return Owners(self)


class Owners:
    """Who owns which unknowns of one system: of those that have an equation for it the first process."""

    def __init__(self, world: World) -> None:
        self.world = world

    def own(self, unknowns: NDArray[np.int32], n: int) -> NDArray[np.int32]:
        """Mask (n,) of the unknowns of this process, from those that have equations here."""
        rank, size = self.world.rank, self.world.size
        owner = owners(self.world.within(f"number {n} unknowns"), unknowns, n)
        self.mine = np.flatnonzero(owner == rank)
        self.counts = np.bincount(owner, minlength=size + 1)[:-1]
        self.order = np.argsort(owner, kind="stable")[: self.counts.sum()].astype(np.int32)
        return (owner == rank).astype(np.int32)

    def sum(self, values: Array) -> None:
        """Sum an array over the processes, in place."""
        self.world.within(f"add up {len(values)} numbers").Allreduce(MPI.IN_PLACE, values)

    def largest(self, value: float) -> float:
        """The largest of their numbers."""
        return float(self.world.within("find the largest of their numbers").allreduce(value, MPI.MAX))

    def share(self, values: Array) -> None:
        """Give all processes the values (n,) that the owners have."""
        found = np.empty(len(self.order))
        self.world.within(f"share {len(values)} numbers").Allgatherv(values[self.mine], (found, self.counts))
        values[self.order] = found

    def tell(self, words: str, number: int) -> tuple[str, int]:
        """Words and a number of the first process that has raised an exception; else of the first that has words.

        Raises
        ------
        Exception
            What that one has raised, of the same class, if this one has raised none such: scripts may catch it. A step
            that only failed in others may be tried again, and that one will not.
        """
        raised = RAISED.fullmatch(words.strip())
        kind, text = (raised[1], raised[2] or "") if raised else ("", words.strip())
        all_of_them = self.world.within("tell why it failed").allgather((kind, text, number))
        found = first_failed(all_of_them)
        if found[0] not in ("", kind):
            raise raised_elsewhere(*found[:2])
        return found[1:]


def first_failed(told: list[tuple[str, str, int]]) -> tuple[str, str, int]:
    """Class, words and number of the first that has a class, else of the first that has words."""
    having = [t for t in told if t[0]] or [t for t in told if t[1]]
    return having[0] if having else ("", "", -1)


def raised_elsewhere(name: str, text: str) -> BaseException:
    """What another process has raised, by the name of its class; of a base of that where it takes more than a text."""
    for kind in class_of(name).__mro__:
        with suppress(Exception):
            made = kind(text)
            if isinstance(made, BaseException):
                return made
    return errors.RunError(text)


def class_of(name: str) -> type[BaseException]:
    """Class of errors of visviva, of Python or of the script, which all run; a `RunError` is what nobody knows."""
    found = getattr(errors, name, getattr(builtins, name, None))
    if isinstance(found, type) and issubclass(found, BaseException):
        return found
    return next((kind for kind in below(errors.VisvivaError) if kind.__name__ == name), errors.RunError)


def below(kind: type[BaseException]) -> Iterator[type[BaseException]]:
    """All classes made of a class of errors."""
    for derived in kind.__subclasses__():
        yield derived
        yield from below(derived)


def owners(comm: Any, unknowns: NDArray[np.int32], n: int) -> NDArray[np.int32]:
    """First process (n,) that has an equation for each unknown; the number of processes where none has."""
    owner = np.full(n, comm.size, dtype=np.int32)
    owner[unknowns] = comm.rank
    comm.Allreduce(MPI.IN_PLACE, owner, MPI.MIN)
    return owner
