"""What the check computes in balls, and which certificates it refuses."""

import ast
import copy
import json
import random
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest
from flint import arb, arb_poly, ctx

from bifurc.singular.point import Kind
from linkages.kinematics import Direction, link_transform
from linkages.loop import Loop
from linkages.rigorous import check
from linkages.rigorous.selection import floats_of
from linkages.rigorous.spheres import counted_half_branches, enclosed_point
from tests.linkages.rigorous.certificates import (
    certificate_of_loop,
    failures,
    named_certificate,
)
from tests.samples import one_in

DIGITS = 60
LENGTHS = ["1.1", "0", "0.7", "1.3", "0.4", "0.9"]
TWISTS = ["0.3", "1.57", "-2.2", "0", "0.8", "1.1"]
OFFSETS = ["0.1", "-0.6", "0", "0.2", "0", "0.5"]


@pytest.fixture(autouse=True)
def _precision():
    former, ctx.prec = ctx.prec, 128
    yield
    ctx.prec = former


@pytest.fixture
def loop():
    geometry = {
        "lengths": LENGTHS,
        "twists": TWISTS,
        "offsets": OFFSETS,
        "scale": "1.5",
    }
    return check.Loop(geometry)


def precise_equations(u):
    """F of that loop in mpmath, by products of transforms written out elsewhere."""
    product = mpmath.eye(4)
    for angle, length, twist, offset in zip(u, LENGTHS, TWISTS, OFFSETS, strict=True):
        alpha = mpmath.mpf(twist)
        turn = Direction(mpmath.cos(angle), mpmath.sin(angle))
        rows = link_transform(
            turn,
            Direction(mpmath.cos(alpha), mpmath.sin(alpha)),
            mpmath.mpf(length),
            mpmath.mpf(offset),
        )
        product = product * mpmath.matrix([*rows, (0, 0, 0, 1)])
    m = product
    skew = [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]]
    return [x / 2 for x in skew] + [m[i, 3] / mpmath.mpf("1.5") for i in range(3)]


def holds(enclosure, value, error):
    """Whether a ball holds a number that is known but for an error."""
    return enclosure.overlaps(arb(mpmath.nstr(value, 52), error))


@pytest.mark.parametrize("radius", [0.0, 1e-20, 1e-3])
def test_balls_hold_the_equations_and_their_derivatives_at_points_in_a_box(
    loop, radius
):
    rng = np.random.default_rng(1)
    centre, direction = rng.uniform(-3, 3, 6), rng.uniform(-1, 1, 6)
    over = loop.at([arb(x, radius) for x in centre])
    along = check.column(check.arb_vector(direction))
    first = over.jacobian * along
    second = over.second(check.arb_vector(direction)) * along
    with mpmath.workdps(DIGITS):
        step = [mpmath.mpf(x) for x in radius * rng.uniform(-1, 1, 6)]
        h = mpmath.mpf("1e-15")
        before, here, after = (
            precise_equations(
                [
                    x + d + k * h * v
                    for x, d, v in zip(centre, step, direction, strict=True)
                ]
            )
            for k in (-1, 0, 1)
        )
        for row in range(6):
            assert holds(over.value.entries()[row], here[row], 1e-50)
            rate = (after[row] - before[row]) / (2 * h)
            assert holds(first.entries()[row], rate, 1e-28)
            bend = (after[row] - 2 * here[row] + before[row]) / h**2
            assert holds(second.entries()[row], bend, 1e-28)
            # what is held is no more than the box
            assert first.entries()[row].rad() < 1e-28 + 100 * radius


def test_series_hold_the_equations_along_a_curve(loop):
    rng = np.random.default_rng(2)
    table = rng.uniform(-1, 1, (6, 4))
    curve = [arb_poly(row) for row in table.tolist()]
    series = loop.series(curve, 24)
    with mpmath.workdps(DIGITS):
        x = mpmath.mpf("0.01")
        point = [sum(mpmath.mpf(c) * x**k for k, c in enumerate(row)) for row in table]
        for coefficients, value in zip(series, precise_equations(point), strict=True):
            total = arb_poly(coefficients)(arb("0.01"))
            # what is left out is of order 25
            assert holds(total, value, 1e-45) and total.rad() < 1e-35


