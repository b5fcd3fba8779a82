"""Who maps the members of a sweep: processes on this machine, or a Dask cluster."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import wait as wait_for_end

from bifurc.errors import BifurcError

AHEAD = 4  # members waiting for each worker


class SchedulerError(BifurcError):
    """No Dask scheduler answers at an address."""

    def __init__(self, address: str, reason: str):
        self.address = address
        super().__init__(f"--scheduler {address}: no scheduler answers ({reason})")


class WorkerError(BifurcError):
    """A worker that did not bring its member to an end: it was killed, or could not
    write."""

    def __init__(self, member: int, reason: str):
        self.member = member
        super().__init__(
            f"the worker of member {member} failed ({reason}); what was finished is in "
            "the journal, and the same command goes on there"
        )


@dataclass(frozen=True)
class Pool:
    """An executor, and how many members to keep in its queue."""

    executor: Executor
    window: int


@contextmanager
def open_pool(workers: int | None, scheduler: str | None) -> Iterator[Pool]:
    """``workers`` processes on this machine (all cores by default), or the workers of
    the Dask ``scheduler``. Raises `SchedulerError`."""
    opened = _processes(workers) if scheduler is None else _cluster(scheduler)
    with opened as pool:
        yield pool


@contextmanager
def _cluster(scheduler: str) -> Iterator[Pool]:
    from distributed import Client

    try:
        client = Client(scheduler)  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as error:
        raise SchedulerError(scheduler, str(error)) from None
    with client:
        threads: dict[str, int] = client.nthreads()  # type: ignore[no-untyped-call]
        executor: Executor = client.get_executor(pure=False)  # type: ignore[no-untyped-call]
        yield Pool(executor, AHEAD * max(sum(threads.values()), 1))


@contextmanager
def _processes(workers: int | None) -> Iterator[Pool]:
    count = workers or usable_cores()
    # one process a core: threads of BLAS would only compete
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(
        count, mp_context=context, initializer=_start_worker
    ) as executor:
        try:
            yield Pool(executor, AHEAD * count)
        except BaseException:
            executor.shutdown(wait=False, cancel_futures=True)
            raise


def usable_cores() -> int:
    """Number of cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _start_worker() -> None:
    """Leave Ctrl-C to the sweep, and end with it when it is killed: by itself a worker
    would wait for work for ever."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is None:
        return
    sentinel = parent.sentinel

    def end_with_parent() -> None:
        wait_for_end([sentinel])
        os._exit(1)

    threading.Thread(target=end_with_parent, daemon=True).start()
