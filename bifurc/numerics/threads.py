"""Linear algebra on one thread.

On matrices of some tens of rows the threads of BLAS wait for each other: beside other
work on the machine a search on two threads takes a hundred times as long as on one.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

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
