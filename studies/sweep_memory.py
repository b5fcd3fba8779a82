"""What a sweep holds in memory: that of the sweep and of its largest worker, while more
and more members are mapped.

    python -m studies.sweep_memory [--family NAME] [--members NUMBER ...] [--out DIR]

Every sweep runs in a fresh process, once on the process pool and once on a Dask cluster
on this machine, whose scheduler lives in the process of the sweep. Resident memory is
looked at a hundred times. The growth is the slope of the line through the last half of
it, so that what is loaded once does not count.

Dask's workers keep a profile of every second for an hour, unless
DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED=False.
"""

from __future__ import annotations

import csv
import multiprocessing
import tempfile
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import click
import numpy as np

from linkages.app.options import FOLDER
from linkages.app.sweep.plan import Plan, read_plan
from linkages.app.sweep.run import run_sweep
from studies.study import Study

MEBIBYTE = 2.0**20
LOOKS = 100


@dataclass
class Watch:
    """Resident memory (bytes) of the sweep's own process and of its largest worker, by
    members finished."""

    members: list[int] = field(default_factory=list)
    own: list[int] = field(default_factory=list)
    worker: list[int] = field(default_factory=list)

    def look(self, done: int) -> None:
        """One more line."""
        import psutil

        sizes = [0]
        for child in psutil.Process().children(recursive=True):
            try:
                sizes.append(child.memory_info().rss)
            except psutil.NoSuchProcess:  # it ended between the two calls
                continue
        self.members.append(done)
        self.own.append(psutil.Process().memory_info().rss)
        self.worker.append(max(sizes))

    def sizes(self, which: str) -> list[int]:
        """The sizes of "own" or "worker"."""
        return self.own if which == "own" else self.worker

    def growth(self, which: str) -> float:
        """Bytes a member, of "own" or "worker": slope of the line through the last
        half."""
        half = len(self.members) // 2
        slope, _ = np.polyfit(self.members[half:], self.sizes(which)[half:], 1)
        return float(slope)


def watch_sweep(plan: Plan, workers: int, dask: bool) -> Watch:
    """The memory of this process and of ``workers`` others while a plan is run into a
    folder that is thrown away."""
    watch = Watch()
    every = max(plan.size // LOOKS, 1)
    done = 0

    def look(count: int) -> None:
        nonlocal done
        done += count
        if count and done % every == 0:
            watch.look(done)

    with (
        tempfile.TemporaryDirectory() as folder,
        _scheduler(workers, dask) as scheduler,
    ):
        run_sweep(
            plan,
            Path(folder) / "sweep.zarr",
            workers=workers,
            scheduler=scheduler,
            progress=look,
        )
    return watch


@contextmanager
def _scheduler(workers: int, dask: bool) -> Iterator[str | None]:
    """Address of a Dask cluster on this machine, or None for the process pool."""
    if not dask:
        yield None
        return
    from distributed import LocalCluster

    with LocalCluster(  # type: ignore[no-untyped-call]
        n_workers=workers,
        threads_per_worker=1,
        host="127.0.0.1",
        dashboard_address=None,
    ) as cluster:
        yield cluster.scheduler_address


@click.command(cls=Study)
@click.option("--family", default="bennett", show_default=True)
@click.option(
    "--members",
    multiple=True,
    type=click.IntRange(20),
    default=(500, 2000, 8000),
    show_default=True,
)
@click.option("--workers", default=2, show_default=True, type=click.IntRange(1))
@click.option(
    "--out",
    default="sweep_memory",
    show_default=True,
    type=FOLDER,
)
def main(family: str, members: tuple[int, ...], workers: int, out: Path) -> None:
    """Measure the memory of sweeps."""
    out.mkdir(parents=True, exist_ok=True)
    click.echo(
        "of the sweep, then of its largest worker: MiB at first, at last, at most; "
        "growth in bytes a member"
    )
    for executor in ("pool", "dask"):
        for count in members:
            plan = read_plan(family, [], random=count)
            watch = _watch_in_fresh_process(plan, workers, executor == "dask")
            _write(watch, out / f"{family}_{executor}_{count}.csv")
            columns = [_describe(watch, which) for which in ("own", "worker")]
            click.echo(f"{count:7d}  {executor:8s}  {'   '.join(columns)}")


def _watch_in_fresh_process(plan: Plan, workers: int, dask: bool) -> Watch:
    """As `watch_sweep`, where nothing but the sweep takes memory."""
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=context) as fresh:
        return fresh.submit(watch_sweep, plan, workers, dask).result()


def _write(watch: Watch, path: Path) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(["members", "own", "worker"])
        rows.writerows(zip(watch.members, watch.own, watch.worker, strict=True))


def _describe(watch: Watch, which: str) -> str:
    """Memory at first, at last and at most, and its growth, of "own" or "worker"."""
    sizes = np.array(watch.sizes(which)) / MEBIBYTE
    growth = watch.growth(which)
    return f"{sizes[0]:6.1f} {sizes[-1]:6.1f} {sizes.max():6.1f} {growth:8.0f}"


if __name__ == "__main__":
    main()
