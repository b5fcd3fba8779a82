"""Surfaces with known answers: those of a bank, pairs with a gap, and such as cross.

Each piece has a known Euler characteristic and area; those that cross have besides the
curves in which they do, in the words of the notes on surfaces.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.special import elliprg

from studies.curve_bank import Answer, Curve

BANK = Path(__file__).parent.parent / "data" / "surfaces.json"
GAPS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5)
NOTHING = Answer(0, 0, (), 0, 0, 0)


class Piece(NamedTuple):
    """A surface: its Euler characteristic and its ``area``, None where unknown, known to
    within an ``error``."""

    euler: int | None
    area: float | None
    error: float = 0.0


@dataclass(frozen=True)
class KnownSurface:
    """A ``system`` of equations whose solutions are ``pieces``, none where they are not
    known, with so many isolated singular ``points`` and curves besides, the ``forms``.
    Each is said to have the same curves of singular points, in the words of a
    ``note``."""

    system: Curve
    pieces: tuple[Piece, ...]
    points: int = 0
    forms: int = 0
    note: str = ""

    @property
    def name(self) -> str:
        """The name in the bank."""
        return self.system.name


def load_surfaces() -> list[KnownSurface]:
    """The surfaces of the bank."""
    return [_surface(entry) for entry in json.loads(BANK.read_text())]


def _surface(entry: dict[str, Any]) -> KnownSurface:
    n = len(entry["unknowns"])
    system = _system(
        entry["name"],
        entry["equations"],
        entry["bounds"],
        source=entry["source"],
        unknowns=tuple(entry["unknowns"]),
        periods=np.array(entry.get("periods", [np.inf] * n)),
        # those that leave the bounds are not turned
        answer=NOTHING._replace(open=int(entry["leaves_bounds"])),
    )
    pieces = tuple(Piece(*piece) for piece in entry["surfaces"])
    others = entry["points"], entry.get("forms", 0), entry.get("note", "")
    return KnownSurface(system, pieces, *others)


def _system(name: str, equations: Sequence[str], bounds: Any, **others: Any) -> Curve:
    known: dict[str, Any] = {
        "source": "closed form",
        "unknowns": ("x", "y", "z"),
        "periods": np.full(3, np.inf),
        "answer": NOTHING,
        "parameter": "",
        "events": (),
        "noise": 0.0,
    }
    bounds = np.array(bounds, dtype=float)
    return Curve(name, equations=tuple(equations), bounds=bounds, **(known | others))


# --- random pairs ---------------------------------------------------------------------


class _Shape(NamedTuple):
    """One surface of a pair: its equation, its piece, and how far it reaches."""

    equation: str
    piece: Piece
    reach: float


def pairs_with_gaps(count: int, seed: int) -> Iterator[KnownSurface]:
    """So many random pairs, each with one of the gaps in turn."""
    rng = np.random.default_rng(seed)
    kinds = (
        _side_by_side,
        _sphere_in_sphere,
        _sphere_in_ellipsoid,
        _torus_in_torus,
        _sphere_in_hole,
    )
    for number in range(count):
        gap = GAPS[number % len(GAPS)]
        kind = kinds[(number // len(GAPS) + number) % len(kinds)]
        one, other = kind(gap, rng)
        reach = max(one.reach, other.reach) * rng.uniform(1.05, 1.5, (3, 2))
        system = _system(
            f"pair {number} of seed {seed}: {kind.__name__[1:]}, gap {gap:g}",
            [f"({one.equation})*({other.equation})"],
            reach * [-1.0, 1.0],
        )
        yield KnownSurface(system, (one.piece, other.piece))


def _sphere(radius: float, center: float = 0.0) -> _Shape:
    equation = f"(x-{center!r})**2+y**2+z**2-{radius!r}**2"
    return _Shape(equation, Piece(2, 4 * np.pi * radius**2), abs(center) + radius)


def _torus(radius: float, tube: float) -> _Shape:
    ring = f"4*{radius!r}**2*(x**2+y**2)"
    equation = f"(x**2+y**2+z**2+{radius!r}**2-{tube!r}**2)**2-{ring}"
    return _Shape(equation, Piece(0, 4 * np.pi**2 * radius * tube), radius + tube)


def _ellipsoid(axes: np.ndarray) -> _Shape:
    """An ellipsoid with these half-axes (3,); its area by Carlson's integral."""
    a, b, c = (axes**2).tolist()
    equation = f"x**2/{a!r}+y**2/{b!r}+z**2/{c!r}-1"
    area = 4 * np.pi * float(elliprg(a * b, b * c, c * a))
    return _Shape(equation, Piece(2, area), float(axes.max()))


def _side_by_side(gap: float, rng: np.random.Generator) -> tuple[_Shape, _Shape]:
    axes, radius = rng.uniform(0.5, 1.2, 3), float(rng.uniform(0.3, 1.0))
    return _ellipsoid(axes), _sphere(radius, float(axes[0]) + gap + radius)


