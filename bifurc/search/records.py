"""What the steps of a search hand to one another: starts, branches, points, components."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from bifurc.atlas import Surface
from bifurc.branch import Branch, Outcome
from bifurc.curves.certificate import Certificate
from bifurc.curves.monitor import Profile
from bifurc.problem import Problem
from bifurc.search.seed_book import Fate, SeedFate
from bifurc.singular.point import SingularPoint
from bifurc.surfaces.chart_atlas import ChartAtlas, Covering
from bifurc.surfaces.products import Products
from bifurc.tables import count_of

NO_DOUBT = (False, False, 0.0)
SHAKY = "F' has a lower rank all over it"
ON_CURVES = (
    "singular points are samples of curves of such points, which are not followed"
)
UNEXAMINED = "its singular points, and where forms meet it, are not looked for"
# of a component of dimension 3 and more
UNFOLLOWED = (
    "its singular points are looked for next to charts; what they form is not followed"
)
# of what lies beyond charts that ran out
BEYOND = "no walk led from it to charts: it may be a part of what they cover"
# the same where curves of singular points were reached by chance
UNEXAMINED_ELSE = "others, and where forms meet it, are not looked for"


MOST_PARTS = 12  # of sampled components of a dimension that are listed apart
JOINED = "walks over it join all starts on it"
APART = "no walk led from it to others of its dimension: some of them may be one"
IN_PARTS = "walks join {least} starts on it, and all of them in {count} parts"
FEW_STARTS = 4  # with fewer a part is not taken for a component of its own


@dataclass(frozen=True, eq=False)
class TracedBranch:
    """A branch with what was seen along it.

    ``minima`` are arclengths (k,) and values (k,) of the local minima of the smallest
    regular singular value. ``located`` are the arclengths of minima that led to a
    singular point, ``passes`` those at which the branch passes it, ``missing`` those
    where one must be and none was located. ``misclosure`` is the largest along the
    branch, ``blur`` the distance, over the scale, to which its points are known.
    ``certificate`` says what is certified of it, None where that was not asked for or
    the problem has no bounds. ``multiplicity``: 1 of an ordinary curve, 2 of one that
    one step of deflation makes regular, 0 where it is not known.
    """

    branch: Branch
    profile: Profile
    minima: tuple[np.ndarray, np.ndarray]
    located: tuple[float, ...]
    misclosure: float = 0.0
    blur: float = 0.0
    passes: tuple[float, ...] = ()
    missing: tuple[float, ...] = ()
    certificate: Certificate | None = None
    multiplicity: int = 1

    @property
    def is_refused(self) -> bool:
        """Whether there is a certificate, and it does not hold."""
        return self.certificate is not None and not self.certificate.holds

    @property
    def doubt(self) -> tuple[bool, bool, float]:
        """Whether the branch is refused a certificate, whether it stalls, and the
        arclength on which it is refused; less doubt is the smaller tuple."""
        refused = 0.0
        if self.certificate is not None and self.is_refused:
            refused = self.certificate.refused_length
        return self.is_refused, self.branch.outcome is Outcome.STALLED, refused


class PointSighting(NamedTuple):
    """A singular point that was looked at, its number, and whether it is new."""

    point: SingularPoint
    number: int
    is_new: bool

    @property
    def fate(self) -> SeedFate:
        """That of a seed there."""
        return SeedFate(Fate.AT_SINGULAR_POINT, self.number)


class RigidAssembly(NamedTuple):
    """An isolated solution at a ``place`` (n,). It, or several, lie ``hidden`` by
    rounding up to so far from there."""

    place: np.ndarray
    hidden: float


class Start(NamedTuple):
    """A solution (n,) to trace a branch from, first to the side of ``direction`` (n,)
    where there is one."""

    point: np.ndarray
    direction: np.ndarray | None = None


def half_branch_starts(point: SingularPoint) -> list[Start]:
    """Starts on all half-branches of a singular point, a little off it."""
    directions = point.half_branches
    return [Start(point.u + point.radius * along, along) for along in directions]


class SingularCurve(NamedTuple):
    """A ``branch`` all along which F' has a ``rank``."""

    branch: Branch
    rank: int


def describe_curves(curves: Sequence[SingularCurve]) -> str:
    """How many of them there are of every rank, empty where there is none."""
    kinds = Counter((curve.rank, curve.branch.closed) for curve in curves)
    parts = []
    for (rank, closed), count in sorted(kinds.items()):
        noun = "closed curve" if closed else "open curve"
        parts.append(f"singular points of rank {rank} form {count_of(count, noun)}")
    return "; ".join(parts)