def test_a_norm_of_what_is_not_bounded_is_refused():
    with pytest.raises(check.DoesNotHold, match="not bounded"):
        check.norm(check.arb_mat([[1, arb("nan")], [0, 1]]))


def test_the_check_imports_flint_and_the_standard_library_only():
    path = Path(check.__file__)
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names.add(node.module)
    outside = {name.split(".")[0] for name in names} - set(sys.stdlib_module_names)
    assert outside == {"flint"}


def test_the_check_runs_alone(tmp_path):
    script = tmp_path / "check.py"
    script.write_bytes(Path(check.__file__).read_bytes())
    (tmp_path / "map.json").write_text(named_certificate("bennett"))
    command = [sys.executable, "-I", str(script), str(tmp_path / "map.json")]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    assert "joined: holds" in result.stdout


# --- what is refused ------------------------------------------------------------------


def changed(text, amount):
    """A number in a certificate moved by an amount."""
    return (float(check.number(text)) + amount).hex()


def bend(certificate, rng):
    """A coefficient of a piece that a box is on."""
    tube = rng.choice(certificate["tubes"])
    piece = rng.choice(tube["boxes"])[0]
    angle = rng.choice(certificate["curves"][tube["curve"]]["pieces"][piece])
    angle[0] = changed(angle[0], 10 ** rng.uniform(-9, -1))


def shorten(certificate, rng):
    """A box after the first begins later: it leaves a gap."""
    box = rng.choice(rng.choice(certificate["tubes"])["boxes"][1:])
    length = float.fromhex(box[2]) - float.fromhex(box[1])
    box[1] = changed(box[1], length * rng.uniform(0.1, 0.5))


def narrow(certificate, rng):
    """A reach below the rounding of the curve."""
    rng.choice(rng.choice(certificate["tubes"])["boxes"])[3] = "1e-18"


def other_geometry(certificate, rng):
    """A link of another length."""
    lengths = certificate["geometry"]["lengths"]
    number = rng.randrange(len(lengths))
    lengths[number] = changed(lengths[number], 10 ** rng.uniform(-8, -1))


def move_point(certificate, rng):
    """A singular point elsewhere."""
    centre = rng.choice(certificate["points"])["centre"]
    number = rng.randrange(len(centre))
    centre[number] = changed(centre[number], 10 ** rng.uniform(-9, -1))


def turn_null_space(certificate, rng):
    """Another null space."""
    vector = rng.choice(rng.choice(certificate["points"])["null"])
    number = rng.randrange(len(vector))
    vector[number] = changed(vector[number], 10 ** rng.uniform(-1, 0))


def move_half_branch(certificate, rng):
    """A half-branch at another place of its piece."""
    half_branch = rng.choice(rng.choice(certificate["points"])["half_branches"])
    half_branch["x"] = changed(half_branch["x"], rng.uniform(0.3, 1.0))


def forget_half_branch(certificate, rng):
    """An arc that leaves a bifurcation and is not listed, with a kind to match."""
    point = rng.choice(certificate["points"])
    point["half_branches"].pop(rng.randrange(len(point["half_branches"])))


def forget_a_form(certificate, rng):
    """All of a form, with its half-branches: what is left of a bifurcation is called a
    rank drop."""
    number = rng.choice(certificate["tubes"])["curve"]
    for point in certificate["points"]:
        kept = [one for one in point["half_branches"] if one["curve"] != number]
        point["half_branches"] = kept
        point["kind"] = "bifurcation" if len(kept) > 2 else "rank drop"
    tubes = [tube for tube in certificate["tubes"] if tube["curve"] != number]
    for point in certificate["points"]:
        for one in point["half_branches"]:
            one["tube"] = tubes.index(certificate["tubes"][one["tube"]])
    certificate["tubes"] = tubes


