"""Where a search has to stop: a limit on its time, and Ctrl-C at points where it does
no harm; and how many threads linear algebra may take.

Python turns the signal of Ctrl-C into `KeyboardInterrupt` between any two instructions.
On the way out of a compiled kernel that is a crash of the whole process, and between
two steps of bookkeeping it leaves half a record. So whatever lasts asks for the time and
ends by itself; what does not is cut off a little later, but for what is `whole`.
"""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field, replace
from functools import cache, wraps
from types import FrameType
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController


SignalHandler = Callable[[int, FrameType | None], object] | int | None
Arguments = ParamSpec("Arguments")
Value = TypeVar("Value")

GRACE = 0.2  # s after a deadline in which what asks for the time ends by itself
AGAIN = 0.02  # s until it is tried again to cut off what is whole
LASTING = 500  # rows of a matrix whose decomposition takes a tenth of a second


class HeldInterrupt:
    """Notes the first Ctrl-C in a ``with`` block, for `check` or the end of the block
    to raise.

    From then on it ``was_pressed``. A second one acts at once. Blocks may be nested: one
    that begins after it was pressed in the block around it knows of it.
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
            outer = getattr(former, "__self__", None)
            self.was_pressed = isinstance(outer, HeldInterrupt) and outer.noted
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

    def settle(self) -> None:
        """Take what was pressed for dealt with: nothing is raised for it."""
        self.noted = False

    def _note(self, number: int, frame: FrameType | None) -> None:
        if self.noted:
            raise KeyboardInterrupt
        self.noted = True
        self.was_pressed = True
        if _cut.is_armed:
            signal.setitimer(signal.ITIMER_REAL, GRACE)


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
        if self.is_interrupted:
            return 0.0
        return max(0.0, self.began + self.seconds - time.perf_counter())

    @property
    def is_interrupted(self) -> bool:
        """Whether Ctrl-C was pressed."""
        return self.interrupt is not None and self.interrupt.was_pressed

    def share(self, part: float) -> Deadline:
        """The end of a ``part`` of the time that is left."""
        return replace(self, seconds=part * self.left, began=time.perf_counter())

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


class TimeOver(Exception):
    """The time of a block of `ending_in_time` is over."""


_ending: ContextVar[Deadline | None] = ContextVar("ending", default=None)


@contextmanager
def ending_in_time(deadline: Deadline) -> Iterator[None]:
    """A block that ends where `check_time` finds that a ``deadline`` has passed, or that
    of a block around it: what takes long and is of no use in part is given up."""
    around = _ending.get()
    is_first = around is None or deadline.left < around.left
    token = _ending.set(deadline if is_first else around)
    try:
        yield
    except TimeOver:
        pass
    finally:
        _ending.reset(token)


def has_to_end() -> bool:
    """Whether what runs now may have to end before it is done."""
    deadline = _ending.get()
    return deadline is not None and deadline.seconds < float("inf")


def check_time() -> None:
    """Raise `TimeOver` where the time of the innermost block is over."""
    deadline = _ending.get()
    if deadline is not None and deadline.passed:
        raise TimeOver


# --- what does not ask ----------------------------------------------------------------


class CutOff(BaseException):
    """The time is over, and what runs has not ended by itself."""


class _Cut:
    """Whether what runs may be cut off, and how many calls under way are whole."""

    def __init__(self) -> None:
        self.is_armed = False
        self.whole_calls = 0

    def strike(self, number: int, frame: FrameType | None) -> None:
        """Raise `CutOff` where what runs may be cut off; later where it is whole, or a
        module is being imported, which would be left in halves."""
        if not self.is_armed:
            return
        while frame is not None and "importlib" not in frame.f_code.co_filename:
            frame = frame.f_back
        if self.whole_calls or frame is not None:
            signal.setitimer(signal.ITIMER_REAL, AGAIN)
        else:
            raise CutOff


_cut = _Cut()


@contextmanager
def cut_off_after(deadline: Deadline) -> Iterator[None]:
    """A block that ends soon after a ``deadline`` or a Ctrl-C that it holds, wherever it is:
    `CutOff` is raised there unless it ends by itself. What it writes on and what others
    read later is written by calls that are `whole`.

    Where the alarm of the process is not Python's business (in a thread, or with a handler
    of the user's), or there is none, blocks end by themselves only.
    """
    is_main = threading.current_thread() is threading.main_thread()
    has_alarm = is_main and hasattr(signal, "SIGALRM")
    is_free = has_alarm and signal.getsignal(signal.SIGALRM) in (
        signal.SIG_DFL,
        _cut.strike,  # of a block that was cut off on its way out
    )
    if not is_free:
        yield
        return
    signal.signal(signal.SIGALRM, _cut.strike)
    _cut.is_armed = True
    try:
        left = deadline.left
        if left < float("inf"):
            signal.setitimer(signal.ITIMER_REAL, left + GRACE)
        yield
    finally:
        _cut.is_armed = False
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, signal.SIG_DFL)


def left_behind(size: int, function: Callable[..., Any]) -> Callable[..., Any]:
    """A compiled function that cannot be asked to end, of matrices of this ``size``. Where
    it may last and what runs may be cut off it is called in a thread, which a cut leaves
    behind; it must write on nothing."""
    if size < LASTING or not _cut.is_armed:
        return function

    def call(*args: Any, **kwargs: Any) -> Any:
        values: list[Any] = []
        errors: list[BaseException] = []

        def run() -> None:
            try:
                values.append(function(*args, **kwargs))
            except BaseException as error:
                errors.append(error)

        thread = threading.Thread(target=run, daemon=True)
        thread.start()
        while thread.is_alive():
            thread.join(AGAIN)
        if errors:
            raise errors[0]
        return values[0]

    return call


def whole(function: Callable[Arguments, Value]) -> Callable[Arguments, Value]:
    """The same function, with calls that are never cut off in the midst."""

    @wraps(function)
    def call(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Value:
        _cut.whole_calls += 1
        try:
            return function(*args, **kwargs)
        finally:
            _cut.whole_calls -= 1

    return call


# --- threads --------------------------------------------------------------------------

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
