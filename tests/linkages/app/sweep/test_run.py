"""A sweep maps every member once, whatever kills it on the way."""

import gc
import json
import os
import signal
import subprocess
import sys
import time
import tracemalloc
import warnings
from concurrent.futures import Executor, Future
from contextlib import contextmanager

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

pytest.importorskip("zarr")

from linkages.app.cli import main
from linkages.app.sweep.plan import Plan, read_plan
from linkages.app.sweep.run import Pool, journal_path, run_sweep
from linkages.app.sweep.store import SweepStore, open_sweep
from linkages.app.sweep.subjects import Family

PLAN = Plan(
    Family("bennett"),
    axes={
        "alpha": tuple(np.radians(np.linspace(20, 160, 6)).tolist()),
        "beta": tuple(np.radians([15, 40, 65]).tolist()),
    },
    starts=20,
    block=4,
)
SCRIPT = """
from pathlib import Path
from tests_plan import PLAN
from linkages.app.sweep.run import run_sweep
if __name__ == "__main__":
    run_sweep(PLAN, Path("killed.zarr"), workers=1)
"""


def members(path):
    if not path.exists():
        return []
    lines = [line for line in path.read_bytes().split(b"\n")[:-1] if line]
    return [record["member"] for record in map(json.loads, lines) if "member" in record]


def same_but_for_seconds(one, other):
    names = [name for name in one.variables if name != "seconds"]
    assert set(one.variables) == set(other.variables)
    return all(
        np.array_equal(
            one[n].values, other[n].values, equal_nan=one[n].dtype.kind == "f"
        )
        for n in names
    )


def start_and_kill_after(folder, count):
    """Run the sweep in a process of its own and kill it once the journal holds
    ``count`` more members."""
    journal = journal_path(folder / "killed.zarr")
    goal = len(members(journal)) + count
    process = subprocess.Popen(
        [sys.executable, "script.py"],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": path_of(folder)},
    )
    while len(members(journal)) < goal and process.poll() is None:
        time.sleep(0.002)
    process.send_signal(signal.SIGKILL)
    return process.wait()


def path_of(folder):
    return os.pathsep.join([str(folder), *filter(None, sys.path)])


@pytest.mark.usefixtures("same_process")
def test_a_sweep_killed_twice_equals_one_that_was_not(tmp_path):
    run_sweep(PLAN, tmp_path / "whole.zarr", workers=1)
    (tmp_path / "script.py").write_text(SCRIPT)
    (tmp_path / "tests_plan.py").write_text(
        "from linkages.app.sweep.plan import Plan\n"
        "from linkages.app.sweep.subjects import Family\n"
        f"PLAN = {PLAN!r}\n"
    )
    for count in (3, 6):
        assert start_and_kill_after(tmp_path, count) == -signal.SIGKILL
    run_sweep(PLAN, tmp_path / "killed.zarr", workers=1)
    finished = members(journal_path(tmp_path / "killed.zarr"))
    assert sorted(finished) == list(range(PLAN.size))
    assert same_but_for_seconds(
        open_sweep(tmp_path / "whole.zarr"), open_sweep(tmp_path / "killed.zarr")
    )


@pytest.mark.usefixtures("same_process")
def test_a_finished_sweep_does_nothing_more(tmp_path):
    plan = Plan(Family("bennett"), random=3, ranges={"alpha": (0.5, 1.0)}, starts=10)
    run_sweep(plan, tmp_path / "a.zarr", workers=1)
    before = journal_path(tmp_path / "a.zarr").read_bytes()
    told = []
    run_sweep(plan, tmp_path / "a.zarr", workers=1, progress=told.append)
    assert journal_path(tmp_path / "a.zarr").read_bytes() == before
    assert sum(told) == 3


@pytest.mark.usefixtures("same_process")
def test_atlases_are_written_on_request(tmp_path):
    from bifurc.files.dataset import load_atlas

    run_sweep(
        Plan(Family("bennett"), random=2, starts=10),
        tmp_path / "a.zarr",
        workers=1,
        atlases=tmp_path / "atlases",
    )
    names = sorted(path.name for path in (tmp_path / "atlases").iterdir())
    assert names == ["member_0000000.nc", "member_0000001.nc"]
    assert len(load_atlas(tmp_path / "atlases" / names[0]).forms) == 1


def test_a_dask_cluster_of_processes_gives_the_same(tmp_path):
    distributed = pytest.importorskip("distributed")
    plan = read_plan("bennett", ["alpha=20:160:3", "beta=15:65:2"], starts=20)
    run_sweep(plan, tmp_path / "pool.zarr", workers=1)
    with distributed.LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        processes=True,
        host="127.0.0.1",
        dashboard_address=None,
    ) as cluster:
        run_sweep(plan, tmp_path / "dask.zarr", scheduler=cluster.scheduler_address)
    assert same_but_for_seconds(
        open_sweep(tmp_path / "pool.zarr"), open_sweep(tmp_path / "dask.zarr")
    )


class Stub(Executor):
    """Maps nothing: gives the same record for every member at once."""

    def submit(self, function, *arguments, **options):
        future = Future()
        future.set_result(
            {
                "status": 0,
                "forms": 1,
                "inactive_joints": [0] * 4,
                "seconds": time.process_time(),
            }
        )
        return future


@contextmanager
def traced():
    """Bytes held, garbage collected, as a function to call."""

    def held():
        gc.collect()
        return tracemalloc.get_traced_memory()[0]

    tracemalloc.start()
    try:
        yield held
    finally:
        tracemalloc.stop()


def test_a_sweep_holds_no_more_of_many_members_than_of_few(tmp_path, monkeypatch):
    @contextmanager
    def stub_pool(workers, scheduler):
        yield Pool(Stub(), window=8)

    monkeypatch.setattr("linkages.app.sweep.run.open_pool", stub_pool)
    done, sizes = 0, {}

    def look(count):
        nonlocal done
        done += count
        if done in (200, 700):
            sizes[done] = held()

    with traced() as held:
        run_sweep(
            Plan(Family("bennett"), random=750, block=50),
            tmp_path / "a.zarr",
            progress=look,
        )
    assert sizes[700] - sizes[200] < 500 * 100  # a record alone is more than 500 bytes


@pytest.mark.usefixtures("same_process")
def test_the_command_says_what_became_of_the_members(tmp_path):
    out = tmp_path / "out.zarr"
    arguments = [
        "double-subtractive-goldberg",
        "--param",
        "gamma=28:70:2",
        "--workers",
        "1",
        "--out",
        str(out),
    ]
    result = CliRunner().invoke(main, ["sweep", *arguments, "--starts", "20"])
    assert result.exit_code == 0, result.output
    assert "1 mapped, 1 refused" in result.output


def test_other_programs_open_the_dataset_without_a_warning(tmp_path):
    out = tmp_path / "sweep.zarr"
    plan = read_plan("bennett", ["alpha=20:60:2"])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        SweepStore(out, plan)
        dataset = xr.open_zarr(out)
        again = open_sweep(out)
    assert set(dataset.variables) == set(again.variables)
    assert np.degrees(dataset["alpha"].values) == pytest.approx([20, 60])
