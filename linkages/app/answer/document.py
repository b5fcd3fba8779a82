"""An atlas of a linkage or a mechanism as one JSON document: angles in radians, joints
numbered from 1; for a mechanism also variables by the names of its joints. What goes by
the numbers of joints is that of the Denavit-Hartenberg table where there is one, also
for a mechanism that is a single loop."""

from __future__ import annotations

from importlib.metadata import version
from typing import TYPE_CHECKING, NotRequired, TypedDict, cast

import numpy as np
from numpy.typing import NDArray

from bifurc.atlas import Atlas, Event, Form, MeetingPoint, NearMotion
from bifurc.completeness import CompletenessDocument, completeness_document
from bifurc.decisions import is_tied
from bifurc.singular.point import Kind
from linkages.app.answer.configurations import numbers_at
from linkages.app.answer.verdict import is_without_gaps
from linkages.app.subject import subject_at
from linkages.labels import FormLabels

if TYPE_CHECKING:
    # they import networkx, which loops do not need
    from linkages.app.answer.mechanism_document import MechanismDocument, RangeDocument
    from linkages.readout.readout import JointVariables


class LinkageDocument(TypedDict):
    """The name, and of a single loop of revolute joints the Denavit-Hartenberg table,
    twists in rad."""

    name: str
    lengths: NotRequired[list[float]]
    twists: NotRequired[list[float]]
    offsets: NotRequired[list[float]]


class CertificateDocument(TypedDict):
    """What is certified of a form, and the intervals of its arclength where that is
    refused or where F' is singular to within rounding."""

    status: str
    refused: list[list[float]]
    blurred: list[list[float]]


class PlaceDocument(TypedDict):
    """A configuration of a mechanism: its ``variables`` by the names of its joints; of
    a network also the D-H angles of its outer joints, rad."""

    variables: NotRequired[JointVariables]
    ring_angles: NotRequired[dict[str, float]]


class AssemblyDocument(PlaceDocument):
    """A rigid assembly of a mechanism."""

    theta: list[float]


class FormDocument(PlaceDocument):
    """A form; or a surface, with None for what makes sense for a curve only and a
    ``note``. Of a mechanism also what its joints and bodies do."""

    name: str
    dimension: int
    closed: bool | None
    length: float | None
    winding: list[int] | None
    inactive_joints: list[int]
    symmetry: str
    sample: list[float]
    max_residual: float | None
    misclosure: float | None
    min_singular_value: float | None
    component: int
    certificate: CertificateDocument | None
    note: NotRequired[str]
    ranges: NotRequired[dict[str, RangeDocument]]
    still_joints: NotRequired[list[str]]
    bodies_as_one: NotRequired[list[list[str]]]


class BifurcationDocument(PlaceDocument):
    """A bifurcation: ``forms`` and ``tangents`` once for every pass of a form."""

    theta: list[float]
    rank: int
    forms: list[str]
    tangents: list[list[float]]
    error: float


class RankDropDocument(PlaceDocument):
    """A point of lower rank that one form passes."""

    theta: list[float]
    rank: int
    form: str


class SingularPointDocument(PlaceDocument):
    """A singular point of another kind: ``forms`` once for every pass of a form."""

    theta: list[float]
    kind: str
    rank: int
    error: float
    forms: list[str]


class NearMissDocument(PlaceDocument):
    """A minimum of the smallest regular singular value."""

    theta: list[float]
    singular_value: float
    error: float
    form: str


class NearMotionDocument(PlaceDocument):
    """A path along which the loop misses closure by no more than ``misclosure``."""

    misclosure: float
    length: float
    closed: bool
    mobility: int
    sample: list[float]


class DeadPointDocument(PlaceDocument):
    """Where a joint (from 1) stands still for a moment."""

    theta: list[float]
    joint: int
    form: str
    variable: NotRequired[str]


class LinkageCompleteness(CompletenessDocument):
    """How sure it is that nothing is missing: ``certainty`` is the level, ``level``
    whether slices were complete."""

    certainty: str


class NetworkDocument(TypedDict):
    """A network of Bennett loops: its parameters, twists in rad, and the D-H angles
    (rad) at which outer joints are locked."""

    name: str
    parameters: dict[str, float]
    kinks: dict[str, float]


