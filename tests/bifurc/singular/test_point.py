"""What a singular point says of itself."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc.singular.point import Kind, SingularPoint

AHEAD, BEHIND = (1.0, 0.0), (-1.0, 0.0)
LEFT, RIGHT = (0.0, 1.0), (0.0, -1.0)


def point(half_branches: list[tuple[float, float]], dimension: int) -> SingularPoint:
    return SingularPoint(
        u=np.zeros(2),
        rank=4,
        null_space=np.eye(3),
        error=2.5e-15,
        half_branches=np.array(half_branches).reshape(-1, 2),
        tangents=np.eye(2),
        dimension=dimension,
        order=2,
        radius=0.02,
    )


@pytest.mark.parametrize(
    ("half_branches", "dimension", "kind"),
    [
        ([AHEAD, BEHIND, LEFT, RIGHT], 1, Kind.BIFURCATION),
        ([AHEAD, BEHIND], 1, Kind.RANK_DROP),
        ([AHEAD, (0.8, 0.6)], 1, Kind.CUSP),
        ([AHEAD, (0.28, 0.96)], 1, Kind.UNDECIDED),
        ([AHEAD, (-0.28, 0.96)], 1, Kind.UNDECIDED),
        ([AHEAD, (-0.8, 0.6)], 1, Kind.RANK_DROP),
        ([], 0, Kind.ISOLATED),
        ([AHEAD, BEHIND], 2, Kind.DIMENSION_CHANGE),
        ([], 2, Kind.SURFACE),
        ([AHEAD, BEHIND, LEFT], 1, Kind.UNDECIDED),
        ([], -1, Kind.UNDECIDED),
    ],
)
def test_the_half_branches_and_the_dimension_make_the_kind(
    half_branches: list[tuple[float, float]], dimension: int, kind: Kind
) -> None:
    assert point(half_branches, dimension).kind is kind


def test_a_point_of_a_surface_with_no_larger_null_space_is_undecided() -> None:
    on_surface = point([], 2)
    assert on_surface.kind is Kind.SURFACE
    assert replace(on_surface, null_space=np.eye(2)).kind is Kind.UNDECIDED


@pytest.mark.parametrize("is_through", [False, True])
def test_exact_equations_tell_to_which_sides_two_half_branches_leave(
    is_through: bool,
) -> None:
    seen = point([AHEAD, (0.8, 0.6)], 1)
    kind = replace(seen, is_through=is_through).kind
    assert kind is (Kind.RANK_DROP if is_through else Kind.CUSP)


def test_a_singular_point_is_shown_in_one_line() -> None:
    shown = repr(point([AHEAD, BEHIND, LEFT, RIGHT], 1))
    assert shown == (
        "SingularPoint(bifurcation, rank 4, error 2.5e-15, 4 half-branches, 2 tangents)"
    )


def test_points_that_may_be_in_one_map_have_marks_of_their_own() -> None:
    kinds = [
        Kind.BIFURCATION,
        Kind.RANK_DROP,
        Kind.DIMENSION_CHANGE,
        Kind.CUSP,
        Kind.ISOLATED,
        Kind.SURFACE,
        Kind.UNDECIDED,
    ]
    assert len({kind.mark for kind in kinds}) == len(kinds)
