"""The transition maps of nine linkages whose forms and bifurcations are known, and of
simple linkages."""

import json
from pathlib import Path

import mpmath
import numpy as np
import pytest

from bifurc.graphs import arc_graph
from linkages.catalogue import entry
from linkages.closure.closure import Closure
from linkages.loop import Loop
from tests.maps import curves_of

MAPS = json.loads(
    (Path(__file__).parents[1] / "data" / "reference_maps.json").read_text()
)
NAMES = [reference["name"] for reference in MAPS]
DEGREE = np.pi / 180


@pytest.fixture(scope="module")
def maps():
    """(reference, loop, atlas) by name."""
    out = {}
    for reference in MAPS:
        loop = Loop(reference["lengths"], reference["twists"], reference["offsets"])
        out[reference["name"]] = reference, loop, curves_of(loop)
    return out


def test_angles_of_points_events_and_rigid_assemblies_lie_within_half_a_turn(maps):
    for _, _, atlas in maps.values():
        events = [*atlas.near_misses, *atlas.dead_points]
        angles = [
            *atlas.rigid,
            *(p.point.u for p in atlas.points),
            *(e.u for e in events),
        ]
        assert np.all(np.array(angles) > -np.pi)
        assert np.all(np.array(angles) <= np.pi)


@pytest.fixture(params=NAMES)
def known(request, maps):
    return maps[request.param]


def turned(gap):
    """Angles taken to within half a turn of zero."""
    return gap - 2 * np.pi * np.round(gap / (2 * np.pi))


def exact_angles(reference):
    """Bifurcation angles: multiples of pi where flat; of the reconfigurable Bricard as
    the source's formula gives them."""
    theta = np.array(reference)
    flat = np.pi * np.round(theta / np.pi)
    if np.abs(theta - flat).max() < 1e-9:
        return flat
    printed = [
        (56.953814687696, -70.0, -146.277704015322),
        (-123.046185312304, -70.0, 33.722295984678),
    ]
    choices = [np.array(angles * 2) * DEGREE for angles in printed]
    return min(choices, key=lambda choice: np.abs(turned(choice - theta)).max())


def partners(reference, atlas):
    """Index of the found form of every reference form."""
    samples = np.array([form["theta"] for form in reference["forms"]])
    distances = np.array([form.branch.nearest(samples)[0] for form in atlas.forms])
    return distances.argmin(axis=0), distances.min(axis=0)


def closure_by_matrices(loop, theta):
    """Closure error (k, 6) and joint screws (k, 6, n), over the characteristic length,
    from 4 x 4 matrices alone."""
    frames, size = loop.frames(theta), loop.characteristic_length
    gap = frames[:, -1] - np.eye(4)
    rotation = 0.5 * np.stack(
        [
            gap[:, 2, 1] - gap[:, 1, 2],
            gap[:, 0, 2] - gap[:, 2, 0],
            gap[:, 1, 0] - gap[:, 0, 1],
        ],
        1,
    )
    screws = loop.joint_screws(theta)
    screws[:, 3:] /= size
    return (
        np.concatenate([rotation, gap[:, :3, 3] / size], axis=1),
        screws,
        np.abs(gap[:, :3]).max(axis=(1, 2)),
    )


def test_the_map_has_the_known_numbers_of_forms_bifurcations_and_components(known):
    reference, _, atlas = known
    assert reference["counts"] == {
        "forms": len(atlas.forms),
        "bifurcations": len(atlas.bifurcations),
        "components": atlas.components,
    }
    assert all(form.branch.closed for form in atlas.forms)
    assert len(atlas.points) == len(atlas.bifurcations)
    assert not any(point.note for point in atlas.points)


def test_bifurcations_lie_at_the_exact_angles_and_the_stated_error_bounds_theirs(known):
    reference, _, atlas = known
    left = list(atlas.bifurcations)
    for bifurcation in reference["bifurcations"]:
        exact = exact_angles(bifurcation["theta"])
        point = min(left, key=lambda p: np.abs(turned(p.point.u - exact)).max())
        left.remove(point)
        off = np.linalg.norm(turned(point.point.u - exact))
        # the issue asks for 1e-11; the printed angles end at 1e-12 degrees, a double
        # geometry at some 1e-15
        assert off < 1e-11
        assert off < point.point.error + 3e-14
        assert point.point.rank == bifurcation["rank"]


