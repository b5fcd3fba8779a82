"""An atlas of a linkage as one JSON document: angles in radians, joints numbered from
1."""

from __future__ import annotations

from importlib.metadata import version
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from bifurc.atlas import Atlas, Event, Form, MeetingPoint, NearMotion
from bifurc.decisions import is_tied
from bifurc.torus import wrap
from linkages.app.verdict import is_without_gaps
from linkages.labels import FormLabels, loop_of

__all__ = ["MapDocument", "make_document"]


class LinkageDocument(TypedDict):
    """The Denavit-Hartenberg table, twists in rad."""

    name: str
    lengths: list[float]
    twists: list[float]
    offsets: list[float]


class CertificateDocument(TypedDict):
    """What is certified of a form, and the intervals of arclength (rad) where that is
    refused or where F' is singular to within rounding."""

    status: str
    refused: list[list[float]]
    blurred: list[list[float]]


class FormDocument(TypedDict):
    """A form; or a surface, with None for what makes sense for a curve only."""

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


class BifurcationDocument(TypedDict):
    """A bifurcation: ``forms`` and ``tangents`` once for every pass of a form."""

    theta: list[float]
    rank: int
    forms: list[str]
    tangents: list[list[float]]
    error: float


class RankDropDocument(TypedDict):
    """A point of lower rank that one form passes."""

    theta: list[float]
    rank: int
    form: str


class NearMissDocument(TypedDict):
    """A minimum of the smallest regular singular value."""

    theta: list[float]
    singular_value: float
    error: float
    form: str


class NearMotionDocument(TypedDict):
    """A path along which the loop misses closure by no more than ``misclosure``."""

    misclosure: float
    length: float
    closed: bool
    mobility: int
    sample: list[float]


class DeadPointDocument(TypedDict):
    """Where a joint (from 1) stands still for a moment."""

    theta: list[float]
    joint: int
    form: str


class CompletenessDocument(TypedDict):
    """How sure it is that nothing is missing."""

    level: str
    certainty: str
    statement: str
    missed_probability: float


class MapDocument(TypedDict):
    """The whole document; docs/results.md says what each key holds."""

    linkage: LinkageDocument
    forms: list[FormDocument]
    bifurcations: list[BifurcationDocument]
    rank_drops: list[RankDropDocument]
    near_misses: list[NearMissDocument]
    dead_points: list[DeadPointDocument]
    rigid_assemblies: list[list[float]]
    near_motions: list[NearMotionDocument]
    completeness: CompletenessDocument
    seconds: float
    version: str
    seed: int
    tolerance: float


def make_document(atlas: Atlas) -> MapDocument:
    """The document that `bifurc map --json` prints."""
    forms = [_form(atlas, i) for i in range(len(atlas.forms))]
    surfaces = [_surface(atlas, k) for k in range(len(atlas.surfaces))]
    return {
        "linkage": _linkage(atlas),
        "forms": forms + surfaces,
        "bifurcations": [_bifurcation(atlas, point) for point in atlas.bifurcations],
        "rank_drops": [_rank_drop(atlas, point) for point in atlas.rank_drops],
        "near_misses": [_near_miss(atlas, event) for event in atlas.near_misses],
        "dead_points": [_dead_point(atlas, event) for event in atlas.dead_points],
        "rigid_assemblies": [_angles(atlas, theta) for theta in atlas.rigid],
        "near_motions": [_near_motion(atlas, near) for near in atlas.near_motions],
        "completeness": _completeness(atlas),
        "seconds": atlas.provenance.seconds,
        "version": version("bifurc"),
        "seed": atlas.provenance.seed,
        "tolerance": atlas.provenance.settings.tracing.tolerance,
    }


def _linkage(atlas: Atlas) -> LinkageDocument:
    loop = loop_of(atlas)
    lengths, twists, offsets = loop.arrays
    return {
        "name": loop.name,
        "lengths": lengths.tolist(),
        "twists": twists.tolist(),
        "offsets": offsets.tolist(),
    }


def _form(atlas: Atlas, index: int) -> FormDocument:
    form = atlas.forms[index]
    labels = FormLabels.of(form)
    sample = form.branch(_clear_arclength(atlas, index))
    return {
        "name": form.name,
        "dimension": 1,
        "closed": form.branch.closed,
        "length": form.branch.length,
        "winding": form.branch.winding.tolist(),
        "inactive_joints": list(labels.inactive_joints),
        "symmetry": labels.symmetry.value,
        "sample": _angles(atlas, sample),
        "max_residual": labels.max_residual,
        "misclosure": form.misclosure,
        "min_singular_value": form.min_singular_value,
        "component": form.component,
        "certificate": _certificate(form),
    }


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
    return {
        "name": f"surface {index + 1}",
        "dimension": surface.dimension,
        "closed": None,
        "length": None,
        "winding": None,
        "inactive_joints": [],
        "symmetry": "",
        "sample": _angles(atlas, surface.samples[0]),
        "max_residual": None,
        "misclosure": None,
        "min_singular_value": None,
        "component": atlas.components + index,
        "certificate": None,
    }


def _bifurcation(atlas: Atlas, point: MeetingPoint) -> BifurcationDocument:
    return {
        "theta": _angles(atlas, point.point.u),
        "rank": point.point.rank,
        "forms": [atlas.forms[index].name for index, _ in point.passes],
        "tangents": point.tangents.tolist(),
        "error": point.point.error,
    }


def _rank_drop(atlas: Atlas, point: MeetingPoint) -> RankDropDocument:
    index, _ = point.passes[0]
    return {
        "theta": _angles(atlas, point.point.u),
        "rank": point.point.rank,
        "form": atlas.forms[index].name,
    }


def _near_miss(atlas: Atlas, event: Event) -> NearMissDocument:
    return {
        "theta": _angles(atlas, event.u),
        "singular_value": event.value,
        "error": event.error,
        "form": atlas.forms[event.form].name,
    }


def _near_motion(atlas: Atlas, near: NearMotion) -> NearMotionDocument:
    return {
        "misclosure": near.misclosure,
        "length": near.length,
        "closed": near.is_closed,
        "mobility": near.mobility,
        "sample": _angles(atlas, near.sample),
    }


def _dead_point(atlas: Atlas, event: Event) -> DeadPointDocument:
    return {
        "theta": _angles(atlas, event.u),
        "joint": event.index + 1,
        "form": atlas.forms[event.form].name,
    }


def _completeness(atlas: Atlas) -> CompletenessDocument:
    completeness = atlas.completeness
    slices = is_without_gaps(completeness)
    return {
        "level": "complete slices" if slices else "estimated",
        "certainty": completeness.level.value,
        "statement": completeness.statement,
        "missed_probability": completeness.missed_probability,
    }


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


def _angles(atlas: Atlas, theta: NDArray[np.float64]) -> list[float]:
    """Joint angles (n,), rad, between -pi and pi."""
    return [float(angle) for angle in wrap(theta, atlas.periods)]
