"""Where a search has to stop: a limit on its time, and Ctrl-C at points where it does
no harm; and how many threads linear algebra may take.

Python turns the signal of Ctrl-C into `KeyboardInterrupt` between any two instructions.
On the way out of a compiled kernel that is a crash of the whole process, and between
two steps of bookkeeping it leaves half a record. So whatever lasts asks for the time and
ends by itself (`is_time_over`); what does not is cut off a little later (`cut_off_after`),
but for what is `whole`.

An exception that a signal raises in a destructor, or in the callback of a weak reference,
is printed by Python and goes no further. So a block is cut off again where it goes on, and
a program of its own hears Ctrl-C again (`hear_interrupts`).
"""

from __future__ import annotations

import math
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field, replace
from functools import cache, wraps
from types import FrameType
from typing import TYPE_CHECKING, Any, ClassVar, ParamSpec, TypeVar

from bifurc.errors import OutOfTimeError

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController


SignalHandler = Callable[[int, FrameType | None], object] | int | None
Arguments = ParamSpec("Arguments")
Value = TypeVar("Value")

GRACE = 0.1  # s after a deadline in which what asks for the time ends by itself
PATIENCE = 0.5  # s after it for what all else needs: of a small problem it is made
AGAIN = 0.02  # s until it is tried again to cut off, or to raise
LASTING = 500  # rows of a matrix whose decomposition takes a tenth of a second


class HeldInterrupt:
    """Notes the first Ctrl-C in a ``with`` block, for `check` or the end of the block
    to raise.

    From then on it ``was_pressed``, also in the blocks around it. A second one acts at
    once. Where Ctrl-C is not Python's business (in a thread, or with a handler of the
    user's), nothing is changed.
    """

    def __init__(self) -> None:
        self.noted = False
        self._is_pressed = False
        self._former: SignalHandler = None
        self._around: HeldInterrupt | None = None

    def __enter__(self) -> HeldInterrupt:
        if threading.current_thread() is not threading.main_thread():
            return self
        former = signal.getsignal(signal.SIGINT)
        around = getattr(former, "__self__", None)
        if isinstance(around, HeldInterrupt):
            self._around = around
        elif former not in (signal.default_int_handler, _interrupt):
            return self
        self._former = former
        signal.signal(signal.SIGINT, self._note)
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if self._former is not None:
            signal.signal(signal.SIGINT, self._former)
        if kind is None:
            self.check()

    @property
    def was_pressed(self) -> bool:
        """Whether Ctrl-C was pressed since the block began, or one around it."""
        around = self._around
        return self._is_pressed or (around is not None and around.was_pressed)

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
        block: HeldInterrupt | None = self
        while block is not None:
            block._is_pressed = True
            block = block._around
        if _Cut.innermost is not None:
            _Cut.innermost.set_alarm()


def hear_interrupts() -> None:
    """Let Ctrl-C end a program of its own wherever it comes: not while a module is being
    imported, where Python makes other errors of it, but right after; and again where
    Python swallowed it."""
    if not hasattr(signal, "SIGALRM"):
        return
    former = sys.unraisablehook

    def hook(unraisable: sys.UnraisableHookArgs) -> None:
        if unraisable.exc_type is KeyboardInterrupt:
            _press_again()
        elif unraisable.exc_type is not CutOff:  # it is raised again
            former(unraisable)

    sys.unraisablehook = hook
    signal.signal(signal.SIGINT, _interrupt)


def _interrupt(number: int, frame: FrameType | None) -> None:
    """Raise `KeyboardInterrupt`, a little later while a module is being imported."""
    if _is_importing(frame):
        _press_again()
    else:
        raise KeyboardInterrupt


def _press_again() -> None:
    """Let Ctrl-C come again in a moment, to whoever handles it then."""

    def press(number: int, frame: FrameType | None) -> None:
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.raise_signal(signal.SIGINT)

    signal.signal(signal.SIGALRM, press)
    signal.setitimer(signal.ITIMER_REAL, AGAIN)


def _is_importing(frame: FrameType | None) -> bool:
    """Whether a module is being imported where a frame is."""
    while frame is not None:
        if "importlib" in frame.f_code.co_filename:
            return True
        frame = frame.f_back
    return False


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


def deadline_within(seconds: float, interrupt: HeldInterrupt | None = None) -> Deadline:
    """The deadline after so many seconds, or that of what runs now where it is earlier."""
    return Deadline(min(seconds, current_deadline().left), interrupt=interrupt)


def is_time_over() -> bool:
    """Whether that deadline has passed; asked between any two steps that together may
    take long."""
    return current_deadline().passed


# --- what does not ask ----------------------------------------------------------------


class CutOff(BaseException):
    """The time is over, and what runs has not ended by itself."""


