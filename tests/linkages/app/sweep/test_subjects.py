"""A sweep over a network or a mechanism: parameters and locks of joints."""

import json
import pickle
import warnings
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

pytest.importorskip("zarr")

from linkages.app.cli import main
from linkages.app.exit_codes import CommandError, ExitCode
from linkages.app.sweep.journal import CHECK, JournalError
from linkages.app.sweep.member import Status, map_member
from linkages.app.sweep.plan import Plan, read_plan
from linkages.app.sweep.run import journal_path, run_sweep
from linkages.app.sweep.store import StoreError, SweepStore, open_sweep
from linkages.app.sweep.subjects import (
    LOCK,
    Family,
    FileMechanism,
    NetworkFamily,
    choose_subject,
)
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.parameters.joint_family import JointFamily
from linkages.values import GeometryError
from tests.linkages.app.slider_cranks import slider_crank_text

NETWORK = "four-bennett-network"
CASE_4 = ["2=40", "6=-75:90:2"]

# a crank of length 1, a rod of length 2, and the slide counted from x = 3
SLIDER_CRANK = slider_crank_text((1, 0), 3, "A-7", "S/4") + "limits = [-5, 5]\n"
BENNETT = """
angles = "deg"
lengths = [0.65270364, 1, 0.65270364, 1]
twists = [40, 100, 40, 100]
offsets = [0, 0, 0, 0]
"""


