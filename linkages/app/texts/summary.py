"""The summary of a transition map: degrees, joints numbered from 1. The whole of it, and
what of it stands on the first screen."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from bifurc.atlas import Atlas, MeetingPoint, Surface
from bifurc.branch import Branch, Outcome
from bifurc.completeness import Completeness, Level, Scope
from bifurc.singular.point import Kind
from bifurc.surfaces.factor import describe_product
from bifurc.tables import count_of, section, section_of
from linkages.app.answer.verdict import judge
from linkages.app.texts.configurations import (
    arclength_unit,
    show_configuration,
    unit_of_arclengths,
)
from linkages.app.texts.crease_text import describe_creases
from linkages.app.texts.entry_text import describe_geometry
from linkages.app.texts.form_names import listed_forms
from linkages.app.texts.hanging_text import describe_hanging
from linkages.app.texts.numbers import in_degrees
from linkages.labels import FormLabels, loop_of
from linkages.readout.drawn import drawn_place
from linkages.subject import MOST_SHOWN, subject_at

SHOWN = 12  # near misses and rigid assemblies beyond this number are only counted
SCREEN = 25  # lines that the first screen has
SCREEN_ROWS = 4  # rigid assemblies and near motions on it
MOST_MOVING = 2 * SCREEN  # unknowns, each of which moves or stands still in a table
# Columns of the tables that the first screen leaves out.
DETAILS = ("smallest s.v.", "residual", "rank", "error", "mobility")
NEAR_MOTIONS = "Near motions (the loop nearly closes)"
REASONS = "the reasons: --verbose"
IN_BRACKETS = re.compile(r" ?\([^()]*\)")


def make_screen(atlas: Atlas) -> str:
    """What `bifurc map` shows first: verdict, forms, points, what joints do where that
    has room, and one line on how sure it is."""
    points = [_point_records(atlas, title) for title in _titles()]
    parts = [
        _head_of(atlas),
        _held(atlas),
        section_of("Forms", _shortened(_form_records(atlas))),
        _surfaces(atlas),
        *(
            section_of(title, _shortened(records))
            for title, records in zip(_titles(), points, strict=True)
        ),
        _near_misses_in_short(atlas),
        section_of(NEAR_MOTIONS, _shortened(_near_motion_records(atlas)), SCREEN_ROWS),
        section("Rigid assemblies", *_rigid_table(atlas), SCREEN_ROWS),
    ]
    shown = [part for part in parts if part]
    certainty = certainty_in_short(atlas.completeness)
    for motion in _motions(atlas) if len(atlas.names) <= MOST_MOVING else []:
        text = "\n\n".join([*shown, motion, certainty])
        if len(text.splitlines()) <= SCREEN:
            shown.append(motion)
    return "\n\n".join([*shown, certainty])


def _held(atlas: Atlas) -> str:
    """How creases are assigned, and what is held as it lies in no closed loop."""
    readout = subject_at(atlas).readout
    if readout is None:
        return ""
    structure = readout.structure
    lines = [describe_creases(structure)] if structure.mechanism.creases else []
    lines.append(describe_hanging(structure))
    return "\n".join(filter(None, lines))


def _head_of(atlas: Atlas) -> str:
    """The name, the verdict, and where on the map the configuration of the file is."""
    lines = [str(atlas.subject.get("name")), judge(atlas).sentence]
    drawn = drawn_place(atlas)
    if drawn is not None and drawn.name:
        place = ""
        if drawn.form is not None:
            unit = arclength_unit(atlas)
            place = f" at s = {drawn.s:.4g}"
            if unit.name == "deg":
                place = f" at {unit.factor * drawn.s:.4g} deg"
        lines.append(f"As drawn: {drawn.name}{place}.")
    return "\n".join(lines)


def _titles() -> list[str]:
    """The titles of the tables of singular points."""
    return list(dict.fromkeys(one.title for one in Kind))


def _shortened(records: Sequence[Mapping[str, str]]) -> list[dict[str, str]]:
    """Records without details, and without columns in which nothing unusual stands: all
    forms are closed, as a rule."""
    left_out = set(DETAILS)
    for head in records[0] if records else ():
        cells = {record[head] for record in records}
        is_usual = cells in ({"-"}, {"yes"})
        if is_usual or (head == "kind" and all(":" not in one for one in cells)):
            left_out.add(head)
    return [
        {head: cell for head, cell in record.items() if head not in left_out}
        for record in records
    ]


def _near_misses_in_short(atlas: Atlas) -> str:
    """How many near misses there are, and the nearest."""
    if not atlas.near_misses:
        return ""
    nearest = min(atlas.near_misses, key=lambda miss: miss.value)
    count = count_of(len(atlas.near_misses), "near miss")
    form = atlas.forms[nearest.form].name
    return (
        f"{count} (no bifurcation): the smallest singular value is {nearest.value:.3g}, "
        f"on {form}."
    )


def certainty_in_short(completeness: Completeness) -> str:
    """One line on how sure an answer is: what is claimed or in doubt, without the
    reasons."""
    level = completeness.level
    start = f"Certainty ({level}): "
    if completeness.doubts:
        first = _head(completeness.doubts[0].text)
        more = len(completeness.doubts) - 1
        others = f", and {count_of(more, 'more doubt')}" if more else ""
        return f"{start}in doubt: {first}{others} ({REASONS})."
    claims = [
        _head(claim.text)
        for claim in completeness.claims
        if claim.scope is not Scope.STARTS and claim.level is not None
    ]
    if level is Level.ESTIMATED and completeness.missed_probability < 1.0:
        claims.append(
            "one more random start would reach something new with a probability of at "
            f"most {completeness.missed_probability:.2g}"
        )
    words = "; ".join(dict.fromkeys(claims)) or "see the whole statement"
    return f"{start}{words} ({REASONS})."


def _head(text: str) -> str:
    """A statement without what stands in brackets or follows its colon."""
    bare = text
    while (shorter := IN_BRACKETS.sub("", bare)) != bare:
        bare = shorter
    return bare.partition(":")[0]


def make_summary(atlas: Atlas) -> str:
    """What `bifurc map --verbose` shows, and summary.txt holds: verdict, geometry, forms,
    singular points, completeness and time."""
    completeness = atlas.completeness
    provenance = atlas.provenance
    parts = [
        _head_of(atlas),
        *_geometry(atlas),
        section_of("Forms", _form_records(atlas)),
        _surfaces(atlas),
        *(section_of(title, _point_records(atlas, title)) for title in _titles()),
        _near_misses(atlas),
        section("Rigid assemblies", *_rigid_table(atlas), SHOWN),
        section_of(NEAR_MOTIONS, _near_motion_records(atlas), SHOWN),
        _certificates(atlas),
        *_motions(atlas),
        f"Completeness ({completeness.level}): {completeness.statement}.",
        f"Explored in {provenance.seconds:.3f} s, seed {provenance.seed}.",
    ]
    return "\n\n".join(part for part in parts if part)


def _geometry(atlas: Atlas) -> list[str]:
    """Tables of what is given of a loop, or of a mechanism."""
    readout = subject_at(atlas).readout
    if readout is None:
        return [describe_geometry(loop_of(atlas))]
    from linkages.app.texts import mechanism_text

    return [
        mechanism_text.describe_joints(readout),
        mechanism_text.describe_outer_joints(readout.mechanism),
        mechanism_text.describe_loops(atlas, readout),
    ]


def _motions(atlas: Atlas) -> list[str]:
    """Tables of what the joints of a mechanism do along its forms."""
    readout = subject_at(atlas).readout
    if readout is None or not atlas.forms:
        return []
    from linkages.app.texts import mechanism_text

    motions = [
        mechanism_text.describe_motions(atlas, readout),
        mechanism_text.describe_dead_points(atlas, readout),
        mechanism_text.describe_outer_motions(atlas, readout),
    ]
    return [motion for motion in motions if motion]


def _form_records(atlas: Atlas) -> list[dict[str, str]]:
    rows = []
    unit = arclength_unit(atlas)
    for form in listed_forms(atlas):
        labels = FormLabels.of(form)
        rows.append(
            {
                "name": form.name,
                "closed": _closure(form.branch),
                f"length ({unit.name})": f"{unit.factor * form.branch.length:.6g}",
                "winding": _winding(atlas, form.branch),
                "inactive joints": _inactive_joints(atlas, labels),
                "symmetry": labels.symmetry.value or "-",
                "smallest s.v.": f"{form.min_singular_value:.3g}",
                "residual": f"{labels.max_residual:.1e}",
            }
        )
    return rows


def _closure(branch: Branch) -> str:
    """Whether a branch is closed, or else how it ends."""
    if branch.closed:
        return "yes"
    if branch.outcome is Outcome.LEFT_REGION:
        return "leaves the limits"
    return branch.outcome.name.lower().replace("_", " ")


def _winding(atlas: Atlas, branch: Branch) -> str:
    """How often each joint turns round, with its sign; "-" for unknowns that do not
    turn; once for many."""
    words = []
    for turns, period in zip(branch.winding, atlas.periods, strict=True):
        if not np.isfinite(period):
            words.append("-")
        else:
            words.append(f"{turns:+d}" if turns else "0")
    is_long = len(words) > MOST_SHOWN and {*words} == {"-"}
    return "-" if is_long else " ".join(words)


def _inactive_joints(atlas: Atlas, labels: FormLabels) -> str:
    """The joints that stand still, those of a mechanism by name; where, of a loop."""
    pairs = zip(labels.inactive_joints, labels.inactive_angles, strict=True)
    still = subject_at(atlas).still
    shown = [still(joint - 1, in_degrees(angle)) for joint, angle in pairs]
    return ", ".join(shown) or "-"


def _surfaces(atlas: Atlas) -> str:
    unit = "rad^2"
    if set(atlas.units) != {"rad"}:
        unit = f"squares of {arclength_unit(atlas).name}"
    heads = ("name", "dimension", "charts", f"area ({unit})", "covering", "remark")
    return section("Surfaces", heads, [_surface_row(atlas, s) for s in atlas.surfaces])


def _surface_row(atlas: Atlas, surface: Surface) -> tuple[str, ...]:
    name, dimension = surface.name, str(surface.dimension)
    charts = surface.charts
    product = describe_product(surface.factors, atlas.names)
    remark = "; ".join(filter(None, [product, surface.note]))
    if charts is None:
        covering = "not needed" if product else "none: only sampled"
        return (name, dimension, "-", "-", covering, remark)
    count, area = str(len(charts)), charts.area_words or "-"
    return (name, dimension, count, area, charts.outcome.value, remark)


def _point_records(atlas: Atlas, title: str) -> list[dict[str, str]]:
    """The singular points of the kinds whose table has a ``title``."""
    rows = []
    for point in atlas.points:
        if point.kind.title != title:
            continue
        remark = f": {point.note}" if point.note else _how_held(atlas, point)
        rows.append(
            {
                "name": point.name,
                subject_at(atlas).heading(atlas): show_configuration(
                    atlas, point.point.u
                ),
                "rank": str(point.point.rank),
                "error": f"{point.point.error:.0e}",
                "forms": ", ".join(_names_at(atlas, point)) or "-",
                "kind": point.kind.value + remark,
            }
        )
    return rows


def _how_held(atlas: Atlas, point: MeetingPoint) -> str:
    """What holds an isolated assembly of a mechanism that is singular."""
    readout = subject_at(atlas).readout
    if readout is None or point.kind is not Kind.ISOLATED:
        return ""
    from linkages.app.texts.rigidity_text import how_held

    return f": {how_held(readout, point.point.u)}"


def _names_at(atlas: Atlas, point: MeetingPoint) -> list[str]:
    """Names of the forms, once for every pass, and the surfaces at a singular point."""
    forms = [atlas.forms[index].name for index, _ in point.passes]
    surfaces = [atlas.surfaces[index].name for index in point.surfaces]
    if point.kind is Kind.DIMENSION_CHANGE and not surfaces:
        # charts tell which surface is met; those that are only sampled have none
        sampled = [one.name for one in atlas.surfaces if one.charts is None]
        surfaces = [" or ".join(sampled)] if sampled else []
    return forms + surfaces


def _near_misses(atlas: Atlas) -> str:
    rows = []
    for miss in sorted(atlas.near_misses, key=lambda miss: miss.value):
        rows.append(
            {
                subject_at(atlas).heading(atlas): show_configuration(atlas, miss.u),
                "singular value": f"{miss.value:.6g}",
                "error": f"{miss.error:.0e}",
                "form": atlas.forms[miss.form].name,
            }
        )
    return section_of("Near misses (no bifurcation)", rows, SHOWN)


def _rigid_table(atlas: Atlas) -> tuple[Sequence[str], list[Sequence[str]]]:
    """The head and the rows of the table of rigid assemblies, with how they are held."""
    subject = subject_at(atlas)
    if subject.readout is None:
        rows: list[Sequence[str]]
        rows = [(show_configuration(atlas, theta),) for theta in atlas.rigid]
        return (subject.heading(atlas),), rows
    from linkages.app.texts.rigidity_text import assemblies_table

    return assemblies_table(atlas, subject.readout)


def _near_motion_records(atlas: Atlas) -> list[dict[str, str]]:
    rows = []
    unit = arclength_unit(atlas)
    for near in atlas.near_motions:
        closed = "yes" if near.is_closed else "no"
        length = f"{unit.factor * near.length:.4g}"
        if near.mobility > 1:
            closed, length = "-", "-"
        rows.append(
            {
                "name": near.name,
                subject_at(atlas).heading(atlas): show_configuration(
                    atlas, near.sample
                ),
                "mobility": str(near.mobility),
                "closed": closed,
                f"length ({unit.name})": length,
                "misclosure": f"{near.misclosure:.3g}",
            }
        )
    return rows


def _certificates(atlas: Atlas) -> str:
    rows = []
    unit = unit_of_arclengths(atlas)
    for form in listed_forms(atlas):
        certificate = form.certificate
        if certificate is None:
            continue
        rows.append(
            {
                "name": form.name,
                "status": certificate.status,
                "points": str(certificate.points),
                "curvature at most": f"{certificate.bound:.3g}",
                f"not certified between ({unit})": _show_intervals(certificate.gaps),
                f"known to rounding between ({unit})": _show_intervals(
                    certificate.blurred
                ),
            }
        )
    return section_of("Certificates (each form is one arc of solutions)", rows)


def _show_intervals(intervals: NDArray[np.float64]) -> str:
    """The first interval of arclength, and how many more there are."""
    if not len(intervals):
        return "-"
    low, high = intervals[0]
    text = f"{low:.6g} to {high:.6g}"
    more = len(intervals) - 1
    return f"{text} and {more} more" if more else text
