"""What a singular point says of itself."""

import numpy as np
import pytest

from bifurc.singular.point import Kind, SingularPoint

AHEAD, BEHIND = (1.0, 0.0), (-1.0, 0.0)
LEFT, RIGHT = (0.0, 1.0), (0.0, -1.0)


def point(half_branches: list[tuple[float, float]], dimension: int) -> SingularPoint:
    return SingularPoint(
        u=np.zeros(2),
        rank=4,
        null_space=np.eye(2),
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


def test_a_singular_point_is_shown_in_one_line() -> None:
    shown = repr(point([AHEAD, BEHIND, LEFT, RIGHT], 1))
    assert shown == (
        "SingularPoint(bifurcation, rank 4, error 2.5e-15, 4 half-branches, 2 tangents)"
    )
