"""Certificates for all forms of an atlas."""

from __future__ import annotations

from dataclasses import replace

from bifurc.atlas import Atlas
from bifurc.curves.certificate import certify_branch
from bifurc.problem import Problem

__all__ = ["certify_atlas"]


def certify_atlas(problem: Problem, atlas: Atlas) -> Atlas:
    """The atlas with a certificate on every form; its located singular points are
    handed over to."""
    forms = []
    for i, form in enumerate(atlas.forms):
        singular = [s for p in atlas.points for j, s in p.passes if j == i]
        certificate = certify_branch(problem, form.branch, form.profile, singular)
        forms.append(replace(form, certificate=certificate))
    return replace(atlas, forms=tuple(forms))
