"""Work that is done beside the computation, in the order in which it came."""

from __future__ import annotations

from collections.abc import Callable
from queue import Queue
from threading import Thread

from visviva.base.world import by_first

Work = Callable[[], None]


class AtOnce:
    """Does work as soon as it comes: little of it is done sooner than handed over."""

    def do(self, work: Work) -> None:
        """Do it."""
        work()

    def wait(self) -> None:
        """Nothing is left."""

    def close(self) -> None:
        """Nothing is to be closed."""


class Beside:
    """Does work in a thread of its own, one after the other; what it works on must belong to it alone.

    Parameters
    ----------
    most : int
        So much may wait; who brings more waits, too, so that memory is bounded.

    Examples
    --------
    >>> done, beside = [], Beside()
    >>> for k in range(3):
    ...     beside.do(lambda k=k: done.append(k))
    >>> beside.wait()
    >>> done
    [0, 1, 2]
    >>> beside.close()
    """

    def __init__(self, most: int = 4) -> None:
        self._waiting: Queue[Work | None] = Queue(most)
        self._failure: BaseException | None = None
        self._thread = Thread(target=self._run, name="visviva output", daemon=True)
        self._thread.start()

    def do(self, work: Work) -> None:
        """Have it done after all that came before.

        Raises
        ------
        Exception
            What earlier work has failed with; nothing is done any more after that.
        """
        self._refuse()
        self._waiting.put(work)

    def wait(self) -> None:
        """Wait until all is done, and raise what has failed."""
        self._waiting.join()
        self._refuse()

    def close(self) -> None:
        """Do what is left, and end the thread; closing twice is harmless."""
        if self._thread.is_alive():
            self._waiting.put(None)
            self._thread.join()

    def _refuse(self) -> None:
        if self._failure is not None:
            raise self._failure

    def _run(self) -> None:
        while (work := self._waiting.get()) is not None:
            try:
                if self._failure is None:
                    work()
            except BaseException as failure:  # whatever it is, it is for who brought the work
                self._failure = failure
            finally:
                self._waiting.task_done()


class Outbox:
    """Hands work on to who does it; of what fails there all processes hear together.

    Attributes
    ----------
    by : AtOnce or Beside
        Who does it.

    Examples
    --------
    >>> outbox = Outbox()
    >>> outbox.do(lambda: print("written"))
    written
    >>> outbox.check()
    """

    def __init__(self) -> None:
        self.by: AtOnce | Beside = AtOnce()
        self._failure: Exception | None = None

    def do(self, work: Work) -> None:
        """Have it done after all that came before."""
        try:
            self.by.do(work)
        except Exception as failure:  # whatever it is, others would wait for what comes after
            self._failure = self._failure or failure

    def check(self) -> None:
        """Raise in all processes what has failed in the first one since the last look."""
        by_first("write what is due", self._refuse)

    def wait(self) -> None:
        """Wait until all is done, and raise what has failed."""
        by_first("finish writing", self._settle)

    def close(self) -> None:
        """Do what is left."""
        self.by.close()

    def _refuse(self) -> None:
        failure, self._failure = self._failure, None
        if failure is not None:
            raise failure

    def _settle(self) -> None:
        self._refuse()
        self.by.wait()