class MapDocument(TypedDict):
    """The whole document; docs/results.md says what each key holds."""

    linkage: LinkageDocument
    mobility: int
    gruebler: int
    mechanism: NotRequired[MechanismDocument]
    network: NotRequired[NetworkDocument]
    forms: list[FormDocument]
    bifurcations: list[BifurcationDocument]
    rank_drops: list[RankDropDocument]
    other_singular_points: list[SingularPointDocument]
    near_misses: list[NearMissDocument]
    dead_points: list[DeadPointDocument]
    rigid_assemblies: list[list[float] | AssemblyDocument]
    near_motions: list[NearMotionDocument]
    completeness: LinkageCompleteness
    seconds: float
    version: str
    seed: int
    tolerance: float


def make_document(atlas: Atlas) -> MapDocument:
    """The document that `bifurc map --json` prints."""
    forms = [_form(atlas, i) for i in range(len(atlas.forms))]
    surfaces = [_surface(atlas, k) for k in range(len(atlas.surfaces))]
    document: MapDocument = {
        "linkage": _linkage(atlas),
        "mobility": atlas.mobility,
        "gruebler": subject_at(atlas).gruebler,
        "forms": forms + surfaces,
        "bifurcations": [_bifurcation(atlas, point) for point in atlas.bifurcations],
        "rank_drops": [_rank_drop(atlas, point) for point in atlas.rank_drops],
        "other_singular_points": [
            _singular_point(atlas, point)
            for point in atlas.points
            if point.kind not in (Kind.BIFURCATION, Kind.RANK_DROP)
        ],
        "near_misses": [_near_miss(atlas, event) for event in atlas.near_misses],
        "dead_points": [_dead_point(atlas, event) for event in atlas.dead_points],
        "rigid_assemblies": [_assembly(atlas, theta) for theta in _isolated(atlas)],
        "near_motions": [_near_motion(atlas, near) for near in atlas.near_motions],
        "completeness": _completeness(atlas),
        "seconds": atlas.provenance.seconds,
        "version": version("bifurc"),
        "seed": atlas.provenance.seed,
        "tolerance": atlas.provenance.settings.tracing.tolerance,
    }
    return cast(MapDocument, {**document, **subject_at(atlas).document(atlas)})


def _add_variables(
    atlas: Atlas, document: PlaceDocument, theta: NDArray[np.float64]
) -> None:
    """Add the variables of a mechanism at a configuration (n,); nothing for a loop."""
    document.update(cast(PlaceDocument, subject_at(atlas).place(theta)))


def _assembly(
    atlas: Atlas, theta: NDArray[np.float64]
) -> list[float] | AssemblyDocument:
    numbers = numbers_at(atlas, theta)
    place = subject_at(atlas).place(theta)
    return cast(AssemblyDocument, {"theta": numbers, **place}) if place else numbers


def _linkage(atlas: Atlas) -> LinkageDocument:
    subject = subject_at(atlas)
    if subject.table is None:
        return {"name": subject.name}
    lengths, twists, offsets = subject.table.arrays
    return {
        "name": subject.table.name,
        "lengths": lengths.tolist(),
        "twists": twists.tolist(),
        "offsets": offsets.tolist(),
    }


def _form(atlas: Atlas, index: int) -> FormDocument:
    form = atlas.forms[index]
    labels = FormLabels.of(form)
    to_angles = subject_at(atlas).to_angles
    winding = to_angles.directions(form.branch.winding).astype(int)
    inactive = [to_angles.index(joint - 1) + 1 for joint in labels.inactive_joints]
    sample = form.branch(_clear_arclength(atlas, index))
    document: FormDocument = {
        "name": form.name,
        "dimension": 1,
        "closed": form.branch.closed,
        "length": form.branch.length,
        "winding": winding.tolist(),
        "inactive_joints": sorted(inactive),
        "symmetry": labels.symmetry.value,
        "sample": numbers_at(atlas, sample),
        "max_residual": labels.max_residual,
        "misclosure": form.misclosure,
        "min_singular_value": form.min_singular_value,
        "component": form.component,
        "certificate": _certificate(form),
    }
    _add_variables(atlas, document, sample)
    return cast(FormDocument, {**document, **subject_at(atlas).motion(atlas, index)})


def _certificate(form: Form) -> CertificateDocument | None:
    certificate = form.certificate
    if certificate is None:
        return None
    return {
        "status": certificate.status.value,
        "refused": certificate.gaps.tolist(),
        "blurred": certificate.blurred.tolist(),
    }