def swap_arcs(certificate, rng):
    """The second halves of two tubes exchanged."""
    one, other = rng.sample(certificate["tubes"], 2)
    half, other_half = len(one["boxes"]) // 2, len(other["boxes"]) // 2
    one["boxes"][half:], other["boxes"][other_half:] = (
        other["boxes"][other_half:],
        one["boxes"][half:],
    )
    one["curve"] = other["curve"]


def rename_kind(certificate, rng):
    """A bifurcation called a rank drop, or the other way round."""
    point = rng.choice(certificate["points"])
    is_drop = point["kind"] == "rank drop"
    point["kind"] = "bifurcation" if is_drop else "rank drop"


def wrong_turns(certificate, rng):
    """An end of a tube a whole turn away."""
    place = rng.choice(rng.choice(certificate["tubes"])["ends"])
    place["turns"][rng.randrange(len(place["turns"]))] += 1


def leave_a_tube_open(certificate, rng):
    """A tube that has no ends."""
    tube = rng.choice(certificate["tubes"])
    del tube["ends"]
    tube["winding"] = None


def empty_a_tube(certificate, rng):
    """A tube without boxes."""
    rng.choice(certificate["tubes"])["boxes"] = []


def widen_point(certificate, rng):
    """A singular point that may be a near miss."""
    rng.choice(certificate["points"])["within"] = "1e-24"


def leave_sphere(certificate, rng):
    """A sphere that may not hold its point."""
    rng.choice(certificate["points"])["sphere"] = "1e-36"


def narrow_sector(certificate, rng):
    """A sector that does not hold all that a half-branch may be."""
    half_branch = rng.choice(rng.choice(certificate["points"])["half_branches"])
    middles = [check.number(text).mid() for text in half_branch["sector"]]
    half_branch["sector"] = [f"[{x.str(36, radius=False)} +/- 1e-30]" for x in middles]


def scale_up(certificate, rng):
    """A scale beside which no translation counts."""
    certificate["geometry"]["scale"] = rng.choice(["2.1e3", "1e30"])


def widen_table(certificate, rng):
    """A length that is known to a few digits only."""
    certificate["geometry"]["lengths"][rng.randrange(4)] = "[1 +/- 1e-29]"


def round_table(certificate, rng):
    """A length that would be rounded."""
    certificate["geometry"]["lengths"][rng.randrange(4)] = "0x1.00000000000004p+0"


def hide_a_piece(certificate, rng):
    """A piece that no box is on."""
    pieces = rng.choice(certificate["curves"])["pieces"]
    pieces.append([["0x1.0000000000000p+0"]] * 4)


def repeat_point(certificate, rng):
    """A singular point listed twice, under two names."""
    point = copy.deepcopy(rng.choice(certificate["points"]))
    certificate["points"].append({**point, "name": "another"})


def repeat_tube(certificate, rng):
    """An arc listed twice, the second time on a curve of its own."""
    tube = copy.deepcopy(rng.choice(certificate["tubes"]))
    curve = certificate["curves"][tube["curve"]]
    used = {box[0] for box in tube["boxes"]}
    pieces = [piece if k in used else [] for k, piece in enumerate(curve["pieces"])]
    certificate["tubes"].append({**tube, "curve": len(certificate["curves"])})
    certificate["curves"].append({"name": "another", "pieces": pieces})


WRONG = [
    bend,
    shorten,
    narrow,
    other_geometry,
    move_point,
    turn_null_space,
    move_half_branch,
    forget_half_branch,
    forget_a_form,
    swap_arcs,
    rename_kind,
    wrong_turns,
    leave_a_tube_open,
    empty_a_tube,
    widen_point,
    leave_sphere,
    narrow_sector,
    scale_up,
    widen_table,
    round_table,
    hide_a_piece,
    repeat_point,
    repeat_tube,
]


def test_a_certificate_as_it_was_made_holds():
    assert failures(json.loads(named_certificate("kite"))) == []