class _Cut:
    """A block that is cut off after a deadline, and the `innermost` one under way."""

    innermost: ClassVar[_Cut | None] = None

    def __init__(self, deadline: Deadline):
        self._deadline = deadline
        self._around: _Cut | None = None
        self._is_armed = False
        self.was_struck = False

    def __enter__(self) -> None:
        is_main = threading.current_thread() is threading.main_thread()
        if not is_main or not hasattr(signal, "SIGALRM"):
            return
        if signal.getsignal(signal.SIGALRM) not in (signal.SIG_DFL, _strike):
            return
        signal.signal(signal.SIGALRM, _strike)
        self._around = _Cut.innermost
        self._is_armed = True
        _Cut.innermost = self
        self.set_alarm()

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if not self._is_armed:
            return
        # compiled code may raise an error of its own where `CutOff` was raised in it
        is_hidden = self.was_struck and kind is not None and issubclass(kind, Exception)
        _Cut.innermost = self._around
        if self._around is not None:
            self._around.set_alarm(AGAIN if kind is CutOff or is_hidden else GRACE)
        else:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.signal(signal.SIGALRM, signal.SIG_DFL)
        if is_hidden:
            raise CutOff from None

    @property
    def _left(self) -> float:
        around = math.inf if self._around is None else self._around._left
        return min(self._deadline.left, around)

    def set_alarm(self, grace: float = GRACE) -> None:
        """Let the alarm ring a ``grace`` (s) after the time is over, and again until it
        is heard."""
        left = self._left
        if left < math.inf:
            signal.setitimer(signal.ITIMER_REAL, left + grace, AGAIN)
        else:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            if self._left < math.inf:  # Ctrl-C was pressed meanwhile
                self.set_alarm()


def _strike(number: int, frame: FrameType | None) -> None:
    """Raise `CutOff`; not in what is whole, nor where a module is being imported, which
    would be left in halves: there the alarm rings again."""
    if _Cut.innermost is None or _is_whole(frame) or _is_importing(frame):
        return
    signal.setitimer(signal.ITIMER_REAL, GRACE, AGAIN)
    _Cut.innermost.was_struck = True
    raise CutOff


def cut_off_after(deadline: Deadline) -> AbstractContextManager[None]:
    """A block that ends soon after a ``deadline`` or a Ctrl-C that it holds, or after
    that of a block around it, wherever it is: `CutOff` is raised there unless it ends by
    itself. What it writes on and what others read later is written by calls that are
    `whole`.

    Where the alarm of the process is not Python's business (in a thread, or with a handler
    of the user's), or there is none, blocks end by themselves only.
    """
    return _Cut(deadline)


def made_in_time(make: Callable[[], Value]) -> Value | None:
    """What is made, or None where what runs now has to end before that is done."""
    try:
        with cut_off_after(current_deadline()):
            return make()
    except CutOff:
        return None


def made_before_the_end(stage: str, make: Callable[[], Value]) -> Value:
    """The same of what nothing is known without: it has a little longer. Raises
    `OutOfTimeError`, which names the ``stage``."""
    deadline = current_deadline()
    try:
        with cut_off_after(replace(deadline, seconds=deadline.seconds + PATIENCE)):
            return make()
    except CutOff:
        raise OutOfTimeError(stage, deadline.is_interrupted) from None


_LEFT: set[threading.Thread] = set()  # calls that a cut has left behind, or may leave


def left_behind(size: int, function: Callable[..., Any]) -> Callable[..., Any]:
    """A compiled function that cannot be asked to end, of matrices of this ``size``. Where
    it may last and what runs may be cut off it is called in a thread, which a cut leaves
    behind; it must write on nothing."""
    if size < LASTING or _Cut.innermost is None:
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
        _LEFT.add(thread)
        thread.start()
        while thread.is_alive():
            thread.join(AGAIN)
        _LEFT.discard(thread)
        if errors:
            raise errors[0]
        return values[0]

    return call


def whole(function: Callable[Arguments, Value]) -> Callable[Arguments, Value]:
    """The same function, with calls that are never cut off in the midst."""

    @wraps(function)
    def call(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Value:
        return function(*args, **kwargs)

    return call


# Code that is never left in the midst; all `whole` calls have that of one.
_WHOLE = {
    method.__code__
    for method in (
        whole(max),
        _Cut.__enter__,
        _Cut.__exit__,
        HeldInterrupt.__enter__,
        HeldInterrupt.__exit__,
        vars(until)["__wrapped__"],
    )
}


def _is_whole(frame: FrameType | None) -> bool:
    """Whether a frame is one of what is whole, or is called from there."""
    while frame is not None:
        if frame.f_code in _WHOLE:
            return True
        frame = frame.f_back
    return False


# --- threads --------------------------------------------------------------------------

# Unknowns up to which no matrix is shared between threads. Those that locate a singular
# point have several times as many columns: of 16 unknowns 112 at a nullity of 6.
SMALL = 8


@contextmanager
def one_thread(n: int) -> Iterator[None]:
    """Within it BLAS works on one thread, where ``n`` unknowns would take more.

    The limit holds for the whole process. What was set before comes back, but for where a
    call was left behind: after that OpenBLAS with several threads does not end with the
    process.
    """
    if n <= SMALL:
        yield
        return
    # SciPy has a BLAS of its own, which a controller knows where it is loaded before
    controller = _controller("scipy.linalg" in sys.modules)
    limit = controller.limit(limits=1, user_api="blas")
    try:
        yield
    finally:
        if not _LEFT:
            limit.restore_original_limits()


@cache
def _controller(has_scipy: bool) -> ThreadpoolController:
    # of use to few searches only
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
