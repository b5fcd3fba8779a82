"""The sweep itself: every member mapped once, on all cores or on a Dask cluster,
whatever interrupts it; and who maps them, processes on this machine or a Dask cluster.

The journal is the truth. A finished member is one line in it, forced to disk; when all
members of a block are finished the block is written to the dataset and a line says so.
After a kill, the lines are read again: written blocks are left alone, members of the
others that are finished are taken from their lines, the rest is mapped. No more than a
few blocks are ever held in memory, but where the dataset was deleted: all of it is made
again from the journal.
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
from typing import Any, TypeAlias

from bifurc.errors import BifurcError
from linkages.app.sweep.journal import Journal, WrittenBlock, read_entries
from linkages.app.sweep.member import Record, atlas_name, map_member
from linkages.app.sweep.plan import Block, Plan
from linkages.app.sweep.store import SweepStore, require_room

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


Progress: TypeAlias = Callable[[int], None]


def journal_path(out: Path) -> Path:
    """Where the journal of the sweep in ``out`` lies: beside it."""
    return out.with_name(out.name + ".journal")


def run_sweep(
    plan: Plan,
    out: Path,
    progress: Progress = lambda count: None,
    **options: Any,
) -> None:
    """Map every member of ``plan`` that the journal beside ``out`` does not hold yet,
    and write the dataset ``out``.

    Options and errors are those of `prepare_sweep`; ``progress`` is called with the
    number of members finished since its last call.
    """
    with prepare_sweep(plan, out, **options) as sweep:
        sweep.run(progress)


@contextmanager
def prepare_sweep(
    plan: Plan,
    out: Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    atlases: Path | None = None,
) -> Iterator[Sweep]:
    """A sweep that is ready to run, with its journal and its workers.

    ``workers`` processes on this machine (all cores by default), or the workers of the
    Dask ``scheduler``. ``atlases`` is a folder for the whole atlas of every member,
    which all workers must see. Raises `SchedulerError`, `StoreError` where ``out``
    holds something else, and `JournalError` where the journal is of another sweep;
    nothing is written before the scheduler answers.
    """
    require_room(out, plan)
    with (
        open_pool(workers, scheduler) as pool,
        Journal(journal_path(out), {"sweep": plan.as_dict()}) as journal,
    ):
        store = SweepStore(out, plan)
        if atlases is not None:
            atlases = atlases.resolve()
            atlases.mkdir(parents=True, exist_ok=True)
        yield Sweep(plan, journal, store, pool, atlases)


@dataclass(frozen=True)
class _Finished:
    """What the journal holds: the numbers of the blocks that are in the dataset, and
    the records of members of other blocks."""

    blocks: set[int]
    records: dict[int, Record]


@dataclass(frozen=True)
class _OpenBlock:
    """A block under way: the records of its finished members, by their indices."""

    block: Block
    records: dict[int, Record]

    @property
    def is_complete(self) -> bool:
        """Whether all members are finished."""
        return len(self.records) == len(self.block.indices)


@dataclass(frozen=True)
class _Task:
    """A member under way, and the block that it belongs to."""

    index: int
    block: _OpenBlock


@dataclass
class Sweep:
    """What is under way: the futures, and the journal that they are written to."""

    plan: Plan
    journal: Journal
    store: SweepStore
    pool: Pool
    atlases: Path | None
    tasks: dict[Future[Record], _Task] = field(default_factory=dict)

    def run(self, progress: Progress) -> None:
        """Map what is missing, block by block, with never more members under way than
        the pool wants in its queue."""
        finished = self._read_journal()
        if not finished.records:
            self.store.settle()
        for block in self.plan.blocks():
            if block.number in finished.blocks:
                progress(len(block.indices))
                continue
            opened = _opened(block, finished)
            progress(len(opened.records))
            if opened.is_complete:
                self._write(opened)
                continue
            for index in block.indices.tolist():
                if index not in opened.records:
                    self._make_room(progress)
                    self._submit(_Task(index, opened))
        while self.tasks:
            self._collect(progress)
        self.store.settle()

    def _read_journal(self) -> _Finished:
        """What is finished. Where the dataset is new no block is in it, whatever the
        journal says, and all records are needed again."""
        blocks = set()
        if not self.store.is_new:
            for entry in read_entries(self.journal, self.plan):
                if isinstance(entry, WrittenBlock):
                    blocks.add(entry.number)
        records: dict[int, Record] = {}
        for entry in read_entries(self.journal, self.plan):
            if isinstance(entry, WrittenBlock):
                continue
            if self.plan.block_of(entry.index) not in blocks:
                records[entry.index] = entry.record
        return _Finished(blocks, records)

    def _make_room(self, progress: Progress) -> None:
        """Wait until the pool wants another member."""
        while len(self.tasks) >= self.pool.window:
            self._collect(progress)

    def _submit(self, task: _Task) -> None:
        plan = self.plan
        atlas_path = None
        if self.atlases is not None:
            atlas_path = str(self.atlases / atlas_name(task.index))
        future = self.pool.executor.submit(
            map_member,
            plan.subject,
            plan.values(task.index),
            plan.starts,
            plan.seed,
            atlas_path,
        )
        self.tasks[future] = task

    def _collect(self, progress: Progress) -> None:
        """Wait for the next members, and put them into the journal."""
        for future in wait(self.tasks, return_when=FIRST_COMPLETED).done:
            task = self.tasks.pop(future)
            record: Record = {"member": task.index}
            record |= _result(future, task)
            self.journal.append(record)
            task.block.records[task.index] = record
            progress(1)
            if task.block.is_complete:
                self._write(task.block)

    def _write(self, opened: _OpenBlock) -> None:
        """Write a block all of whose members are finished."""
        self.store.write(opened.block, opened.records)
        self.journal.append({"block": opened.block.number})


def _opened(block: Block, finished: _Finished) -> _OpenBlock:
    """A block with the records of its finished members, which it takes over."""
    records = {}
    for index in block.indices.tolist():
        if index in finished.records:
            records[index] = finished.records.pop(index)
    return _OpenBlock(block, records)


def _result(future: Future[Record], task: _Task) -> Record:
    """The record of a member; raises `WorkerError`.

    Errors of the map are part of the record. What is raised here is the end of the
    worker, or a file that it could not write.
    """
    try:
        return future.result()
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise WorkerError(task.index, reason) from error
