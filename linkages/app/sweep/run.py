"""The sweep itself: every member mapped once, on all cores or on a Dask cluster,
whatever interrupts it.

The journal is the truth. A finished member is one line in it, forced to disk; when all
members of a block are finished the block is written to the dataset and a line says so.
After a kill, the lines are read again: written blocks are left alone, members of the
others that are finished are taken from their lines, the rest is mapped. No more than a
few blocks are ever held in memory.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    Executor,
    Future,
    ProcessPoolExecutor,
    wait,
)
from contextlib import contextmanager
from dataclasses import dataclass, field
from multiprocessing.connection import wait as wait_for_end
from pathlib import Path
from typing import Any

from linkages.app.sweep.journal import Journal
from linkages.app.sweep.member import atlas_name, map_member
from linkages.app.sweep.plan import Block, Plan
from linkages.app.sweep.store import SweepStore

__all__ = ["journal_path", "run_sweep"]

AHEAD = 4  # members waiting for each worker
Records = dict[int, dict[str, Any]]


def journal_path(out: Path) -> Path:
    """Where the journal of the sweep in ``out`` lies: beside it."""
    return out.with_name(out.name + ".journal")


def run_sweep(
    plan: Plan,
    out: Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    atlases: Path | None = None,
    progress: Callable[[int], None] | None = None,
) -> None:
    """Map every member of ``plan`` that the journal beside ``out`` does not hold yet,
    and write the dataset ``out``.

    ``workers`` processes on this machine (all cores by default), or the workers of the
    Dask ``scheduler``. ``atlases`` is a folder for the whole atlas of every member,
    which all workers must see. ``progress`` is called with the number of members
    finished since its last call. Raises `linkages.app.sweep.journal.JournalError` where
    the journal is of another sweep.
    """
    if atlases is not None:
        atlases = atlases.resolve()
        atlases.mkdir(parents=True, exist_ok=True)
    with Journal(journal_path(out), {"sweep": plan.as_dict()}) as journal:
        written, known = _recall(plan, journal)
        store = SweepStore(out, plan)
        tell = progress or (lambda count: None)
        tell(
            sum(
                len(block.indices) for block in plan.blocks() if block.number in written
            )
        )
        if len(written) == plan.block_count:
            return
        with _executor(workers, scheduler) as (executor, window):
            _Work(plan, journal, store, executor, window, atlases, tell).run(
                written, known
            )


def _recall(plan: Plan, journal: Journal) -> tuple[set[int], Records]:
    """Numbers of the blocks that are in the dataset, and the finished members of all
    others."""
    written = {line["block"] for line in journal.lines() if "block" in line}
    finished = (line for line in journal.lines() if "member" in line)
    return written, {
        line["member"]: line
        for line in finished
        if plan.block_of(line["member"]) not in written
    }


@contextmanager
def _executor(
    workers: int | None, scheduler: str | None
) -> Iterator[tuple[Executor, int]]:
    """An executor, and how many members to keep in its queue."""
    if scheduler is not None:
        from distributed import Client

        with Client(scheduler) as client:
            cores = sum(client.nthreads().values())
            yield client.get_executor(pure=False), AHEAD * max(cores, 1)
        return
    count = workers or usable_cores()
    os.environ.setdefault(
        "OPENBLAS_NUM_THREADS", "1"
    )  # one process a core: threads of BLAS would only compete
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(
        count, mp_context=context, initializer=_start_worker
    ) as executor:
        try:
            yield executor, AHEAD * count
        except BaseException:
            executor.shutdown(wait=False, cancel_futures=True)
            raise


def usable_cores() -> int:
    """Number of cores this process may use."""
    return (
        len(os.sched_getaffinity(0))
        if hasattr(os, "sched_getaffinity")
        else os.cpu_count() or 1
    )


def _start_worker() -> None:
    """Leave Ctrl-C to the sweep, and end with it when it is killed: by itself a worker
    would wait for work for ever."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()

    def watch() -> None:
        if parent is not None:
            wait_for_end([parent.sentinel])
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


@dataclass
class _Work:
    """What is under way: the futures, and the records of every block that is not
    complete."""

    plan: Plan
    journal: Journal
    store: SweepStore
    executor: Executor
    window: int
    atlases: Path | None
    tell: Callable[[int], None]
    waiting: dict[Future[dict[str, Any]], tuple[Block, int]] = field(
        default_factory=dict
    )
    opened: dict[int, Records] = field(default_factory=dict)

    def run(self, written: set[int], known: Records) -> None:
        """Map what is missing, block by block, with never more than ``window`` members
        under way."""
        for block in self.plan.blocks():
            if block.number in written:
                continue
            indices = block.indices.tolist()
            records = self.opened[block.number] = {
                i: known.pop(i) for i in indices if i in known
            }
            self.tell(len(records))
            for index in indices:
                if index not in records:
                    self._submit(block, index)
            self._close_if_complete(block)
        while self.waiting:
            self._collect()

    def _submit(self, block: Block, index: int) -> None:
        while len(self.waiting) >= self.window:
            self._collect()
        plan, path = (
            self.plan,
            str(self.atlases / atlas_name(index)) if self.atlases else None,
        )
        future = self.executor.submit(
            map_member,
            plan.family,
            plan.parameters(index),
            plan.starts,
            plan.seed,
            path,
        )
        self.waiting[future] = (block, index)

    def _collect(self) -> None:
        """Wait for the next members, and put them into the journal."""
        for future in wait(self.waiting, return_when=FIRST_COMPLETED).done:
            block, index = self.waiting.pop(future)
            record = {"member": index, **future.result()}
            self.journal.append(record)
            self.opened[block.number][index] = record
            self.tell(1)
            self._close_if_complete(block)

    def _close_if_complete(self, block: Block) -> None:
        """Write a block all of whose members are finished, and forget it."""
        records = self.opened.get(block.number, {})
        if len(records) == len(block.indices):
            self.store.write(block, records)
            self.journal.append({"block": block.number})
            del self.opened[block.number]