@dataclass
class PartNotes:
    """What is known of the singular points of surfaces, by the numbers of parts of the
    charts, -1 where there are none: the ``curves`` that they form, the parts on which
    each listed one lies that is a sample of a curve that could not be followed, and at
    how many ``places`` none were looked for."""

    curves: dict[int, list[SingularCurve]] = field(default_factory=dict)
    unfollowed: list[list[int]] = field(default_factory=list)
    places: Counter[int] = field(default_factory=Counter)

    def all_curves(self) -> list[SingularCurve]:
        """Each curve once."""
        return list({id(c): c for own in self.curves.values() for c in own}.values())

    def is_beside_curve(self, place: np.ndarray, within: float) -> bool:
        """Whether a known curve passes a place (n,) so near."""
        curves = self.all_curves()
        return any(c.branch.nearest(place, within)[0][0] < within for c in curves)

    def add_curve(self, curve: SingularCurve, parts: Sequence[int]) -> bool:
        """Whether a curve, on these ``parts``, is recorded just now on all of them."""
        is_new = False
        for part in parts:
            known = self.curves.setdefault(part, [])
            if curve not in known:
                known.append(curve)
                is_new = True
        return is_new

    def of(self, part: int) -> list[str]:
        """What is known of a part."""
        words = [describe_curves(self.curves.get(part, []))]
        samples = sum(part in parts for parts in self.unfollowed)
        if samples:
            words.append(f"{samples} of its {ON_CURVES}")
        if self.places[part]:
            count = self.places[part]
            words.append(f"at {count} places singular points were not looked for")
        return list(filter(None, words))


def _remark_on_parts(sizes: np.ndarray) -> str:
    """Whether walks join the starts on a component, which are in parts of these sizes
    (k,); nothing where there were no walks."""
    if not len(sizes):
        return ""
    if len(sizes) == 1:
        return JOINED
    return IN_PARTS.format(count=len(sizes), least=int(sizes.max()))


class _ChartedPart(NamedTuple):
    """A part of the charts, by its ``number``, and which of the products it lies on, by
    its index."""

    number: int
    charts: ChartAtlas
    product: int | None


