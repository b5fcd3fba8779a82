"""The summary of an atlas of equations: tables of what was found, in the units of the
unknowns."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain

import numpy as np

from bifurc.atlas import Atlas, Form, MeetingPoint
from bifurc.branch import Branch, Outcome
from bifurc.diagrams.diagram import Diagram
from bifurc.singular.point import Kind
from bifurc.surfaces.factor import describe_product
from bifurc.systems.verdict import verdict_of
from bifurc.tables import distinct_heads, section

SHOWN = 40  # rows of a table; the others are counted
FEW = 64  # unknowns of which all are columns of a table
SOME = 6  # of more that are, from the first to the last
NONE = "-"


def make_summary(atlas: Atlas) -> str:
    """What `bifurc solve` shows: verdict, equations, forms, points, completeness."""
    completeness = atlas.completeness
    provenance = atlas.provenance
    parts = [
        f"{atlas.subject.get('name', 'equations')}\n{verdict_of(atlas)}",
        _equations(atlas),
        _forms(atlas),
        _rims(atlas),
        _surfaces(atlas),
        _points(atlas),
        *_along_parameter(atlas),
        _near_misses(atlas),
        _isolated(atlas),
        f"Completeness ({completeness.level}): {completeness.statement}.",
        f"Explored in {provenance.seconds:.3f} s, seed {provenance.seed}.",
    ]
    return "\n\n".join(part for part in parts if part)


def _equations(atlas: Atlas) -> str:
    equations = atlas.subject.get("equations", {})
    rows = [(name, text) for name, text in equations.items()]
    most = None if len(atlas.names) <= FEW else SHOWN
    text = section("Equations", ("name", "equation"), rows, most)
    values = atlas.subject.get("parameters", {})
    if values:
        shown = ", ".join(f"{name} = {value:.15g}" for name, value in values.items())
        text += f"\n  with {shown}"
    return text


def _heads(atlas: Atlas, others: Sequence[str]) -> list[str]:
    """Names of the unknowns with their units, told apart from the ``others``, which are
    the program's."""
    columns = [(atlas.names[k], atlas.units[k]) for k in _columns(atlas)]
    heads = [f"{name} ({unit})" if unit else name for name, unit in columns]
    return distinct_heads(heads, others)


def _columns(atlas: Atlas) -> list[int]:
    """The numbers of the unknowns that are columns of a table: all, or of many the
    parameter and some."""
    count = len(atlas.names)
    if count <= FEW:
        return list(range(count))
    some = set(np.linspace(0, count - 1, SOME).round().astype(int).tolist())
    if atlas.diagram is not None and atlas.diagram.parameter:
        some.add(list(atlas.names).index(atlas.diagram.parameter))
    return sorted(some)


def _values(atlas: Atlas, point: np.ndarray) -> list[str]:
    """The unknowns of a point (n,) that are columns, as `_numbers`."""
    return _numbers(point[_columns(atlas)])


def _numbers(point: np.ndarray, size: float = 1.0) -> list[str]:
    """The unknowns to ten digits, what is rounding as 0."""
    rounding = 1e-14 * max(size, float(np.abs(point).max(initial=0.0)))
    return [f"{0.0 if abs(x) < rounding else x:.10g}" for x in point]


# --- forms ----------------------------------------------------------------------------


def _forms(atlas: Atlas) -> str:
    is_periodic = bool(np.any(np.isfinite(atlas.periods)))
    heads = ["name", "length", "end", "smallest s.v.", "residual"]
    if is_periodic:
        heads.insert(3, "winding")
    rows = [_form_row(form, is_periodic) for form in atlas.forms]
    return section("Forms", heads, rows, SHOWN)


def _rims(atlas: Atlas) -> str:
    """The forms along which the equations are defined on one side only."""
    rows = [
        (form.name, rim) for form in atlas.forms for rim in form.labels.get("rims", ())
    ]
    return section("Forms on a rim", ("form", "where"), rows, SHOWN)


def _end(branch: Branch) -> str:
    """How a branch ends."""
    if branch.outcome is Outcome.LEFT_REGION:
        return "leaves the bounds"
    return branch.outcome.name.lower().replace("_", " ")


def _form_row(form: Form, is_periodic: bool) -> list[str]:
    branch = form.branch
    row = [
        form.name,
        f"{branch.length:.6g}",
        _end(branch),
        f"{form.min_singular_value:.3g}",
        f"{branch.max_residual:.1e}",
    ]
    if is_periodic:
        winding = " ".join(f"{turns:+d}" if turns else "0" for turns in branch.winding)
        row.insert(3, winding if branch.closed else NONE)
    return row


