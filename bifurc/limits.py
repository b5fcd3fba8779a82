"""Where a search has to stop: a limit on its time, and Ctrl-C at points where it does
no harm; and how many threads linear algebra may take.

Python turns the signal of Ctrl-C into `KeyboardInterrupt` between any two instructions.
On the way out of a compiled kernel that is a crash of the whole process, and between
two steps of bookkeeping it leaves half a record.
"""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field, replace
from functools import cache
from types import FrameType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController


SignalHandler = Callable[[int, FrameType | None], object] | int | None


class HeldInterrupt:
    """Notes the first Ctrl-C in a ``with`` block, for `check` or the end of the block
    to raise.

    From then on it ``was_pressed``. A second one acts at once. Blocks may be nested.
    Where Ctrl-C is not Python's business (in a thread, or with a handler of the
    user's), nothing is changed.
    """

    def __init__(self) -> None:
        self.noted = False
        self.was_pressed = False
        self._former: SignalHandler = None

    def __enter__(self) -> HeldInterrupt:
        if threading.current_thread() is not threading.main_thread():
            return self
        former = signal.getsignal(signal.SIGINT)
        outer_block = isinstance(getattr(former, "__self__", None), HeldInterrupt)
        if former is signal.default_int_handler or outer_block:
            self._former = former
            signal.signal(signal.SIGINT, self._note)
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if self._former is not None:
            signal.signal(signal.SIGINT, self._former)
        if kind is None:
            self.check()

    def check(self) -> None:
        """Raise `KeyboardInterrupt` if Ctrl-C was pressed since the last check."""
        if self.noted:
            self.noted = False
            raise KeyboardInterrupt

    def _note(self, number: int, frame: FrameType | None) -> None:
        if self.noted:
            raise KeyboardInterrupt
        self.noted = True
        self.was_pressed = True


@dataclass(frozen=True)
class Deadline:
    """The moment at which work has to stop: ``seconds`` after it was made, never where
    these are infinite, and at once where Ctrl-C was pressed in the block of an
    ``interrupt``."""

    seconds: float = float("inf")
    began: float = field(default_factory=time.perf_counter)
    interrupt: HeldInterrupt | None = None

    @property
    def left(self) -> float:
        """Seconds that are left, 0 once it has passed."""
        if self.interrupt is not None and self.interrupt.was_pressed:
            return 0.0
        return max(0.0, self.began + self.seconds - time.perf_counter())

    def or_at(self, interrupt: HeldInterrupt) -> Deadline:
        """The same moment, or that of a Ctrl-C."""
        return replace(self, interrupt=interrupt)

    @property
    def passed(self) -> bool:
        """Whether the time is over."""
        return self.left == 0.0


_deadline: ContextVar[Deadline | None] = ContextVar("deadline", default=None)


@contextmanager
def until(deadline: Deadline) -> Iterator[None]:
    """Within it what may last ends soon after a ``deadline``, with what it has by
    then."""
    token = _deadline.set(deadline)
    try:
        yield
    finally:
        _deadline.reset(token)


def current_deadline() -> Deadline:
    """The deadline that what runs now has, one without end where there is none."""
    return _deadline.get() or Deadline()


def is_time_over() -> bool:
    """Whether that deadline has passed; asked between any two steps that together may
    take long."""
    return current_deadline().passed


# Unknowns up to which no matrix is shared between threads. Those that locate a singular
# point have several times as many columns: of 16 unknowns 112 at a nullity of 6.
SMALL = 8


@contextmanager
def one_thread(n: int) -> Iterator[None]:
    """Within it BLAS works on one thread, where ``n`` unknowns would take more.

    The limit holds for the whole process; what was set before comes back.
    """
    if n <= SMALL:
        yield
        return
    with _controller().limit(limits=1, user_api="blas"):
        yield


@cache
def _controller() -> ThreadpoolController:
    # of use to few searches only
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