@dataclass
class Components:
    """Numbers of the seeds on components of dimension 2 and more, and charts over these,
    by dimension. The seeds ``on_shaky`` surfaces, on which F' has a lower
    rank everywhere, are apart where one deflation does not make them regular: charts do
    not fit there.

    Parts of the charts that do not hang together are surfaces of their own: each but
    the last was finished, as far as its singular points, before the next was begun.
    ``part_of`` (k,) is the part that each seed belongs to, -1 where none is known. The
    ``notes`` say what is known of the parts. ``deflated`` is the problem
    with which surfaces are corrected to along which F' has a lower rank; seeds of
    dimension 2 lie on such surfaces then. Components that are ``products``, by
    dimension, are known without charts: all parts that lie on one of them are one.
    Seeds of components without charts are in parts that are ``joined``, by dimension:
    their numbers (k,), -1 where that is not known.
    """

    seeds: dict[int, list[int]] = field(default_factory=dict)
    on_shaky: list[int] = field(default_factory=list)
    charts: dict[int, ChartAtlas] = field(default_factory=dict)
    part_of: dict[int, np.ndarray] = field(default_factory=dict)
    notes: dict[int, PartNotes] = field(default_factory=lambda: defaultdict(PartNotes))
    deflated: Problem | None = None
    products: dict[int, Products] = field(default_factory=dict)
    joined: dict[int, np.ndarray] = field(default_factory=dict)

    @property
    def has_surfaces(self) -> bool:
        """Whether surfaces are known of which singular points may be known."""
        return 2 in self.charts or self.deflated is not None

    @property
    def is_out_of_time(self) -> bool:
        """Whether components are not covered, as that took too long."""
        outcomes = [charts.outcome for charts in self.charts.values()]
        return Covering.OUT_OF_TIME in outcomes

    def samples(self, points: np.ndarray, dimension: int) -> np.ndarray:
        """The seeds (k, n) of a dimension, as exact as can be known."""
        samples = points[self.seeds.get(dimension, [])]
        if self.deflated is None or dimension != 2 or not len(samples):
            return samples
        return self.deflated.project(samples)[0]

    def _note_of(self, dimension: int, part: int) -> str:
        """What is known of a part of the charts; -1: of seeds without charts."""
        words = self.notes[dimension].of(part)
        if dimension > 2 and part >= 0:
            words.append(UNFOLLOWED)
        if self.deflated is None or dimension > 2:
            return "; ".join(words)
        unexamined = [UNEXAMINED_ELSE if words else UNEXAMINED] * (part >= 0)
        return "; ".join([SHAKY, *words, *unexamined])

    @property
    def off_charts(self) -> int:
        """How many seeds lie on none of the charts of their dimension, nor are joined to
        any, although all components on which charts fit are covered."""
        count = 0
        for dimension, charts in self.charts.items():
            if charts.is_finished:
                is_off = self.part_of[dimension] < 0
                is_off &= ~self.are_on_products(dimension)
                count += int(np.count_nonzero(is_off))
        return count

    def are_on_products(self, dimension: int) -> np.ndarray:
        """Which seeds (k,) of a dimension lie on products."""
        if dimension not in self.products:
            return np.zeros(len(self.seeds.get(dimension, [])), dtype=bool)
        return self.products[dimension].of_sample >= 0

    def surfaces(self, points: np.ndarray) -> tuple[Surface, ...]:
        """Products, other connected surfaces as far as there are charts, then what none
        of them is known to hold, by dimension; seeds `off_charts` show no surface."""
        surfaces: list[Surface] = []
        if self.on_shaky:
            surfaces.append(Surface(2, points[self.on_shaky], note=SHAKY))
        for dimension in sorted(self.seeds):
            samples = self.samples(points, dimension)
            is_left = ~self.are_on_products(dimension)
            parts = self._charted_parts(dimension)
            surfaces += self._product_surfaces(samples, dimension, parts)
            if dimension in self.charts:
                surfaces += self._charted_surfaces(samples, dimension, parts)
                is_finished = self.charts[dimension].is_finished
                is_left &= (self.part_of[dimension] < 0) & (not is_finished)
            surfaces += self._sampled_surfaces(samples, dimension, is_left)
        return tuple(surfaces)

    def _sampled_surfaces(
        self, samples: np.ndarray, dimension: int, is_left: np.ndarray
    ) -> list[Surface]:
        """What those of the samples (k, n) show that are left, on nothing that is known:
        a surface for each part in which they are joined, unless there are many."""
        note = self._note_of(dimension, -1)
        if dimension in self.charts:
            note = "; ".join(filter(None, [note, BEYOND]))
        unknown = np.full(len(samples), -1)
        parts = self.joined.get(dimension, unknown)[is_left]
        samples = samples[is_left]
        if not len(samples):
            return []
        known = parts[parts >= 0]
        numbers, sizes = np.unique(known, return_counts=True)
        large = numbers[sizes >= FEW_STARTS]
        if not 1 < len(large) <= MOST_PARTS:
            words = "; ".join(filter(None, [note, _remark_on_parts(sizes)]))
            return [Surface(dimension, samples, note=words)]
        # singular samples may lie between parts, and a few are no part of their own
        largest = numbers[np.argmax(sizes)]
        parts = np.where(np.isin(parts, large), parts, largest)
        words = "; ".join(filter(None, [note, APART]))
        return [
            Surface(dimension, samples[parts == part], note=words) for part in large
        ]

    def _charted_parts(self, dimension: int) -> list[_ChartedPart]:
        """The parts of the charts, the one with most charts first."""
        products = []
        if dimension in self.products:
            products = self.products[dimension].components
        parts = self.charts[dimension].parts() if dimension in self.charts else ()
        charted = []
        for number, part in enumerate(parts):
            place = part.centers[:1]
            on = (k for k, product in enumerate(products) if product.holds(place)[0])
            charted.append(_ChartedPart(number, part, next(on, None)))
        return charted

    def _product_surfaces(
        self, samples: np.ndarray, dimension: int, parts: Sequence[_ChartedPart]
    ) -> list[Surface]:
        """The products of a dimension, with those of the samples (k, n) on them, and the
        charts that cover most of them."""
        if dimension not in self.products:
            return []
        components, of_sample = self.products[dimension]
        surfaces = []
        for number, product in enumerate(components):
            on_it = samples[of_sample == number]
            own = [part for part in parts if part.product == number]
            notes = dict.fromkeys(self._note_of(dimension, part.number) for part in own)
            surface = Surface(
                dimension,
                on_it if len(on_it) else product.point[None],
                charts=own[0].charts if own else None,
                note="; ".join(filter(None, notes)),
                factors=product.factors,
            )
            surfaces.append(surface)
        return surfaces

    def _charted_surfaces(
        self, samples: np.ndarray, dimension: int, parts: Sequence[_ChartedPart]
    ) -> list[Surface]:
        """The surfaces that charts cover, with those of the samples (k, n) on them, but
        for products."""
        surfaces = []
        for k, charts, product in parts:
            if product is not None:
                continue
            on_part = samples[self.part_of[dimension] == k]
            if not len(on_part):
                on_part = charts.centers[:1]
            note = self._note_of(dimension, k)
            surfaces.append(Surface(dimension, on_part, charts=charts, note=note))
        return surfaces
