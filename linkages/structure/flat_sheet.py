"""Which creases of a sheet stay flat about its flat state, each of them folding one way.

About an inner vertex with creases along unit vectors d_k of the plane, in order, small
fold angles u_k solve

    sum of u_k d_k = 0,        sum over i < j of u_i u_j (d_i x d_j) = 0

to leading order (Watanabe and Kawaguchi 2009; Tachi and Hull 2017). Where no angles with
the signs of the assignment do, all creases of the vertex stay flat: a curve of folded
states would have such a leading term. Angles of the right signs that solve the first are
sums of those of two creases along a line or of three (a vertex and its bird's foot:
Abel and others 2016). Where the second is zero for two along a line alone, which fold by
themselves by equal angles, the others stay flat: turned about the line, what it takes to
fold them would be of one sign. A crease that stays flat at one end is none at the other,
so that a whole sheet is looked at from vertex to vertex.

Farther away from the flat state such creases may open.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np

from bifurc.singular.prestress import positive_combination
from linkages.decisions import is_at_limit, is_no_fold, lies_in_plane
from linkages.mechanisms.mechanism import Variable

FREE = 0  # the sign of a crease that folds either way
DIGITS = 9  # to which angles that are the same agree


class FlatVertex(NamedTuple):
    """The creases about an inner vertex of a flat sheet, in order: the numbers of their
    ``variables`` (d,) and their ``directions`` (d, 2) in the plane, with the sense in
    which they fold."""

    variables: tuple[int, ...]
    directions: np.ndarray

    def without(self, flat: Collection[int]) -> FlatVertex:
        """What is left of it without variables, by number, that stay 0."""
        left = np.array([number not in flat for number in self.variables])
        numbers = tuple(np.array(self.variables)[left].tolist())
        return FlatVertex(numbers, self.directions[left])


def flat_vertex(
    variables: Sequence[Variable], steps: Sequence[tuple[int, int]]
) -> FlatVertex | None:
    """The vertex of a chain about a point of ``steps`` across variables, by number, each
    with its sense; None where the axes do not lie in a plane, or one is locked or
    coupled."""
    about = [variables[number] for number, _ in steps]
    are_free = [
        one.locked is None and one.leader.number == number
        for (number, _), one in zip(steps, about, strict=True)
    ]
    axes = np.array([variable.motion.direction for variable in about])
    if not all(are_free):
        return None
    _, sizes, plane = np.linalg.svd(axes)
    if len(sizes) > 2 and not lies_in_plane(float(sizes[2])):
        return None
    numbers, senses = zip(*steps, strict=True)
    return FlatVertex(numbers, np.array(senses)[:, None] * axes @ plane[:2].T)


def creases_that_stay_flat(
    variables: Sequence[Variable], vertices: Sequence[FlatVertex]
) -> tuple[str, ...]:
    """The labels of the ``variables`` that stay 0 about the flat state of a sheet with
    these inner ``vertices``, as their limits let them fold one way."""
    flat: set[int] = set()
    signs = {
        number: sign_of(variables[number])
        for vertex in vertices
        for number in vertex.variables
    }
    waiting = list(range(len(vertices)))
    while waiting:
        vertex = vertices[waiting.pop()].without(flat)
        own = np.array([signs[number] for number in vertex.variables])
        can_fold = creases_that_fold(vertex.directions, own)
        changed = set(np.array(vertex.variables, dtype=int)[~can_fold].tolist())
        flat |= changed
        if not changed and len(own) == 2:
            changed = _signed_along(vertex, signs)
        waiting += [
            k for k, other in enumerate(vertices) if changed & {*other.variables}
        ]
    return tuple(variables[number].label for number in sorted(flat))


def _signed_along(vertex: FlatVertex, signs: dict[int, int]) -> set[int]:
    """The creases, by number, that get a sign as they fold by the same angle as another
    one in a line, which has one: about no more of them nothing else folds."""
    first, second = vertex.variables
    sense = -round(float(vertex.directions[0] @ vertex.directions[1]))
    changed = set()
    for one, other in ((first, second), (second, first)):
        if signs[one] == FREE and signs[other] != FREE:
            signs[one] = sense * signs[other]
            changed.add(one)
    return changed


def sign_of(variable: Variable) -> int:
    """The sign of a variable that its limits keep from 0 on, `FREE` where they do not."""
    low, high = variable.limits or (-np.inf, np.inf)
    return int(is_at_limit(abs(low))) - int(is_at_limit(abs(high)))


def creases_that_fold(directions: np.ndarray, signs: np.ndarray) -> np.ndarray:
    """Which of the creases about a flat vertex (d,), in order along unit vectors (d, 2),
    leave the flat state in some motion, each in the sense of its sign; of degenerate
    vertices more may be told so."""
    rays = _extreme_rays(directions, signs)
    forms = forms_of(directions, rays, rays)
    can_fold = np.zeros(len(signs), dtype=bool)
    if not len(rays) or (forms.min() < 0.0 < forms.max()):
        is_open = len(rays) and not _is_of_one_sense(directions, signs)
        return np.asarray((rays != 0.0).any(axis=0)) if is_open else can_fold
    for ray in rays[np.diag(forms) == 0.0]:
        if not _holds_others(directions, signs, ray):
            return np.ones(len(signs), dtype=bool)
        can_fold |= ray != 0.0
    return can_fold


def _is_of_one_sense(directions: np.ndarray, signs: np.ndarray) -> bool:
    """Whether the form of second order is shown to have one sense, and not to be 0, for
    all angles of the signs (d,) that the first order lets be."""
    _, _, right = np.linalg.svd(directions.T)
    basis = right[2:]
    form = forms_of(directions, basis, basis)
    rates = (signs * basis).T  # into the region
    products = [np.outer(one, other) for one, other in combinations(rates, 2)]
    inside = np.array([0.5 * (product + product.T) for product in products])
    weights, _ = positive_combination(form[None], inside)
    return weights is not None


def _holds_others(directions: np.ndarray, signs: np.ndarray, line: np.ndarray) -> bool:
    """Whether two creases that fold along a ``line`` (d,) keep the others from folding.

    Where the line is folded by an angle t, angles u of the others and what these add to
    those along the line have a form 2 t B(line, u) + B(u, u) + smaller terms, B that of
    second order: none is linear in u but the first. Both are of one ``sense``, and not 0
    together.
    """
    is_along = line != 0.0
    if np.count_nonzero(is_along) != 2:
        return False
    rays = _extreme_rays(directions, np.where(is_along, FREE, signs))
    rays = rays[(rays != 0.0)[:, ~is_along].any(axis=1)]
    with_line = forms_of(directions, line[None], rays)[0]
    beside = rays[with_line == 0.0]
    own = forms_of(directions, beside, beside)
    forms = np.concatenate([with_line, own.ravel()])
    is_of_one_sense = (forms >= 0.0).all() or (forms <= 0.0).all()
    return bool(is_of_one_sense and np.diag(own).all())


def _extreme_rays(directions: np.ndarray, signs: np.ndarray) -> np.ndarray:
    """The angles (r, d), the largest 1, of which all those of the ``signs`` (d,) with
    sum of u_k d_k = 0 are sums: of two creases along a line, and of three others."""
    angles = _of_three(directions) if len(signs) > 2 else _of_two(directions)
    sizes = np.abs(angles).max(axis=1, initial=0.0)
    is_some = ~is_no_fold(sizes)
    angles = angles[is_some] / sizes[is_some, None]
    angles[is_no_fold(np.abs(angles))] = 0.0
    angles = np.concatenate([angles, -angles])
    are_right = np.all((signs == FREE) | (signs * angles >= 0.0), axis=1)
    _, first = np.unique(angles[are_right].round(DIGITS), axis=0, return_index=True)
    rays: np.ndarray = angles[are_right][first]
    return rays


def _of_three(directions: np.ndarray) -> np.ndarray:
    """Angles (r, d) of every three creases whose sum of u_k d_k is 0."""
    count = len(directions)
    chosen = np.array(list(combinations(range(count), 3)))
    products = products_of(directions)
    angles = np.zeros((len(chosen), count))
    for own, second, third in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        sines = products[chosen[:, second], chosen[:, third]]
        angles[np.arange(len(chosen)), chosen[:, own]] = sines
    return angles


def _of_two(directions: np.ndarray) -> np.ndarray:
    """The same (r, d) of two creases or less: none, if they do not lie along a line."""
    if len(directions) < 2 or not is_no_fold(abs(float(products_of(directions)[0, 1]))):
        return np.empty((0, len(directions)))
    return np.array([[1.0, -directions[0] @ directions[1]]])


def products_of(directions: np.ndarray) -> np.ndarray:
    """The determinants (d, d) of every two unit vectors (d, 2)."""
    x, y = directions.T
    return np.asarray(x[:, None] * y - y[:, None] * x)


def forms_of(directions: np.ndarray, one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Half the mixed form (r, s) of second order at angles (r, d) and (s, d); 0 where it
    is rounding."""
    products = np.triu(products_of(directions), 1)
    forms: np.ndarray = one @ (products + products.T) @ other.T
    return np.where(is_no_fold(np.abs(forms)), 0.0, forms)
