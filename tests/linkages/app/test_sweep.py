"""A sweep maps every member once, whatever kills it on the way."""

import gc
import json
import mmap
import os
import signal
import subprocess
import sys
import time
import tracemalloc
from concurrent.futures import Executor, Future
from contextlib import contextmanager

import numpy as np
import pytest
from click.testing import CliRunner

pytest.importorskip("zarr")

from linkages.app.sweep.command import sweep_command
from linkages.app.sweep.journal import Journal, JournalError
from linkages.app.sweep.member import Status, map_member
from linkages.app.sweep.plan import Plan, read_plan
from linkages.app.sweep.run import journal_path, run_sweep
from linkages.app.sweep.store import open_sweep
from linkages.loop import GeometryError

PLAN = Plan(
    "bennett",
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


def test_a_sweep_killed_twice_equals_one_that_was_not(tmp_path):
    run_sweep(PLAN, tmp_path / "whole.zarr", workers=1)
    (tmp_path / "script.py").write_text(SCRIPT)
    (tmp_path / "tests_plan.py").write_text(
        f"from linkages.app.sweep.plan import Plan\nPLAN = {PLAN!r}\n"
    )
    for count in (3, 6):
        assert start_and_kill_after(tmp_path, count) == -signal.SIGKILL
    run_sweep(PLAN, tmp_path / "killed.zarr", workers=1)
    finished = members(journal_path(tmp_path / "killed.zarr"))
    assert sorted(finished) == list(range(PLAN.size))
    assert same_but_for_seconds(
        open_sweep(tmp_path / "whole.zarr"), open_sweep(tmp_path / "killed.zarr")
    )


def test_a_finished_sweep_does_nothing_more(tmp_path):
    plan = Plan("bennett", random=3, ranges={"alpha": (0.5, 1.0)}, starts=10)
    run_sweep(plan, tmp_path / "a.zarr", workers=1)
    before = journal_path(tmp_path / "a.zarr").read_bytes()
    told = []
    run_sweep(plan, tmp_path / "a.zarr", workers=1, progress=told.append)
    assert journal_path(tmp_path / "a.zarr").read_bytes() == before
    assert sum(told) == 3


def test_atlases_are_written_on_request(tmp_path):
    from bifurc.files.dataset import load_atlas

    run_sweep(
        Plan("bennett", random=2, starts=10),
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
    def executor(workers, scheduler):
        yield Stub(), 8

    monkeypatch.setattr("linkages.app.sweep.run._executor", executor)
    done, sizes = 0, {}

    def look(count):
        nonlocal done
        done += count
        if done in (500, 1500):
            sizes[done] = held()

    with traced() as held:
        run_sweep(
            Plan("bennett", random=1550, block=50), tmp_path / "a.zarr", progress=look
        )
    assert (
        sizes[1500] - sizes[500] < 1000 * 100
    )  # a record alone is more than 500 bytes


@pytest.mark.parametrize("family", ["bennett", "goldberg-5r"])
def test_a_worker_keeps_nothing_of_the_members_that_it_mapped(family):
    plan = Plan(family, random=1000, ranges={"alpha": (0.5, 1.0)})
    with traced() as held:
        for index in range(20):
            map_member(family, plan.parameters(index), 10, 0)
            if index == 9:
                before = held()
        assert held() - before < 10 * 1000  # a single traced form is more than 20 kB


def test_the_watch_sees_a_process_that_grows():
    psutil = pytest.importorskip("psutil")
    from linkages.app.sweep.memory import Watch

    watch, kept, size = Watch(), [], 1 << 22
    for done in range(20):
        kept.append(
            mmap.mmap(-1, size)
        )  # an array might be given memory that the process has in hand
        kept[-1].write(bytes([1]) * size)
        watch.look(done)
    assert watch.own[-1] == pytest.approx(psutil.Process().memory_info().rss, rel=0.1)
    assert watch.growth("own") == pytest.approx(size, rel=0.2)
    assert watch.growth("worker") < 1.0


def test_refused_parameters_are_recorded_as_such():
    record = map_member(
        "double-subtractive-goldberg", {"alpha": 0.5, "gamma": 1.5}, 10, 0
    )
    assert record["status"] == Status.REFUSED
    assert "length" in record["message"]


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
    result = CliRunner().invoke(sweep_command, [*arguments, "--starts", "20"])
    assert result.exit_code == 0, result.output
    assert "1 mapped, 1 refused" in result.output


# --- plan ---------------------------------------------------------------------------------------------


def test_blocks_hold_every_member_once():
    plan = Plan(
        "bennett",
        axes={
            "a": tuple(range(1, 6)),
            "alpha": tuple(range(1, 8)),
            "beta": (0.1, 0.2, 0.3),
        },
        block=8,
    )
    blocks = list(plan.blocks())
    indices = np.concatenate([block.indices for block in blocks])
    assert sorted(indices.tolist()) == list(range(plan.size))
    assert len(blocks) == plan.block_count
    assert all(
        plan.block_of(int(i)) == block.number for block in blocks for i in block.indices
    )
    assert max(len(block.indices) for block in blocks) <= 8


def test_degrees_are_read_as_radians_and_lengths_as_they_are():
    plan = read_plan("bennett", ["alpha=10:80:3", "a=2"])
    assert np.allclose(plan.axes["alpha"], np.radians([10, 45, 80]))
    assert plan.parameters(1) == {"a": 2.0, "alpha": pytest.approx(np.pi / 4)}


def test_a_random_member_does_not_depend_on_how_many_there_are():
    few, many = (
        read_plan("bennett", ["alpha=10:80"], random=n, seed=3) for n in (5, 50)
    )
    assert few.parameters(4) == many.parameters(4)
    assert few.parameters(4) != few.parameters(3)


@pytest.mark.parametrize(
    "text",
    [
        "alpha",
        "twist=3",
        "alpha=x",
        "alpha=1:2",
        "alpha=1:2:3:4",
        "alpha=1:2:0.5",
        "alpha=nan",
    ],
)
def test_a_parameter_that_cannot_be_read_is_refused(text):
    with pytest.raises(GeometryError):
        read_plan("bennett", [text])


# --- journal ------------------------------------------------------------------------------------------


def test_a_torn_last_line_is_dropped(tmp_path):
    path = tmp_path / "j"
    with Journal(path, {"sweep": 1}) as journal:
        journal.append({"member": 0})
    with path.open("ab") as file:
        file.write(b'{"member": 1, "fo')
    with Journal(path, {"sweep": 1}) as journal:
        assert list(journal.lines()) == [{"sweep": 1}, {"member": 0}]
        journal.append({"member": 1})
        assert list(journal.lines())[-1] == {"member": 1}


def test_the_journal_of_another_sweep_is_refused(tmp_path):
    Journal(tmp_path / "j", {"sweep": 1}).__exit__(None, None, None)
    with pytest.raises(JournalError, match="another sweep"):
        Journal(tmp_path / "j", {"sweep": 2})


def test_two_sweeps_cannot_write_one_journal(tmp_path):
    with (
        Journal(tmp_path / "j", {"sweep": 1}),
        pytest.raises(JournalError, match="is writing"),
    ):
        Journal(tmp_path / "j", {"sweep": 1})
