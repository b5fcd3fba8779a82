"""Certificates for all forms of an atlas."""

from __future__ import annotations

from dataclasses import replace

from bifurc.atlas import Atlas
from bifurc.checks import check_type
from bifurc.curves.certificate import certify_branch
from bifurc.errors import ProblemError
from bifurc.problem import Problem


def certify_atlas(problem: Problem, atlas: Atlas) -> Atlas:
    """The atlas with a certificate on every form, from singular point to singular
    point."""
    check_type("problem", problem, Problem)
    check_type("atlas", atlas, Atlas)
    if atlas.names != problem.names:
        raise ProblemError("unknowns of the atlas", atlas.names, str(problem.names))
    forms = []
    for index, form in enumerate(atlas.forms):
        stops = _singular_arclengths(atlas, index)
        certificate = certify_branch(problem, form.branch, form.profile, stops)
        forms.append(replace(form, certificate=certificate))
    return replace(atlas, forms=tuple(forms))


def _singular_arclengths(atlas: Atlas, form: int) -> list[float]:
    """Arclengths at which a form, given by its index, passes a singular point."""
    arclengths = []
    for point in atlas.points:
        arclengths += [s for index, s in point.passes if index == form]
    return arclengths
