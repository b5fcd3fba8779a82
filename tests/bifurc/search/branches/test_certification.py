"""A search certifies its branches, traces again what is refused, and says what is
left."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc.completeness import Claim, Level
from bifurc.curves.certificate import CertificateStatus
from bifurc.function_problem import FunctionProblem
from bifurc.search import tracing
from bifurc.search.branches import branch_examination
from bifurc.search.explore import explore
from bifurc.seeds import Audit, Seeds
from bifurc.settings import SearchSettings
from bifurc.system import Curvature
from tests.bifurc.curves.test_jumps import polyline

SETTINGS = SearchSettings(starts=40)
trace_branch = tracing.trace_branch


class Hyperbola(FunctionProblem):
    """x y = gap in a box, with an audit that finds nothing missing."""

    def __init__(self, gap: float):
        super().__init__(lambda u: np.array([u[0] * u[1] - gap]), [[-2, 2], [-2, 2]])
        self.magnitude = 1.0

    @property
    def curvature(self) -> Curvature:
        return Curvature(1.0, np.ones_like)

    def seeds(self, rng: np.random.Generator, count: int, deadline=None) -> Seeds:
        seeds = super().seeds(rng, count)
        audit = Audit(
            (Claim("test", "nothing is missing", level=Level.COUNTED),),
            np.empty((0, 2)),
        )
        return Seeds(*list(vars(seeds).values())[:4], lambda branches, seconds: audit)


def counts(atlas):
    return len(atlas.forms), len(atlas.bifurcations)


def jumping_branch(problem, start, direction, settings, closing, *_):
    """A curve that runs along the axes instead of the hyperbola between them."""
    if settings.tolerance == SETTINGS.tracing.tolerance:
        return polyline([(1.0, 0.0), (-1.0, 0.0)])
    return trace_branch(problem, start, direction, settings, closing)


def hide_misclosure(monkeypatch):
    """Let a jump leave no residual, as next to a surface."""
    for module in (tracing, branch_examination):
        monkeypatch.setattr(module, "largest_misclosure", lambda *_: 0.0)


def test_a_branch_that_is_refused_is_traced_again(monkeypatch):
    monkeypatch.setattr(tracing, "trace_branch", jumping_branch)
    hide_misclosure(monkeypatch)
    atlas = explore(Hyperbola(1e-8), settings=SETTINGS)
    assert counts(atlas) == (2, 0)
    for form in atlas.forms:
        assert form.certificate.status is CertificateStatus.CERTIFIED
        assert form.branch.length == pytest.approx(4.0, abs=1e-3)
    assert atlas.completeness.level is Level.COUNTED


def test_where_a_branch_stays_refused_nothing_is_proved(monkeypatch):
    straight = polyline([(1.0, 0.0), (-1.0, 0.0)])
    monkeypatch.setattr(tracing, "trace_branch", lambda *_: straight)
    hide_misclosure(monkeypatch)
    atlas = explore(Hyperbola(1e-8), settings=SETTINGS)
    form = atlas.forms[0]
    assert form.certificate.status is CertificateStatus.NOT_CERTIFIED
    ((low, high),) = form.certificate.gaps
    assert low < 1.0 < high < low + 0.01
    assert atlas.completeness.level is Level.ESTIMATED
    assert f"not certified between s = {low:.6g} and {high:.6g}" in (
        atlas.completeness.statement
    )


def test_without_certificates_the_audit_alone_decides(monkeypatch):
    straight = polyline([(1.0, 0.0), (-1.0, 0.0)])
    monkeypatch.setattr(tracing, "trace_branch", lambda *_: straight)
    hide_misclosure(monkeypatch)
    settings = SearchSettings(starts=40, certify=False)
    atlas = explore(Hyperbola(1e-8), settings=settings)
    assert atlas.forms[0].certificate is None
    assert atlas.completeness.level is Level.COUNTED


def test_a_branch_that_turns_off_at_a_crossing_is_refused_there(monkeypatch):
    corner = polyline([(-1.0, 0.0), (0.0, 0.0), (0.0, 1.0)])
    monkeypatch.setattr(tracing, "trace_branch", lambda *_: corner)
    cross = FunctionProblem(lambda u: [u[0] * u[1]], [(-2, 2), (-2, 2)])
    atlas = explore(cross, settings=replace(SETTINGS, boxes=0))
    certificate = atlas.forms[0].certificate
    assert certificate.status is CertificateStatus.NOT_CERTIFIED
    assert certificate.gaps.mean() == pytest.approx(1.0, abs=1e-3)


def test_a_problem_without_bounds_has_no_certificates():
    circle = FunctionProblem(lambda u: [u @ u - 1.0], [(-2, 2), (-2, 2)])
    (form,) = explore(circle, settings=SETTINGS).forms
    assert form.certificate is None