def _sphere_in_sphere(gap: float, rng: np.random.Generator) -> tuple[_Shape, _Shape]:
    radius = float(rng.uniform(0.4, 0.95))
    shift = (1.0 - radius - gap) * float(rng.choice([0.0, 1.0]))
    inner = radius if shift else 1.0 - gap
    return _sphere(1.0), _sphere(inner, shift)


def _sphere_in_ellipsoid(gap: float, rng: np.random.Generator) -> tuple[_Shape, _Shape]:
    axes = rng.uniform(0.6, 1.3, 3)
    return _ellipsoid(axes), _sphere(float(axes.min()) - gap)


def _torus_in_torus(gap: float, rng: np.random.Generator) -> tuple[_Shape, _Shape]:
    tube = float(rng.uniform(0.3, 0.7))
    return _torus(1.0, tube), _torus(1.0, tube - gap)


def _sphere_in_hole(gap: float, rng: np.random.Generator) -> tuple[_Shape, _Shape]:
    tube = float(rng.uniform(0.2, 0.6))
    return _torus(1.0, tube), _sphere(1.0 - tube - gap)


# --- surfaces that cross --------------------------------------------------------------


def crossing_surfaces(count: int, seed: int) -> Iterator[KnownSurface]:
    """So many random pairs and triples that cross, at any angle."""
    rng = np.random.default_rng(seed)
    kinds = (
        _planes_through_a_line,
        _planes_through_a_point,
        _sphere_and_plane,
        _spheres_that_cross,
        _sphere_and_cylinder,
    )
    for number in range(count):
        kind = kinds[number % len(kinds)]
        shapes, curves = kind(rng)
        reach = max(shape.reach for shape in shapes)
        name = f"crossing {number} of seed {seed}: {kind.__name__[1:]}"
        equation = "*".join(f"({shape.equation})" for shape in shapes)
        yield KnownSurface(
            _system(name, [equation], [(-reach, reach)] * 3),
            tuple(shape.piece for shape in shapes),
            note=f"singular points of rank 0 form {curves}",
        )


def _planes_through_a_line(rng: np.random.Generator) -> tuple[list[_Shape], str]:
    point = rng.uniform(-0.5, 0.5, 3)
    return [_plane(point, rng) for _ in range(2)], "1 open curve"


def _planes_through_a_point(rng: np.random.Generator) -> tuple[list[_Shape], str]:
    point = rng.uniform(-0.5, 0.5, 3)
    return [_plane(point, rng) for _ in range(3)], "2 open curves"


def _sphere_and_plane(rng: np.random.Generator) -> tuple[list[_Shape], str]:
    plane = _plane(rng.uniform(-0.4, 0.4, 3), rng)
    return [_sphere(float(rng.uniform(0.75, 0.95))), plane], "1 closed curve"


def _spheres_that_cross(rng: np.random.Generator) -> tuple[list[_Shape], str]:
    radius = float(rng.uniform(0.3, 1.2))
    apart = float(rng.uniform(abs(1.0 - radius) + 0.05, 0.95 + radius))
    pair = [_sphere(1.0), _sphere(radius, apart)]
    return [shape._replace(reach=1.1 * shape.reach) for shape in pair], "1 closed curve"


def _sphere_and_cylinder(rng: np.random.Generator) -> tuple[list[_Shape], str]:
    radius, reach = float(rng.uniform(0.2, 0.9)), 1.2
    piece = Piece(0, 2 * np.pi * radius * 2 * reach)
    cylinder = _Shape(f"x**2+y**2-{radius!r}**2", piece, reach)
    return [_sphere(1.0), cylinder], "2 closed curves"


def _plane(point: np.ndarray, rng: np.random.Generator) -> _Shape:
    """A plane through a point (3,) in the cube from -1 to 1, in a random direction."""
    normal = rng.normal(size=3)
    normal /= np.linalg.norm(normal)
    offset = float(normal @ point)
    terms = [f"{float(a)!r}*{x}" for a, x in zip(normal, "xyz", strict=True)]
    piece = Piece(1, _area_in_cube(normal, offset))
    return _Shape(f"{'+'.join(terms)}-{offset!r}", piece, 1.0)


def _area_in_cube(normal: np.ndarray, offset: float) -> float:
    """The area of normal . x = offset in the cube from -1 to 1."""
    corners = []
    for axis in range(3):
        others = [k for k in range(3) if k != axis]
        for ends in product((-1.0, 1.0), repeat=2):
            along = (offset - normal[others] @ ends) / normal[axis]
            if abs(along) <= 1.0:
                corners.append(np.insert(ends, axis, along))
    middle = np.mean(corners, axis=0)
    return _polygon_area(np.array(corners) - middle, normal)


def _polygon_area(corners: np.ndarray, normal: np.ndarray) -> float:
    """The area of a convex polygon with corners (k, 3) in any order about its middle."""
    one = corners[0] / np.linalg.norm(corners[0])
    other = np.cross(normal, one)
    order = np.argsort(np.arctan2(corners @ other, corners @ one))
    ring = corners[order]
    return 0.5 * float(np.sum(np.cross(ring, np.roll(ring, -1, axis=0)) @ normal))
