"""The journal of a sweep is not trusted further than it makes sense."""

import json
import shutil
from concurrent.futures import Executor
from contextlib import contextmanager
from pathlib import Path

import pytest
from click.testing import CliRunner

pytest.importorskip("zarr")

from linkages.app.cli import main
from linkages.app.exit_codes import ExitCode
from linkages.app.sweep.journal import JournalError
from linkages.app.sweep.plan import Plan
from linkages.app.sweep.run import Pool, journal_path, run_sweep
from linkages.app.sweep.store import StoreError, count_status
from linkages.app.sweep.subjects import Family

PLAN = Plan(Family("bennett"), random=3, ranges={"alpha": (0.5, 1.0)}, starts=10)
COUNTS = ("closed_forms", "bifurcations", "components", "rank_drops", "surfaces")
RECORD = {
    "status": 0,
    "forms": 1,
    **dict.fromkeys((*COUNTS, "one_cycle", "rigid", "complete"), 0),
    "inactive_joints": [0, 0, 0, 0],
    "closure": 1e-15,
}
DAMAGED = {
    "a member that is a word": '{"member": "x", "status": 0}',
    "a member beyond the last": '{"member": 3, "status": 0}',
    "a member before the first": '{"member": -1, "status": 0}',
    "half a member": '{"member": 0.5, "status": 0}',
    "a member without status": '{"member": 0}',
    "a status that there is not": '{"member": 0, "status": 77}',
    "a mapped member without its counts": '{"member": 0, "status": 0, "forms": 1}',
    "a word for a number": '{"member": 0, "status": 0, "forms": "many"}',
    "a number beyond its range": '{"member": 0, "status": 0, "forms": 1000000}',
    "too few joints": '{"member": 0, "status": 0, "inactive_joints": [1]}',
    "an unknown value": '{"member": 0, "status": 0, "colour": 1}',
    "a block beyond the last": '{"block": 1}',
    "a list for a block": '{"block": [0]}',
    "nothing": "",
    "zeros": "\0\0\0",
    "lists without end": 20_000 * "[",
    "a number of 5000 digits": '{"block": 1' + 5000 * "0" + "}",
    "another header": '{"sweep": {}}',
}


class Untouched(Executor):
    """An executor that must not be asked for anything."""

    def submit(self, function, *arguments, **options):
        raise AssertionError("a finished member is mapped again")


@contextmanager
def no_workers(workers, scheduler):
    yield Pool(Untouched(), window=1)


@pytest.fixture(scope="module")
def finished_once(tmp_path_factory):
    """The folder of a dataset all of whose members stand in the journal."""
    folder = tmp_path_factory.mktemp("finished")
    out = folder / "a.zarr"
    lines = [{"sweep": PLAN.as_dict()}]
    lines += [{"member": index, **RECORD} for index in range(PLAN.size)]
    text = "".join(json.dumps(line) + "\n" for line in lines)
    journal_path(out).write_text(text)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("linkages.app.sweep.run.open_pool", no_workers)
        run_sweep(PLAN, out)
    return folder


@pytest.fixture
def finished(finished_once, tmp_path, monkeypatch):
    """A copy of that dataset; nothing can be mapped."""
    monkeypatch.setattr("linkages.app.sweep.run.open_pool", no_workers)
    shutil.copytree(finished_once, tmp_path, dirs_exist_ok=True)
    return tmp_path / "a.zarr"


@pytest.mark.parametrize("what", DAMAGED)
def test_a_damaged_line_is_named_and_nothing_is_lost(what, finished):
    journal = journal_path(finished)
    with journal.open("a") as file:
        file.write(DAMAGED[what] + "\n")
    before = journal.read_bytes()
    with pytest.raises(JournalError, match="line 6 is damaged; delete this line"):
        run_sweep(PLAN, finished)
    assert journal.read_bytes() == before
    assert count_status(finished) == {"MAPPED": 3}


def test_a_dataset_that_was_deleted_is_made_again_from_the_journal(finished):
    shutil.rmtree(finished)
    run_sweep(PLAN, finished)
    assert count_status(finished) == {"MAPPED": 3}


def test_a_damaged_dataset_is_no_traceback(finished):
    for path in Path(finished / "status").rglob("c/*"):
        path.write_bytes(b"no zarr")
    with pytest.raises(StoreError, match="delete it, and the same command makes it"):
        count_status(finished)


@pytest.mark.usefixtures("same_process")
def test_the_command_ends_with_one_line_at_a_damaged_journal(tmp_path):
    grid = ("--param", "alpha=40:80:2", "--workers", "1", "--starts", "5")
    out = tmp_path / "a.zarr"
    runner = CliRunner()
    first = runner.invoke(main, ["sweep", "bennett", *grid, "--out", str(out)])
    assert first.exit_code == ExitCode.DONE, first.stderr
    with journal_path(out).open("a") as file:
        file.write('{"member": "x"}\n')
    result = runner.invoke(main, ["sweep", "bennett", *grid, "--out", str(out)])
    assert result.exit_code == ExitCode.BAD_INPUT
    assert "is damaged" in result.stderr.splitlines()[-1]
