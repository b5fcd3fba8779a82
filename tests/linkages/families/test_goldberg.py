import math

import pytest
import sympy

from linkages.families.goldberg_5r import goldberg, subtractive_goldberg
from linkages.values import GeometryError

TWISTS = dict(zip(("alpha", "beta", "gamma"), (1.15, 0.87, 0.49), strict=True))


@pytest.mark.parametrize("construct", [goldberg, subtractive_goldberg])
@pytest.mark.parametrize(("length", "twist"), [("b", "beta"), ("c", "gamma")])
def test_a_length_off_by_a_thousandth_is_refused_by_name(construct, length, twist):
    right = math.sin(TWISTS[twist]) / math.sin(TWISTS["alpha"])
    construct(1.0, **TWISTS, **{length: right})
    with pytest.raises(
        GeometryError,
        match=rf"link {length}/{twist}: sin\(twist\)/length.*off by 0\.00091",
    ):
        construct(1.0, **TWISTS, **{length: right * 1.001})


def test_a_subtraction_that_leaves_no_length_is_refused():
    with pytest.raises(GeometryError, match="length of link 23"):
        subtractive_goldberg(1.0, 0.5, 0.9, 1.2)


def test_symbols_give_the_composite_link_exactly():
    a, alpha, beta, gamma = sympy.symbols("a alpha beta gamma", positive=True)
    loop = goldberg(a, alpha, beta, gamma)
    assert (
        sympy.simplify(loop.lengths[1] - a * (1 + sympy.sin(gamma) / sympy.sin(alpha)))
        == 0
    )
    assert loop.twists[1] == alpha + gamma


def test_joint_angles_keep_the_published_sums(reference_cases, trace_form):
    from linkages.catalogue import entry

    for case in reference_cases:
        if case["linkage"] in ("goldberg-5r", "subtractive-goldberg-5r"):
            theta = trace_form(
                entry(case["linkage"]).build(), case["forms"][0]["theta"]
            )
            half = (math.pi if case["linkage"] == "goldberg-5r" else 0.0) / 2
            for joints in ([0, 3], [1, 2, 4]):
                gap = theta[:, joints].sum(axis=1) / 2 - half
                assert max(abs(math.sin(x)) for x in gap) < 1e-12