PITCHFORK = """
name = "an imperfect pitchfork"
parameter = "p"
[unknowns]
x = [-2, 2]
p = [-2, 2]
[parameters]
h = 0
low = 0
[equations]
rate = "x' = h + p*x - x^3"
[events]
one = "x + 0*sqrt(low) = 1"
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("slider_crank.toml").write_text(SLIDER_CRANK, encoding="utf-8")
    Path("table.toml").write_text(BENNETT, encoding="utf-8")
    return tmp_path


def sweep(plan, out):
    run_sweep(plan, out, workers=1)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return xr.open_zarr(out).load()


def command(*arguments, code=ExitCode.DONE):
    result = CliRunner().invoke(main, ["sweep", *arguments, "--workers", "1"])
    assert result.exit_code == code, result.output
    return result


# --- networks -------------------------------------------------------------------------


@pytest.mark.usefixtures("same_process")
def test_a_network_is_swept_over_parameters_and_locks(tmp_path):
    plan = read_plan(NETWORK, ["beta=30:62:2"], starts=10, locks=CASE_4)
    dataset = sweep(plan, tmp_path / "a.zarr")
    assert dataset.forms.dims == ("beta", "lock_6")
    assert np.degrees(dataset.lock_6.values) == pytest.approx([-75, 90])
    assert (dataset.mobility == 1).all()
    assert dataset.joint.values.tolist() == list("123456780")
    assert dataset.forms.sel(lock_6=np.radians(-75), method="nearest")[1] == 2


@pytest.mark.usefixtures("same_process")
def test_a_network_without_its_centre_is_the_loop_of_its_outer_joints(tmp_path):
    plan = read_plan(NETWORK, [], starts=10, locks=CASE_4, is_without_centre=True)
    dataset = sweep(plan, tmp_path / "a.zarr")
    assert dataset.joint.values.tolist() == list("12345678")
    still = dataset.inactive_joints == dataset.forms
    assert still.sel(joint=["2", "6"]).all()
    assert not still.sel(joint=["1", "3", "5", "7"]).any()


def test_locks_at_which_a_network_cannot_be_assembled_are_a_status():
    locks = {f"lock_{joint}": np.radians(20.0) for joint in "1357"}
    record = map_member(NetworkFamily(NETWORK), locks, 10, 0)
    assert record["status"] == Status.REFUSED
    assert "can be assembled" in record["message"]


def test_lengths_of_a_network_are_checked_member_by_member():
    subject = NetworkFamily(NETWORK)
    b = subject.member({}).linkage.placed.network.links["b"].length
    assert subject.member({"b": float(b)}).linkage
    record = map_member(subject, {"b": float(b) + 0.1}, 10, 0)
    assert record["status"] == Status.REFUSED


def test_members_of_a_network_are_drawn_from_ranges_of_locks():
    plan = read_plan(NETWORK, ["a=1"], random=5, locks=["2=40", "6=-10:10"])
    drawn = [plan.values(index) for index in range(plan.size)]
    assert all(abs(values["lock_6"]) <= np.radians(10) for values in drawn)
    assert len({values["lock_6"] for values in drawn}) == 5
    assert {values["lock_2"] for values in drawn} == {np.radians(40)}
    assert all({"alpha", "beta", "gamma", "delta"} < values.keys() for values in drawn)


# --- mechanisms -----------------------------------------------------------------------


@pytest.mark.usefixtures("same_process")
def test_a_mechanism_is_swept_over_locks_in_degrees_and_lengths(folder):
    plan = read_plan("slider_crank.toml", [], locks=["S/4=-7:1:5"], starts=20)
    assert plan.axes["lock_S%2F4"] == (-7, -5, -3, -1, 1)
    dataset = sweep(plan, folder / "a.zarr")
    assert dataset.joint.values.tolist() == ["A-7", "J2", "J3", "S/4"]
    assert dataset.status.values.tolist() == [Status.REFUSED, *4 * [Status.MAPPED]]
    # x = 3 + slide is within 1 and 3 of either side of the pivot for -2 and 2
    assert dataset.rigid.values.tolist() == [-1, 2, 0, 2, 0]
    assert dataset.closure_gap.values[-1] > 0.1
    assert (dataset.mobility[1:] == 0).all()
    assert "long_name" in dataset["lock_S%2F4"].attrs

    turned = read_plan("slider_crank.toml", [], locks=["A-7=0:90:2"], starts=20)
    dataset = sweep(turned, folder / "b.zarr")
    assert np.degrees(dataset["lock_A-7"].values) == pytest.approx([0, 90])
    assert dataset["lock_A-7"].attrs["units"] == "rad"
    # +-2 from the pin in line with the slide, +-sqrt(3) from the one above
    assert dataset.rigid.values.tolist() == [2, 2]


def test_a_mechanism_that_moves_has_still_joints_by_name():
    joints = [
        Joint("A", "revolute", ("frame", "a"), (0, 0, 0), (0, 0, 1)),
        Joint("B", "revolute", ("a", "b"), (0.3, 1.1, 0), (0, 0, 1)),
        Joint("C", "revolute", ("b", "c"), (1.4, 1.9, 0), (0, 0, 1)),
        Joint("D", "revolute", ("c", "d"), (2.6, 1.0, 0), (0, 0, 1)),
        Joint("E", "revolute", ("d", "frame"), (2.2, 0, 0), (0, 0, 1)),
    ]
    subject = FileMechanism(JointFamily(Mechanism(tuple(joints), is_planar=True)))
    record = map_member(subject, {"lock_C": 0.0}, 20, 0)
    forms = record["forms"]
    assert record["mobility"] == 1 and forms
    assert record["inactive_joints"] == [0, 0, forms, 0, 0]
    free = map_member(subject, {}, 20, 0)
    assert free["mobility"] == 2 and free["surfaces"]


def test_locks_that_leave_nothing_to_move_are_a_status(folder):
    subject = choose_subject("slider_crank.toml")
    locks = [one for one in subject.quantities if one.option == LOCK]
    values = {quantity.name: 0.0 for quantity in locks}
    record = map_member(subject, values, 10, 0)
    assert record["status"] == Status.REFUSED
    assert "left to move" in record["message"]


def test_workers_get_the_mechanism_itself_and_not_its_file(folder):
    subject = choose_subject("slider_crank.toml")
    Path("slider_crank.toml").unlink()
    copy = pickle.loads(pickle.dumps(subject))
    assert copy.identity == subject.identity
    assert copy.member({"lock_A-7": 0.5}).linkage.joint("A-7").locked == (0.5,)


@pytest.mark.usefixtures("same_process")
def test_a_changed_file_is_refused_where_a_sweep_goes_on(folder):
    locks = ["A-7=0:90:2"]
    plan = read_plan("slider_crank.toml", [], locks=locks, starts=5)
    run_sweep(plan, folder / "a.zarr", workers=1)
    before = journal_path(folder / "a.zarr").read_bytes()
    same = "# the same mechanism\n" + SLIDER_CRANK
    Path("slider_crank.toml").write_text(same, encoding="utf-8")
    again = read_plan("slider_crank.toml", [], locks=locks, starts=5)
    run_sweep(again, folder / "a.zarr", workers=1)
    assert journal_path(folder / "a.zarr").read_bytes() == before

    longer = SLIDER_CRANK.replace("[3, 0, 0]", "[3.0000001, 0, 0]")
    Path("slider_crank.toml").write_text(longer, encoding="utf-8")
    other = read_plan("slider_crank.toml", [], locks=locks, starts=5)
    with pytest.raises(StoreError, match="another sweep"):
        run_sweep(other, folder / "a.zarr", workers=1)
    journal_path(folder / "b.zarr").write_bytes(before)
    with pytest.raises(JournalError, match="another sweep"):
        run_sweep(other, folder / "b.zarr", workers=1)


# --- journals -------------------------------------------------------------------------


def test_the_header_of_a_family_is_what_it_always_was():
    plan = read_plan("bennett", ["alpha=0:90:2", "a=2"])
    assert json.dumps(plan.as_dict()) == (
        '{"family": "bennett", "axes": {"alpha": [0.0, 1.5707963267948966]}, '
        '"fixed": {"a": 2.0}, "ranges": {}, "random": 0, "starts": 200, "seed": 0, '
        '"block": 512}'
    )


def old_sweep(out):
    """The plan of a finished sweep that knew nothing of mobility or of checksums, and
    its dataset in ``out``."""
    plan = Plan(Family("bennett"), axes={"alpha": (0.5, 0.7)}, starts=5, block=1)
    run_sweep(plan, out, workers=1)
    path = journal_path(out)
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    for line in lines:
        line.pop("mobility", None)
        del line[CHECK]
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    for file in sorted((out / "mobility").rglob("*"), reverse=True):
        file.rmdir() if file.is_dir() else file.unlink()
    (out / "mobility").rmdir()
    group = json.loads((out / "zarr.json").read_text())
    del group["consolidated_metadata"]["metadata"]["mobility"]
    (out / "zarr.json").write_text(json.dumps(group))
    return plan


@pytest.mark.usefixtures("same_process")
def test_a_journal_without_mobility_is_read(tmp_path):
    out = tmp_path / "a.zarr"
    plan = old_sweep(out)
    dataset = sweep(plan, out)
    assert dataset.status.values.tolist() == [Status.MAPPED, Status.MAPPED]
    assert dataset.mobility.values.tolist() == [-1, -1]
    assert "is_being_made" not in dataset.attrs


@pytest.mark.usefixtures("same_process")
def test_a_dataset_whose_making_was_interrupted_is_made_again(tmp_path, monkeypatch):
    out = tmp_path / "a.zarr"
    plan = old_sweep(out)
    write = SweepStore.write

    def write_the_first_only(self, block, records):
        if block.number:
            raise KeyboardInterrupt
        write(self, block, records)

    with monkeypatch.context() as patch:
        patch.setattr(SweepStore, "write", write_the_first_only)
        with pytest.raises(KeyboardInterrupt):
            run_sweep(plan, out, workers=1)
    run_sweep(plan, out, workers=1)
    assert (open_sweep(out).status.values == Status.MAPPED).all()


# --- the command ----------------------------------------------------------------------


def test_the_command_sweeps_networks_and_mechanisms(folder):
    few = ("--starts", "5", "--out")
    told = command(NETWORK, "--lock", "2=40", "--lock", "6=0:90:2", *few, "n.zarr")
    assert "2 mapped" in told.stdout
    told = command("slider_crank.toml", "--lock", "S/4=-6:0:3", *few, "s.zarr")
    assert "2 mapped" in told.stdout and "1 refused" in told.stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("table.toml", "--lock", "1=0:9:2"), "it takes a network or the file"),
        (("table.toml", "--param", "a=1:2:2"), "a name out of a12, alpha12, R1"),
        (("table.toml", "--without-centre"), "takes a network"),
        (("bennett", "--lock", "1=0:9:2"), "it takes a network or the file"),
        (("bennett", "--param", "a=1:2:2", "--without-centre"), "takes a network"),
        (("slider_crank.toml", "--without-centre"), "takes a network"),
        (("slider_crank.toml", "--param", "a=1:2:2"), "a name out of A-7."),
        (("slider_crank.toml",), "--param or --lock: no grid"),
        (("slider_crank.toml", "--random", "3"), "--param or --lock: no range"),
        (("slider_crank.toml", "--lock", "J9=0:9:2"), "out of A-7, J2, J3, S/4"),
        (("slider_crank.toml", "--lock", "J2=0:9"), "first:last:count"),
        (("slider_crank.toml", "--lock", "J2=0:9:2", "--lock", "J2=1"), "only once"),
        (("slider_crank.toml", "--lock", "J2=x:9:2"), "--lock J2"),
        ((NETWORK,), "--param or --lock: no grid"),
        ((NETWORK, "--lock", "0=0:9:2"), "out of 1, 2, 3, 4, 5, 6, 7, 8"),
        ((NETWORK, "--lock", "1=0:1e9:2"), "--lock 1"),
    ],
)
def test_what_cannot_be_swept_is_said_in_one_line(folder, arguments, message):
    before = set(Path().iterdir())
    result = command(*arguments, code=ExitCode.BAD_INPUT)
    assert message in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1
    assert set(Path().iterdir()) == before


def test_names_of_axes_are_those_of_joints_and_never_alike():
    joints = [
        Joint(name, "revolute", pair, (x, y, 0), (0, 0, 1))
        for name, pair, x, y in (
            ("a/b", ("frame", "a"), 0, 0),
            ("a%2Fb", ("a", "b"), 0, 1),
            ("a b", ("b", "c"), 2, 1),
            ("A-7", ("c", "frame"), 2, 0),
        )
    ]
    subject = FileMechanism(JointFamily(Mechanism(tuple(joints))))
    names = [quantity.name for quantity in subject.quantities]
    assert names[-4:] == ["lock_a%2Fb", "lock_a%252Fb", "lock_a%20b", "lock_A-7"]


FOUR_BAR = """
fixed = ["A", "D"]
bars = [["A", "B"], ["B", "C"], ["C", "D"]]
[points]
A = [0, 0]
B = [0, 1]
C = [2, 2]
D = [3, 0]
"""


@pytest.mark.usefixtures("same_process")
def test_a_sweep_over_lengths_of_a_file_sees_where_a_crank_no_longer_turns(folder):
    Path("four_bar.toml").write_text(FOUR_BAR, encoding="utf-8")
    spans = ["A-B=0.5:2:4", "D.x=2.5:3.5:3"]
    run_sweep(
        read_plan("four_bar.toml", spans, starts=50), folder / "a.zarr", workers=1
    )
    dataset = open_sweep(folder / "a.zarr")
    for crank in dataset["A-B"].values:
        for ground in dataset["D.x"].values:
            lengths = sorted([crank, ground, np.sqrt(5.0), np.sqrt(5.0)])
            turns_fully = lengths[0] + lengths[3] < lengths[1] + lengths[2]
            member = dataset.sel({"A-B": crank, "D.x": ground})
            assert member.components == (2 if turns_fully else 1)


def test_entries_of_a_table_are_swept_and_its_other_entries_stay(folder):
    subject = choose_subject("table.toml")
    twisted = subject.member({"alpha12": 0.7}).linkage.loop
    table = subject.loop
    assert twisted.twists == (0.7, *table.twists[1:])
    assert twisted.lengths == table.lengths
    assert pickle.loads(pickle.dumps(subject)).identity == subject.identity


@pytest.mark.usefixtures("same_process")
def test_equations_are_swept_over_their_constants_and_go_on(folder):
    Path("pitchfork.toml").write_text(PITCHFORK, encoding="utf-8")
    plan = read_plan("pitchfork.toml", ["h=0:0.1:2", "low=0:-1:2"], starts=10)
    data = sweep(plan, folder / "a.zarr")
    assert dict(data.sizes) == {"h": 2, "low": 2}
    assert data.h.values.tolist() == [0, 0.1]
    # a constant that leaves an event without a value makes no member
    assert (data.status.values == [[0, 1]] * 2).all()
    first = data.sel(low=0)
    assert first.bifurcations.values.tolist() == [1, 0]
    assert first.folds.values.tolist() == [0, 1]
    assert first.forms.values.tolist() == [2, 2]
    assert first.events.values.tolist() == [1, 1]
    assert first.closure.values.max() < 1e-12
    assert "units" not in data.total_length.attrs and "joint" not in data.dims

    lines = journal_path(folder / "a.zarr").read_text().splitlines(keepends=True)
    half = folder / "half.zarr"
    journal_path(half).write_text("".join(lines[:3]))
    assert sweep(plan, half).drop_vars("seconds").equals(data.drop_vars("seconds"))
    kept = journal_path(half).read_text().splitlines(keepends=True)
    assert kept[:3] == lines[:3] and len(kept) == len(lines)

    Path("pitchfork.toml").write_text(PITCHFORK.replace("x^3", "x^5"))
    with pytest.raises(StoreError, match="another sweep"):
        sweep(read_plan("pitchfork.toml", ["h=0:0.1:2", "low=0:-1:2"]), half)


@pytest.mark.parametrize(
    "options, words",
    [
        ({"parameters": ["k=1:2:3"]}, "name=... with a name out of h, low"),
        ({"parameters": ["h=1"]}, "--param: no grid"),
        ({"parameters": [], "locks": ["x=1:2:3"]}, "has no joints that could be lock"),
        ({"parameters": ["h=0:1:2"], "is_without_centre": True}, "takes a network"),
    ],
)
def test_what_equations_do_not_have_is_refused(folder, options, words):
    Path("pitchfork.toml").write_text(PITCHFORK, encoding="utf-8")
    with pytest.raises((GeometryError, CommandError), match=words):
        read_plan("pitchfork.toml", **options)
