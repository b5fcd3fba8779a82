"""Ctrl-C at points where it does no harm.

Python turns the signal into `KeyboardInterrupt` between any two instructions. On the
way out of a compiled kernel that is a crash of the whole process, and between two steps
of bookkeeping it leaves half a record.
"""

from __future__ import annotations

import signal
import threading
from types import FrameType, TracebackType
from typing import Any

__all__ = ["HeldInterrupt"]


class HeldInterrupt:
    """Notes the first Ctrl-C in a ``with`` block, for `check` or the end of the block
    to raise.

    A second one acts at once. Blocks may be nested. Where Ctrl-C is not Python's
    business (in a thread, or with a handler of the user's), nothing is changed.
    """

    def __init__(self) -> None:
        self.noted = False
        self._former: Any = None

    def __enter__(self) -> HeldInterrupt:
        if threading.current_thread() is threading.main_thread():
            former = signal.getsignal(signal.SIGINT)
            if former is signal.default_int_handler or isinstance(
                getattr(former, "__self__", None), HeldInterrupt
            ):
                self._former = former
                signal.signal(signal.SIGINT, self._note)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
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