@pytest.mark.parametrize("change", WRONG, ids=lambda change: change.__name__)
@pytest.mark.parametrize("seed", one_in(17, range(17)))
def test_a_wrong_certificate_is_refused(change, seed):
    certificate = json.loads(named_certificate("kite"))
    change(certificate, random.Random(seed))
    assert failures(certificate)


@pytest.mark.parametrize("seed", one_in(20, range(20)))
def test_a_change_within_slack_is_accepted(seed):
    certificate = json.loads(named_certificate("kite"))
    rng = random.Random(seed)
    box = rng.choice(rng.choice(certificate["tubes"])["boxes"])
    length = float.fromhex(box[2]) - float.fromhex(box[1])
    box[1] = changed(box[1], 1e-6 * length)
    box[3] = (float.fromhex(box[3]) * rng.uniform(0.99, 1.01)).hex()
    point = rng.choice(certificate["points"])
    point["extra"][rng.randrange(6)] += "1"
    assert failures(certificate) == []


def test_a_certificate_that_is_not_whole_does_not_hold():
    whole = json.loads(named_certificate("bennett"))
    for key in whole:
        if key in ("name", "motions"):
            continue
        certificate = copy.deepcopy(whole)
        del certificate[key]
        assert failures(certificate)


def test_of_an_older_certificate_all_motions_are_not_claimed():
    older = json.loads(named_certificate("bennett"))
    del older["motions"]
    said = []
    assert check.check_certificate(older, said.append)
    assert not any(line.startswith("all motions") for line in said)
    assert any("the certificate is an older one" in line for line in said)


def test_a_certificate_that_states_nothing_does_not_hold():
    certificate = json.loads(named_certificate("kite"))
    certificate |= {"tubes": [], "points": [], "curves": []}
    assert failures(certificate) == ["does not hold: nothing is proved"]


FLAT = {"lengths": ["1", "1", "1", "3"], "twists": ["0"] * 4, "offsets": ["0"] * 4}


def flat_point(first):
    """Where this loop is stretched, and its certificate; turned by pi in the first joint it
    is off by half a turn."""
    geometry = {**FLAT, "scale": "1"}
    loop = check.Loop(geometry)
    u = np.array([first, 0.0, 0.0, np.pi])
    jacobian = floats_of(loop.at(check.arb_vector(u)).jacobian)
    null = np.linalg.svd(jacobian)[2][2:].T
    point = SimpleNamespace(u=u, null_space=null)
    meeting = SimpleNamespace(name="P", kind=Kind.RANK_DROP, point=point)
    return loop, meeting


def test_a_half_turn_is_no_singular_point():
    with pytest.raises(check.DoesNotHold, match="half a turn"):
        enclosed_point(*flat_point(0.0))


def test_a_point_that_no_curve_leaves_is_no_rank_drop():
    loop, meeting = flat_point(np.pi)
    point = enclosed_point(loop, meeting)
    point |= counted_half_branches(loop, point, [])
    certificate = json.loads(named_certificate("kite"))
    certificate |= {"geometry": {**FLAT, "scale": "1"}, "points": [point]}
    certificate |= {"curves": [], "tubes": []}
    (failure,) = failures(certificate)
    assert "0 half-branches make no rank drop" in failure


def test_a_loop_that_is_nearly_rigid_beside_its_scale_does_not_move():
    twists = [0.9, 1.3, 1.1, 1.4]
    certificate = certificate_of_loop(Loop([0.0] * 4, twists, [0.0] * 4))
    assert failures(certificate) == []
    certificate["geometry"]["lengths"] = ["1", "2", "0.7", "1.3"]
    certificate["claims"]["misses"] = "1e9"
    assert any("miss by too much" in line for line in failures(certificate))


def test_json_that_is_nested_too_deeply_is_no_certificate(tmp_path):
    file = tmp_path / "deep.json"
    file.write_text("[" * 100000)
    with pytest.raises(ValueError, match="nested"):
        check.read_certificate(str(file))