def test_tangents_at_the_bifurcations_are_the_known_ones(known):
    reference, _, atlas = known
    for bifurcation in reference["bifurcations"]:
        exact = exact_angles(bifurcation["theta"])
        point = min(
            atlas.bifurcations, key=lambda p: np.abs(turned(p.point.u - exact)).max()
        )
        for tangents in (
            point.tangents,
            point.point.tangents,
        ):  # of the traced forms, and of second order
            assert len(tangents) == len(bifurcation["tangents"])
            for tangent in np.array(bifurcation["tangents"]):
                gap = min(
                    np.abs(sign * t - tangent).max()
                    for t in tangents
                    for sign in (1, -1)
                )
                assert gap < 1e-8


def test_every_known_form_is_found_once_with_its_winding_and_its_inactive_joints(known):
    reference, _, atlas = known
    found, distance = partners(reference, atlas)
    assert sorted(found) == list(range(len(atlas.forms)))
    assert (
        distance.max() < 1e-9
    )  # the reference samples are closed to about 1e-14, of singular values above 1e-3
    for form, index in zip(reference["forms"], found, strict=True):
        branch = atlas.forms[index].branch
        assert any(
            np.array_equal(sign * branch.winding, form["winding"]) for sign in (1, -1)
        )
        spread = np.ptp(branch.sample(200), axis=0)
        assert [i + 1 for i in np.flatnonzero(spread < 1e-9)] == form["inactive_joints"]


def test_every_bifurcation_joins_the_known_forms(known):
    reference, _, atlas = known
    found, _ = partners(reference, atlas)
    index = {form["name"]: i for form, i in zip(reference["forms"], found, strict=True)}
    for bifurcation in reference["bifurcations"]:
        exact = exact_angles(bifurcation["theta"])
        point = min(
            atlas.bifurcations, key=lambda p: np.abs(turned(p.point.u - exact)).max()
        )
        assert sorted(i for i, _ in point.passes) == sorted(
            index[name] for name in bifurcation["forms"]
        )


def test_the_loop_is_closed_to_1e_12_everywhere_along_every_form(known):
    _, loop, atlas = known
    for form in atlas.forms:
        theta = form.branch.sample(10_000)
        gap = loop.frames(theta)[:, -1] - np.eye(4)
        gap[:, :3, 3] /= loop.characteristic_length
        assert np.abs(gap).max() <= 1e-12


def test_the_dense_curve_and_its_points_corrected_by_newton_agree_to_1e_11(known):
    # Gauss-Newton of rank n - 1 with the pseudo-inverse. Next to a bifurcation singular
    # value n - 1 goes to zero and would turn rounding (1e-16) into a step of 1e-16 /
    # sigma: below 1e-3 that direction is left out, as it is on the curve of rank n - 2
    # at the point itself; the next test covers it with 40 digits.
    _, loop, atlas = known
    for form in atlas.forms:
        theta = form.branch.sample(10_000)
        moved = theta.copy()
        for _ in range(2):
            gap, screws, _ = closure_by_matrices(loop, moved)
            left, sigma, right = np.linalg.svd(screws)
            inverse = np.where(sigma > 1e-3, 1.0 / np.maximum(sigma, 1e-3), 0.0)
            inverse[:, loop.n - 1 :] = 0.0
            moved -= np.einsum("kji,kj,klj,kl->ki", right, inverse, left, gap)
        assert np.linalg.norm(moved - theta, axis=1).max() < 1e-11


@pytest.mark.parametrize("name", [NAMES[0], NAMES[3], NAMES[6]])
def test_beside_a_bifurcation_the_curve_agrees_with_40_digits(maps, name):
    # 1e-3 to 1e-2 from the crossing the singular value is as small: double rounding
    # allows 1e-15 / 1e-3
    _, loop, atlas = maps[name]
    point = atlas.bifurcations[0]
    for index, s in point.passes:
        for beside in (1e-3, -1e-2):
            branch = atlas.forms[index].branch
            theta, tangent = branch(s + beside), branch(s + beside, 1)
            assert (
                np.linalg.norm(_corrected_with_40_digits(loop, theta, tangent) - theta)
                < 1e-11
            )