def _surface(atlas: Atlas, index: int) -> FormDocument:
    """A component of dimension 2 or more, shown by one configuration."""
    surface = atlas.surfaces[index]
    document: FormDocument = {
        "name": f"surface {index + 1}",
        "dimension": surface.dimension,
        "closed": None,
        "length": None,
        "winding": None,
        "inactive_joints": [],
        "symmetry": "",
        "sample": numbers_at(atlas, surface.samples[0]),
        "max_residual": None,
        "misclosure": None,
        "min_singular_value": None,
        "component": atlas.components + index,
        "certificate": None,
        "note": surface.note,
    }
    _add_variables(atlas, document, surface.samples[0])
    return document


def _bifurcation(atlas: Atlas, point: MeetingPoint) -> BifurcationDocument:
    document: BifurcationDocument = {
        "theta": numbers_at(atlas, point.point.u),
        "rank": point.point.rank,
        "forms": [atlas.forms[index].name for index, _ in point.passes],
        "tangents": subject_at(atlas).to_angles.directions(point.tangents).tolist(),
        "error": point.point.error,
    }
    _add_variables(atlas, document, point.point.u)
    return document


def _rank_drop(atlas: Atlas, point: MeetingPoint) -> RankDropDocument:
    index, _ = point.passes[0]
    document: RankDropDocument = {
        "theta": numbers_at(atlas, point.point.u),
        "rank": point.point.rank,
        "form": atlas.forms[index].name,
    }
    _add_variables(atlas, document, point.point.u)
    return document


def _singular_point(atlas: Atlas, point: MeetingPoint) -> SingularPointDocument:
    document: SingularPointDocument = {
        "theta": numbers_at(atlas, point.point.u),
        "kind": point.kind.value,
        "rank": point.point.rank,
        "error": point.point.error,
        "forms": [atlas.forms[index].name for index, _ in point.passes],
    }
    _add_variables(atlas, document, point.point.u)
    return document


def _isolated(atlas: Atlas) -> list[NDArray[np.float64]]:
    """All configurations (n,) that have no others beside them, those of full rank
    first."""
    shaky = [p.point.u for p in atlas.points if p.kind is Kind.ISOLATED]
    return [*atlas.rigid, *shaky]


def _near_miss(atlas: Atlas, event: Event) -> NearMissDocument:
    document: NearMissDocument = {
        "theta": numbers_at(atlas, event.u),
        "singular_value": event.value,
        "error": event.error,
        "form": atlas.forms[event.form].name,
    }
    _add_variables(atlas, document, event.u)
    return document


def _near_motion(atlas: Atlas, near: NearMotion) -> NearMotionDocument:
    document: NearMotionDocument = {
        "misclosure": near.misclosure,
        "length": near.length,
        "closed": near.is_closed,
        "mobility": near.mobility,
        "sample": numbers_at(atlas, near.sample),
    }
    _add_variables(atlas, document, near.sample)
    return document


def _dead_point(atlas: Atlas, event: Event) -> DeadPointDocument:
    document: DeadPointDocument = {
        "theta": numbers_at(atlas, event.u),
        "joint": subject_at(atlas).to_angles.index(event.index) + 1,
        "form": atlas.forms[event.form].name,
    }
    _add_variables(atlas, document, event.u)
    return cast(
        DeadPointDocument, {**document, **subject_at(atlas).variable(event.index)}
    )


def _completeness(atlas: Atlas) -> LinkageCompleteness:
    values = completeness_document(atlas.completeness)
    slices = is_without_gaps(atlas.completeness)
    level = "complete slices" if slices else "estimated"
    return {**values, "level": level, "certainty": values["level"]}


def _clear_arclength(atlas: Atlas, index: int) -> float:
    """An arclength of a form: the middle of its longest stretch without singular
    points."""
    branch = atlas.forms[index].branch
    passes = [one for point in atlas.points for one in point.passes]
    marks = sorted(s for form, s in passes if form == index)
    if not marks:
        return 0.5 * branch.length
    if branch.closed:
        marks.append(marks[0] + branch.length)
    else:
        marks = [0.0, *marks, branch.length]
    gaps = np.diff(marks)
    # of stretches as long as one another, which symmetry makes, the first
    longest = int(np.argmax(gaps > gaps.max() - is_tied.threshold * branch.length))
    return 0.5 * (marks[longest] + marks[longest + 1])
