"""Singular points enclosed, and the spheres about them on which half-branches are
counted, each as large as the check allows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from flint import arb, arb_poly
from scipy.optimize import brentq

from bifurc.atlas import MeetingPoint
from bifurc.limits import is_time_over
from linkages.rigorous import check
from linkages.rigorous.check import DoesNotHold, arb_vector
from linkages.rigorous.courses import Course, Pass
from linkages.rigorous.refinement import refined_piece
from linkages.rigorous.selection import best_rows, floats_of

NEAR = 1e-8  # a refined point to that of the map, in rad: farther off it is another one
DIGITS = 36  # of the centre
ALONE = 2.0 ** -np.arange(3, 30)  # about a point, the largest first
RADII = 2.0 ** -np.arange(3, 26)  # of spheres, the largest first
OPENINGS = 2.0 ** -np.arange(0, 20)  # of sectors, in radii of their sphere
SLACK = 1.01
SMALL = 1e-3  # radius, at which curves are taken in more digits
SHORT = 0.05  # piece of these, in radii
NEWTON_STEPS = 6
TRIES = 30  # combinations of equations, of which the most regular is taken


# --- the point ------------------------------------------------------------------------


def enclosed_point(loop: check.Loop, meeting: MeetingPoint) -> check.Json:
    """A singular point as it stands in a certificate; raises `DoesNotHold` where it is
    not enclosed."""
    start = _start(loop, meeting)
    point = _refined(loop, start)
    away = max(
        abs(float(x - y)) for x, y in zip(point.centre, start.centre, strict=True)
    )
    check.require(away <= NEAR, f"the point that is enclosed is {away:.1e} beside it")
    values = {
        "name": meeting.name,
        "kind": meeting.kind.value,
        "centre": _texts(point.centre),
        "null": [_texts(vector) for vector in point.null],
        "range": [_texts(vector) for vector in point.range],
        "rows": list(point.rows),
        "extra": _texts(point.extra),
    }
    enclosure = _alone(loop, check.point_of(values))
    values["alone"] = float(enclosure.alone).hex()
    values["within"] = claim(enclosure.radius)
    return values


def claim(bound: arb) -> str:
    """A bound as it is claimed, a little larger: a check rounds as it likes."""
    return (float(bound) * SLACK).hex()


def _texts(vector: check.Vector) -> list[str]:
    return [x.str(DIGITS, radius=False) for x in vector]


def _start(loop: check.Loop, meeting: MeetingPoint) -> check.Point:
    """A singular point in doubles, with the equations that determine it."""
    null = meeting.point.null_space
    n, k = null.shape
    complement = np.linalg.svd(null.T)[2][k:]
    at_point = loop.at(arb_vector(meeting.point.u))
    jacobian = floats_of(at_point.jacobian)
    rows = best_rows(jacobian @ complement.T, np.empty((0, n - k)))
    extra = _regular_combination(at_point, jacobian, null)
    return check.Point(
        arb_vector(meeting.point.u),
        [arb_vector(vector) for vector in null.T],
        [arb_vector(vector) for vector in complement],
        rows,
        arb_vector(extra),
    )


def _regular_combination(
    at_point: check.Derivatives, jacobian: np.ndarray, null: np.ndarray
) -> np.ndarray:
    """The combination (6,) of equations, among some whose derivative vanishes at a
    singular point, that bends most evenly over the null space (n, k)."""
    n, k = null.shape
    left = np.linalg.svd(jacobian)[0][:, n - k :]  # (6, 6 - n + k)
    bends = [floats_of(at_point.second(arb_vector(v))) @ null for v in null.T]
    forms = np.einsum("jmi,ml->lij", np.array(bends), left)
    draws = np.random.default_rng(0).standard_normal((TRIES, left.shape[1]))
    draws /= np.linalg.norm(draws, axis=1)[:, None]
    mixed = np.einsum("tl,lij->tij", draws, forms)
    regular = np.linalg.svd(mixed, compute_uv=False)[:, -1]
    combination: np.ndarray = left @ draws[np.argmax(regular)]
    return combination


def _refined(loop: check.Loop, point: check.Point) -> check.Point:
    """The same singular point in many digits, by Newton's method."""
    n = loop.n
    for _ in range(NEWTON_STEPS):
        equations = check.augmented(loop, point, arb(0))
        inverse = check.approximate_inverse(equations.matrix)
        step = (inverse * equations.values).entries()
        centre = _moved(point.centre, step[:n])
        null = [
            _moved(vector, step[n * j : n * (j + 1)])
            for j, vector in enumerate(point.null, start=1)
        ]
        point = check.Point(centre, null, point.range, point.rows, point.extra)
    return point


def _moved(u: check.Vector, step: check.Vector) -> check.Vector:
    return [(x - dx).mid() for x, dx in zip(u, step, strict=True)]