def _surfaces(atlas: Atlas) -> str:
    rows = []
    for surface in atlas.surfaces:
        charts = surface.charts
        count, area = NONE, NONE
        if charts is not None:
            count, area = str(len(charts)), charts.area_words or NONE
        product = describe_product(surface.factors, atlas.names)
        remark = "; ".join(filter(None, [product, surface.note]))
        rows.append((surface.name, str(surface.dimension), count, area, remark))
    heads = ("name", "dimension", "charts", "area", "remark")
    return section("Surfaces", heads, rows, SHOWN)


# --- points ---------------------------------------------------------------------------


def _points(atlas: Atlas) -> str:
    kinds = {}
    if atlas.diagram is not None:
        kinds = {one.point: one.kind.value for one in atlas.diagram.branchings}
    rows = []
    for number, point in enumerate(atlas.points):
        kind = kinds.get(number, point.kind.value)
        row = [point.name, kind, *_values(atlas, point.point.u)]
        row += [f"{point.point.error:.0e}", _members(atlas, point), point.note]
        rows.append(row)
    before, after = ("name", "kind"), ("error", "forms", "remark")
    heads = [*before, *_heads(atlas, before + after), *after]
    return section("Singular points", heads, rows, SHOWN)


def _members(atlas: Atlas, point: MeetingPoint) -> str:
    forms = [atlas.forms[index].name for index, _ in point.passes]
    surfaces = [atlas.surfaces[index].name for index in point.surfaces]
    return ", ".join(forms + surfaces) or NONE


def _diagram_points(atlas: Atlas, diagram: Diagram, kind: Kind) -> str:
    """What happens along the forms, of one kind, with the columns of that."""
    heads = {"unknowns": _heads(atlas, ("name", *kind.columns, "form"))}
    rows = []
    for point in diagram.points:
        if point.kind is not kind:
            continue
        cells = {
            "event": [point.label],
            "unknowns": _values(atlas, point.u),
            "frequency": [f"{point.value:.10g}"],
            "pair": [point.label],
            "error": [f"{point.error:.0e}"],
        }
        own = chain.from_iterable(cells[column] for column in kind.columns)
        rows.append([point.name, *own, atlas.forms[point.form].name])
    named = chain.from_iterable(heads.get(column, [column]) for column in kind.columns)
    title = kind.title.format(parameter=diagram.parameter)
    return section(title, ["name", *named, "form"], rows, SHOWN)


def _along_parameter(atlas: Atlas) -> list[str]:
    """What the diagram says: points kind by kind, remarks on events, stability."""
    diagram = atlas.diagram
    if diagram is None:
        return []
    return [
        *(_diagram_points(atlas, diagram, kind) for kind in Kind),
        "\n".join(f"Note: {remark}." for remark in diagram.remarks),
        _stretches(atlas, diagram),
    ]


def _stretches(atlas: Atlas, diagram: Diagram) -> str:
    """Where on each form it is stable, where that is known."""
    parameter = list(atlas.names).index(diagram.parameter) if diagram.parameter else 0
    rows = []
    for stretch in diagram.stretches:
        if stretch.unstable < 0:
            continue
        branch = atlas.forms[stretch.form].branch
        start, end = branch(np.array([stretch.start, stretch.end]))[:, parameter]
        rows.append(
            (
                atlas.forms[stretch.form].name,
                f"{stretch.start:.6g} to {stretch.end:.6g}",
                " to ".join(_numbers(np.array([start, end]))),
                stretch.stability.value,
                str(stretch.unstable),
            )
        )
    before, after = ("form", "arclength"), ("stability", "unstable")
    named = distinct_heads([diagram.parameter], before + after)
    heads = (*before, *named, *after)
    return section("Stability", heads, rows, SHOWN)


def _near_misses(atlas: Atlas) -> str:
    rows = []
    for miss in sorted(atlas.near_misses, key=lambda miss: miss.value):
        row = [*_values(atlas, miss.u), f"{miss.value:.6g}", f"{miss.error:.0e}"]
        rows.append([*row, atlas.forms[miss.form].name])
    own = ("singular value", "error", "form")
    heads = [*_heads(atlas, own), *own]
    return section("Near misses (no bifurcation)", heads, rows, SHOWN)


def _isolated(atlas: Atlas) -> str:
    rows = [_values(atlas, point) for point in atlas.rigid]
    return section("Isolated solutions", _heads(atlas, ()), rows, SHOWN)