def _corrected_with_40_digits(loop, theta, tangent):
    """Gauss-Newton across the tangent on the entries of T_1 ... T_n - I, in 40-digit
    arithmetic."""
    with mpmath.workdps(40):
        u = mpmath.matrix([mpmath.mpf(float(x)) for x in theta])
        across = mpmath.matrix([[mpmath.mpf(float(x)) for x in tangent]])
        for _ in range(5):
            entries, jacobian = _closure_with_derivative(loop, u)
            rows, n = len(entries) + 1, loop.n
            matrix, right = mpmath.matrix(rows, n), mpmath.matrix(rows, 1)
            for i in range(rows - 1):
                right[i] = -entries[i]
                for j in range(n):
                    matrix[i, j] = jacobian[j][i]
            for j in range(n):
                matrix[rows - 1, j] = across[j]
            # rank n - 1 plus the tangent: the normal equations lose half of the 40
            # digits, which is enough
            u += mpmath.lu_solve(matrix.T * matrix, matrix.T * right)
        return np.array([float(x) for x in u])


def _closure_with_derivative(loop, u):
    """The 12 entries of T_1 ... T_n - I that count and, for every joint, their
    derivatives."""
    links, turns = [], []
    for a, alpha, offset, angle in zip(*loop.arrays, u, strict=True):
        c, s = mpmath.cos(angle), mpmath.sin(angle)
        ca, sa = (
            mpmath.cos(mpmath.mpf(float(alpha))),
            mpmath.sin(mpmath.mpf(float(alpha))),
        )
        a, offset = mpmath.mpf(float(a)), mpmath.mpf(float(offset))
        links.append(
            mpmath.matrix(
                [[1, 0, 0, a], [0, ca, -sa, 0], [0, sa, ca, offset], [0, 0, 0, 1]]
            )
        )
        turns.append(
            (
                mpmath.matrix(
                    [[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
                ),
                mpmath.matrix(
                    [[-s, -c, 0, 0], [c, -s, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]]
                ),
            )
        )
    before = [mpmath.eye(4)]
    for (turn, _), link in zip(turns, links, strict=True):
        before.append(before[-1] * turn * link)
    after = mpmath.eye(4)
    derivatives = []
    for i in range(loop.n - 1, -1, -1):
        derivatives.insert(0, before[i] * turns[i][1] * links[i] * after)
        after = turns[i][0] * links[i] * after
    count = [(i, j) for i in range(3) for j in range(4)]
    closure = before[-1] - mpmath.eye(4)
    return [closure[i, j] for i, j in count], [
        [d[i, j] for i, j in count] for d in derivatives
    ]


# --- simple linkages ----------------------------------------------------------------------------------


def counts(loop):
    atlas = curves_of(loop)
    assert not any(point.note for point in atlas.points)
    assert len(atlas.points) == len(atlas.bifurcations)
    return len(atlas.forms), len(atlas.bifurcations), arc_graph(atlas).number_of_edges()


def planar(*lengths):
    return Loop(lengths, (0.0,) * 4, (0.0,) * 4)


@pytest.mark.parametrize(
    ("lengths", "expected"),
    [
        ((1.0, 2.0, 1.0, 2.0), (2, 2, 4)),  # parallelogram: parallel and crossed form
        (
            (1.0, 1.0, 1.0, 1.0),
            (3, 3, 6),
        ),  # rhombus: two forms in which two bars turn as one
        (
            (1.0, 1.0, 2.0, 2.0),
            (2, 2, 4),
        ),  # kite: the pairs of bars turn as one, or all joints turn
        ((1.0, 2.0, 2.5, 2.2), (2, 0, 2)),  # Grashof: two circuits
        ((1.5, 2.0, 2.7, 1.9), (1, 0, 1)),  # not Grashof: one circuit
        (
            (1.0, 2.0, 3.0, 2.0),
            (1, 1, 2),
        ),  # change point without symmetry: 1 + 3 = 2 + 2
    ],
)
def test_planar_four_bars_have_their_forms_bifurcations_and_arcs(lengths, expected):
    assert counts(planar(*lengths)) == expected


@pytest.mark.parametrize(
    "name", ["bennett", "bennett-ab-2", "bennett-line-symmetric", "bennett-lb-2"]
)
def test_a_bennett_linkage_has_one_form_and_no_bifurcation_in_either_set_up(name):
    assert counts(entry(name).build()) == (1, 0, 1)


def test_no_bifurcation_is_invented_on_random_bennett_linkages():
    # flat configurations come close to a bifurcation as the twists become alike: the
    # case that misleads most
    rng = np.random.default_rng(2)
    for _ in range(20):
        alpha, beta = rng.uniform(0.05, np.pi - 0.05, 2)
        loop = Loop((np.sin(alpha), np.sin(beta)) * 2, (alpha, beta) * 2, (0.0,) * 4)
        assert counts(loop)[:2] == (1, 0)


def test_no_bifurcation_is_invented_next_to_a_parallelogram():
    for error in (1e-2, 1e-4, 1e-6):
        atlas = curves_of(planar(1.0, 2.0, 1.0 + error, 2.0))
        assert not atlas.bifurcations
        # sigma at the closest approach goes as the square root of the length error
        smallest = min(event.value for event in atlas.near_misses)
        assert 0.1 * np.sqrt(error) < smallest < 2.0 * np.sqrt(error)


def test_no_near_miss_is_invented_where_the_singular_value_is_monotone_or_constant():
    right_angled = Loop((0.0,) * 4, (np.pi / 2,) * 4, (0.0,) * 4)
    for loop in (planar(1.0, 1.0, 1.0, 1.0), right_angled):
        for seed in range(3):
            atlas = curves_of(loop, seed=seed)
            assert len(atlas.points) > 2
            assert not atlas.near_misses


def test_near_misses_do_not_depend_on_the_start_of_the_curve():
    linkage = entry("yu-baker-two-ratios").build()
    for seed in range(4):
        atlas = curves_of(linkage, seed=seed)
        values = [event.value for event in atlas.near_misses]
        assert values == pytest.approx([0.0908601462117729] * 2, rel=1e-9)


# --- the general line-symmetric Bricard -----------------------------------------------------------------


def test_the_general_line_symmetric_bricard_has_the_known_near_misses(maps):
    # known to the digits printed: 0.0986 and 0.01945, translations over the mean of
    # link + offset (2.757), base at joint 1
    _, _, atlas = maps["general line-symmetric Bricard 6R"]
    smallest = [
        min(e.value for e in atlas.near_misses if e.form == i) for i in range(2)
    ]
    assert sorted(smallest) == pytest.approx([0.01944, 0.09861], abs=1e-5)
    assert [form.min_singular_value for form in atlas.forms] == pytest.approx(
        smallest, abs=1e-9
    )
    problem = Closure(maps["general line-symmetric Bricard 6R"][1])
    for form, least in zip(atlas.forms, smallest, strict=True):
        dense = np.linalg.svd(
            problem.jacobians(form.branch.sample(20_000)), compute_uv=False
        )[:, 4]
        assert (
            least <= dense.min() < 1.001 * least
        )  # nothing smaller anywhere on the curve
    assert not atlas.points


def test_the_general_line_symmetric_bricard_has_isolated_rigid_assemblies(maps):
    _, loop, atlas = maps["general line-symmetric Bricard 6R"]
    assert len(atlas.rigid) == 2
    _, screws, error = closure_by_matrices(loop, atlas.rigid)
    assert error.max() < 1e-12
    assert (
        np.linalg.svd(screws, compute_uv=False)[:, -1].min() > 1e-3
    )  # full rank: no motion, not even infinitesimal
    for form in atlas.forms:
        assert form.branch.nearest(atlas.rigid)[0].min() > 1e-2
