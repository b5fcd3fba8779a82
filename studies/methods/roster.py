"""Every method of the study by its name, as a function of a case and a tolerance."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from studies.methods import (
    auto07p,
    natural,
    null_field,
    peers,
    point_by_point,
    this_project,
)
from studies.methods.cases import Case
from studies.methods.curve import Curve

ORDERS = (2, 4, 8, 12, 16, 20, 24)
Follow = Callable[..., Curve]


@dataclass(frozen=True)
class Method:
    """A way to follow a curve: ``follow(case, tolerance)``. ``order`` is that of this
    project's pieces, else 0; ``small`` if it is for small problems alone, for want of
    sparse matrices."""

    name: str
    follow: Callable[[Case, float], Curve]
    order: int = 0
    small: bool = False


def orders_of_this_project() -> list[Method]:
    """This project at every order."""

    def follow(order: int, case: Case, tolerance: float) -> Curve:
        return this_project.trace(
            case.problem, case.start, case.tangent, case.length, order, tolerance
        )

    return [Method(f"order {order}", partial(follow, order), order) for order in ORDERS]


def comparison_methods() -> list[Method]:
    """The usual ways, and the packages that are installed."""
    methods = [
        _by_arclength(
            "pseudo-arclength, tangent", point_by_point.pseudo_arclength_tangent
        ),
        _by_arclength(
            "pseudo-arclength, secant", point_by_point.pseudo_arclength_secant
        ),
        _by_arclength(
            "SVD predictor-corrector",
            point_by_point.svd_predictor_corrector,
            small=True,
        ),
        Method("natural parameter", _natural, small=True),
    ]
    for solver in null_field.SOLVERS:
        plain = partial(_integrate, solver=solver, projected=False)
        methods.append(_by_arclength(f"solve_ivp {solver}", plain))
        if solver != "LSODA":  # its history of steps cannot be moved
            moved = partial(_integrate, solver=solver, projected=True)
            methods.append(_by_arclength(f"solve_ivp {solver}, projected", moved))
    if peers.has_pycont():
        methods.append(_by_arclength("pycont-lite", peers.pycont_lite))
    if auto07p.has_auto():
        methods.append(Method("AUTO-07p", auto07p.auto_07p, small=True))
    return methods


_integrate = null_field.integrate_null_field


def _by_arclength(name: str, follow: Follow, small: bool = False) -> Method:
    def run(case: Case, tolerance: float) -> Curve:
        return follow(case.problem, case.start, case.tangent, case.length, tolerance)

    return Method(name, run, small=small)


def _natural(case: Case, tolerance: float) -> Curve:
    parameter, travel = case.parameter
    return natural.natural_parameter(
        case.problem, case.start, travel, parameter, tolerance
    )
