"""What a search over the members of a family looks at: maps, and the equations of singular
points that are solved from them with the parameters among the unknowns."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from bifurc import torus
from bifurc.atlas import Atlas
from bifurc.decisions import is_start_solved
from bifurc.following.follow import FollowedPoint, FollowError, follow_singular_point
from bifurc.following.singular_problem import SingularPointProblem
from bifurc.limits import Deadline
from bifurc.numerics.singular_values import singular_values
from bifurc.settings import SearchSettings
from linkages.labels import FormLabels
from linkages.mapping import map_linkage
from linkages.parameters.members import Members
from linkages.subject import subject_at
from linkages.values import GeometryError

NULLITY = 2  # at a crossing of two curves
PLACES = 60  # of a form, of which one is nearest to losing rank
SAMPLES = 400  # of a followed curve, by which another start on it is known


class TimeIsOver(Exception):
    """The deadline of a search has passed."""


class MapShape(NamedTuple):
    """What two maps have in common that are alike: the numbers of forms, of components, of
    bifurcations, of other singular points and of surfaces, and the joints that stand still
    in each form."""

    forms: int
    components: int
    bifurcations: int
    other_points: int
    surfaces: int
    at_rest: tuple[tuple[str, ...], ...]


class Solved(NamedTuple):
    """A singular point of some members: the ``problem`` and its solution ``point``, the
    unknowns ``u`` (n,) and the parameters ``p`` (q,)."""

    problem: SingularPointProblem
    point: np.ndarray
    u: np.ndarray
    p: np.ndarray


@dataclass
class MemberSearch:
    """The curves of singular points that were followed over the parameters of
    ``members`` so far, whose maps are made with these ``settings``."""

    members: Members
    settings: SearchSettings
    deadline: Deadline | None
    curves: list[FollowedPoint] = field(default_factory=list)

    def map_at(self, p: np.ndarray) -> Atlas | None:
        """The map of the member at ``p`` (q,); None where there is none. Raises
        `TimeIsOver`, and KeyboardInterrupt as Ctrl-C ends the search."""
        if self.deadline is not None and self.deadline.passed:
            raise TimeIsOver
        try:
            linkage = self.members.load(p)
        except GeometryError:
            return None
        atlas = map_linkage(linkage, settings=self.settings)
        if atlas.provenance.interrupted:
            raise KeyboardInterrupt
        if self.deadline is not None and self.deadline.passed:
            raise TimeIsOver  # what was found so far is not the member's map
        return atlas

    def shape(self, atlas: Atlas | None) -> MapShape | None:
        """What the map of a member is compared by; None where there is no member."""
        return None if atlas is None else shape_of(atlas, self.members.joint)

    def solve(self, u: np.ndarray, p: np.ndarray, nullity: int) -> Solved | None:
        """The singular point that is reached from a configuration (n,) of the member at
        ``p`` (q,), with parameters inside of their ranges; None where none is."""
        (start,) = self.members.in_equations(u[None], p)
        problem = SingularPointProblem(self.members.problem, start, p, nullity)
        points, gaps = problem.project(problem.start[None])
        (place,), (found,) = problem.place(points)
        low, high = self.members.problem.parameters.bounds.T
        is_within = bool(np.all((low < found) & (found < high)))
        if not (is_start_solved(float(gaps[0])) and is_within):
            return None
        return Solved(problem, points[0], place, found)

    def follow(self, solved: Solved) -> FollowedPoint | None:
        """The curve of a singular point over the parameters; None where it is known, and
        where there is no one curve."""
        if any(_runs_through(curve, solved.u, solved.p) for curve in self.curves):
            return None
        nullity, deadline = solved.problem.nullity, self.deadline
        try:
            curve = follow_singular_point(
                self.members.problem, solved.u, solved.p, nullity, deadline=deadline
            )
        except FollowError:
            return None
        self.curves.append(curve)
        return curve

    def starts(self, atlas: Atlas, closely: bool) -> Iterator[tuple[np.ndarray, int]]:
        """Configurations (n,) of a map from which singular points are looked for, with the
        dimension of the null space there; where not ``closely`` only near misses."""
        for event in atlas.near_misses:
            yield event.u, NULLITY
        if closely:
            for u in _weakest_places(atlas):
                yield u, NULLITY
            for point in atlas.points:
                yield point.point.u, self.members.problem.n - point.point.rank


def shape_of(atlas: Atlas, joint: Callable[[int], str]) -> MapShape:
    """What maps are compared by; ``joint`` names that of an unknown, by index."""
    at_rest = sorted(
        tuple(joint(number - 1) for number in FormLabels.of(form).inactive_joints)
        for form in atlas.forms
    )
    return MapShape(
        len(atlas.forms),
        atlas.components,
        len(atlas.bifurcations),
        len(atlas.points) - len(atlas.bifurcations),
        len(atlas.surfaces),
        tuple(at_rest),
    )


def _weakest_places(atlas: Atlas) -> list[np.ndarray]:
    """Configurations (n,) from which a bifurcation is looked for beside near misses: the
    place of each form that is nearest to losing rank, as on an oval that shrinks to a
    point, and one on each near motion, from which forms come."""
    places = []
    if atlas.forms:
        closure = subject_at(atlas).closure
        for form in atlas.forms:
            samples = form.branch.sample(PLACES)
            sigma = singular_values(closure, samples)[:, closure.n - NULLITY]
            places.append(samples[int(np.argmin(sigma))])
    return places + [motion.sample for motion in atlas.near_motions]


def _runs_through(curve: FollowedPoint, u: np.ndarray, p: np.ndarray) -> bool:
    """Whether a followed curve passes ``u`` (n,) at ``p`` (q,), whatever the null
    space."""
    point = np.concatenate([u, p]) / curve.problem.sizes
    samples = curve.branch.sample(SAMPLES)[:, : len(point)]
    periods = curve.problem.domain.periods[: len(point)]
    gaps = np.linalg.norm(torus.difference(samples, point, periods), axis=1)
    return bool(gaps.min() <= curve.branch.length / SAMPLES)