def _alone(loop: check.Loop, point: check.Point) -> check.Enclosure:
    """A point enclosed, with about the largest radius within which it is the only one of
    its kind; raises `DoesNotHold`."""
    last = DoesNotHold("")
    for radius in ALONE.tolist():
        try:
            return check.enclose(loop, point, arb(radius))
        except DoesNotHold as reason:
            last = reason
    raise last


# --- the sphere -----------------------------------------------------------------------


def counted_half_branches(
    loop: check.Loop, values: check.Json, passes: Sequence[tuple[int, Course, Pass]]
) -> check.Json:
    """The largest sphere about a point of a certificate on which the half-branches of the
    curves that pass it, by their indices, are all that there are; raises
    `DoesNotHold`."""
    point = check.point_of(values)
    last = DoesNotHold("the time was over")
    for radius in RADII.tolist():
        if is_time_over():
            break
        try:
            sphere = check.Sphere(loop, point, arb(radius))
            half_branches = _half_branches(sphere, passes)
            sectors = [one.pop("proved") for one in half_branches]
            check.require(check.are_disjoint(sectors), "two sectors overlap")
            sphere.require_no_other(sectors)
        except DoesNotHold as reason:
            last = reason
        else:
            return {"sphere": radius.hex(), "half_branches": half_branches}
    raise last


def _half_branches(
    sphere: check.Sphere, passes: Sequence[tuple[int, Course, Pass]]
) -> list[check.Json]:
    """Where the curves cross a sphere, each in its sector."""
    half_branches = []
    for number, course, one in passes:
        for side in (-1, 1):
            if 0.0 <= one.s + side * float(sphere.radius) <= course.branch.length:
                crossing = _crossing(sphere, course, one, side)
                half_branches.append({"curve": number, **crossing})
    return half_branches


def _crossing(sphere: check.Sphere, course: Course, one: Pass, side: int) -> check.Json:
    """A half-branch: where a curve crosses the sphere, and its sector."""
    radius = float(sphere.radius)
    centre = np.array([float(x) for x in sphere.point.centre])
    centre += 2 * np.pi * one.turns

    def height(distance: float) -> float:
        step = course.branch(one.s + side * distance) - centre
        return float(np.linalg.norm(step)) - radius

    leaves_at_once = height(radius / 2) < 0 < height(2 * radius)
    check.require(leaves_at_once, "a curve does not leave the sphere at once")
    s = one.s + side * brentq(height, radius / 2, 2 * radius)
    piece, x = course.piece_at(s)
    if radius < SMALL:
        piece, x = refined_piece(sphere.loop, course, s, SHORT * radius), 0.0
    turns = check.whole_turns(one.turns.tolist())
    text = _text_on_sphere(sphere, course.polynomials[piece], turns, arb(x))
    lifted = course.point(piece, check.number(text))
    half_branch = {"piece": piece, "x": text, "s": s, "turns": one.turns.tolist()}
    return {**half_branch, **_sector(sphere, lifted, turns)}


def _text_on_sphere(
    sphere: check.Sphere, polynomial: list[arb_poly], turns: check.Vector, x: arb
) -> str:
    """The coordinate near x at which a piece crosses the sphere, in many digits."""
    away = [
        angle - turn - middle
        for angle, turn, middle in zip(
            polynomial, turns, sphere.point.centre, strict=True
        )
    ]
    height = sum((angle * angle for angle in away), arb_poly([0])) - sphere.radius**2
    for _ in range(NEWTON_STEPS):
        x = (x - height(x) / height.derivative()(x)).mid()
    return x.str(DIGITS, radius=False)


def _sector(
    sphere: check.Sphere, lifted: check.Vector, turns: check.Vector
) -> check.Json:
    """The widest sector about a place, of a curve that is whole turns away, in which
    there is one solution; the solution there on the curve."""
    place = [p - t for p, t in zip(lifted, turns, strict=True)]
    coordinates = [x.mid() for x in sphere.coordinates_of(place)]
    every_row = list(range(check.EQUATIONS))
    jacobian = floats_of(sphere.derivative(coordinates, every_row))
    rows = best_rows(jacobian[:-1], jacobian[-1:])
    last = DoesNotHold("")
    for opening in OPENINGS.tolist():
        half = opening * float(sphere.radius)
        middle = coordinates[: sphere.point.nullity]
        texts = [f"[{float(x)!r} +/- {half!r}]" for x in middle]
        sector = check.Sector(check.numbers(texts), rows, place)
        try:
            solution = sphere.solution_in(sector)
        except DoesNotHold as reason:
            last = reason
        else:
            exit_place = [u + t for u, t in zip(solution, turns, strict=True)]
            proved = {"proved": sector, "solution": exit_place}
            return {"sector": texts, "rows": rows, **proved}
    raise last
