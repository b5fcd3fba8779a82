"""One sentence on what the solutions of a system are."""

from __future__ import annotations

from collections.abc import Sequence

from bifurc.atlas import Atlas, Surface, samples_beyond_charts
from bifurc.completeness import Level
from bifurc.decisions import closes_to_rounding
from bifurc.search.answer.completeness import SearchDoubt
from bifurc.singular.point import Kind
from bifurc.surfaces.factor import words_of_products
from bifurc.tables import count_of


def verdict_of(atlas: Atlas) -> str:
    """What there is: curves, surfaces, isolated solutions, or nothing; an interrupted
    search is said to be one."""
    if atlas.provenance.interrupted:
        return f"The search was interrupted; by then it had found {_counts(atlas)}."
    if atlas.forms or atlas.surfaces:
        return f"The solutions are {_counts(atlas)}.{remark_on_charts(atlas)}"
    if atlas.completeness.level is Level.OUT_OF_TIME:
        seconds = atlas.provenance.settings.budget
        return (
            f"The search ended after {seconds:.4g} s, before it found a curve; whether "
            "there is one is not known."
        )
    if atlas.near_motions:
        near = atlas.near_motions[0]
        return (
            "There is no curve of solutions, but the equations are nearly solved along "
            f"one: they are missed by {near.misclosure:.3g} of their magnitude at most."
        )
    if has_only_open_points(atlas):
        count = count_of(len(atlas.points), "singular point")
        return (
            f"No curve was found, but {count}; whether one leaves there is not known."
        )
    isolated = sum(point.kind is Kind.ISOLATED for point in atlas.points)
    isolated += len(atlas.rigid)
    if isolated:
        count = count_of(isolated, "isolated solution")
        return f"There is no curve of solutions, but {count}."
    if closes_to_rounding(atlas.closure_gap):
        return "There is no solution within the bounds; starts reach some outside."
    return (
        "There is no solution within the bounds: the equations are missed by "
        f"{atlas.closure_gap:.3g} of their magnitude at the median start."
    )


def words_of_components(surfaces: Sequence[Surface]) -> str:
    """What components, as far as all are of one kind, are: products, or of dimension 3
    and more and covered by charts; empty where they are neither."""
    products = words_of_products([surface.factors for surface in surfaces])
    others = [surface.charts for surface in surfaces if not surface.factors]
    counts = [len(charts) for charts in others if charts is not None]
    are_covered = counts and all(
        charts is not None and charts.is_finished and charts.dimension > 2
        for charts in others
    )
    if products or not are_covered:
        return products
    return f"covered by {count_of(sum(counts), 'chart')}"


def remark_on_charts(atlas: Atlas) -> str:
    """What to add where charts ran out before surfaces were covered."""
    if not any(surface.is_short_of_charts for surface in atlas.surfaces):
        return ""
    starts = count_of(samples_beyond_charts(atlas.surfaces), "start")
    return f" Charts ran out: {starts} on surfaces lie beyond them."


def has_only_open_points(atlas: Atlas) -> bool:
    """Whether all that was found are singular points, none of which is known to be
    isolated: what leaves them is not known."""
    found = len(atlas.forms) + len(atlas.surfaces) + len(atlas.near_motions)
    found += len(atlas.rigid)
    corners = {
        name
        for doubt in atlas.completeness.doubts
        if doubt.kind == SearchDoubt.OPEN_CORNERS.name
        for name in doubt.data["points"]
    }
    are_open = [
        point.kind is not Kind.ISOLATED or point.name in corners
        for point in atlas.points
    ]
    return not found and bool(are_open) and all(are_open)


def _counts(atlas: Atlas) -> str:
    forms = count_of(len(atlas.forms), "form")
    components = count_of(atlas.components, "component")
    bifurcations = count_of(len(atlas.bifurcations), "bifurcation")
    words = f"{forms} in {components}, {bifurcations}"
    if atlas.surfaces:
        words += f", {count_of(len(atlas.surfaces), 'surface')}"
        components = words_of_components(atlas.surfaces)
        words += components and f", {components}"
    return words
