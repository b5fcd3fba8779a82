import subprocess
import sys

import mpmath
import numpy as np
import pytest

from linkages.catalogue import UnknownLinkageError, catalogue, entry
from linkages.loop import Loop
from linkages.values import GeometryError

OWN_NAMES = {
    *("four-bar", "parallelogram", "rhombus", "kite"),
    *("bennett", "bennett-ab-2", "bennett-line-symmetric", "bennett-lb-2"),
    *("goldberg-5r", "subtractive-goldberg-5r"),
    *("wohlhart-double-goldberg", "special-wohlhart-double-goldberg"),
    *("double-subtractive-goldberg", "special-double-subtractive-goldberg"),
    *(
        "bricard-line-symmetric",
        "bricard-line-symmetric-zero-offset",
        "bricard-octahedral-line-symmetric",
    ),
    *("reconfigurable-bricard-1", "reconfigurable-bricard-2", "wohlhart-symmetric"),
}


def test_every_linkage_is_found_by_its_name():
    assert set(catalogue()) >= OWN_NAMES
    for name in catalogue():
        assert entry(name).name == name


def test_every_linkage_with_reference_cases_is_covered(reference_cases):
    assert {case["linkage"] for case in reference_cases} == OWN_NAMES


def test_an_unknown_name_is_refused_with_the_nearest_names():
    with pytest.raises(
        UnknownLinkageError, match="special-wohlhart-double-goldberg"
    ) as caught:
        entry("Special Wolhart double goldberg")
    assert "special-wohlhart-double-goldberg" in caught.value.nearest
    assert isinstance(caught.value, KeyError)


def test_a_name_like_no_other_says_so():
    with pytest.raises(UnknownLinkageError, match="no name is like it"):
        entry("qqqq")


def test_importing_the_catalogue_loads_neither_sympy_nor_mpmath():
    code = "import sys; from linkages.catalogue import catalogue; catalogue(); " + (
        "sys.exit(any(m in sys.modules for m in ('sympy', 'mpmath', 'matplotlib', 'networkx', 'xarray')))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_every_default_lies_in_its_range():
    for name in sorted(OWN_NAMES):
        for parameter in entry(name).parameters:
            assert parameter.low <= parameter.default <= parameter.high, (
                name,
                parameter.name,
            )


def test_every_reference_configuration_closes(reference_cases, closure_gap):
    for case in reference_cases:
        loop = entry(case["linkage"]).build(**case["parameters"])
        for form in case["forms"]:
            assert closure_gap(loop, form["theta"]) < 2e-14 * max(
                1.0, loop.characteristic_length
            ), case["linkage"]


def test_the_joint_screws_leave_one_degree_of_freedom(reference_cases):
    for case in reference_cases:
        found = entry(case["linkage"])
        loop = found.build(**case["parameters"])
        for form in case["forms"]:
            sigma = np.linalg.svd(
                loop.joint_screws(np.array(form["theta"])), compute_uv=False
            )
            rank = int(np.count_nonzero(sigma > 1e-9 * sigma[0]))
            assert loop.n - rank == found.facts["mobility"], (
                case["linkage"],
                form["name"],
                sigma,
            )
            assert rank == found.facts["rank"]


def test_a_broken_length_leaves_the_loop_open_and_rigid(reference_cases):
    """Lengths off by 1e-3: the same angles no longer close, so that closure does test
    the geometry."""
    for case in reference_cases:
        loop = entry(case["linkage"]).build(**case["parameters"])
        lengths = (loop.lengths[0] + 1e-3, *loop.lengths[1:])
        broken = Loop(lengths, loop.twists, loop.offsets)
        theta = np.array(case["forms"][0]["theta"])
        assert np.abs(broken.frames(theta)[-1] - np.eye(4)).max() > 1e-5, case[
            "linkage"
        ]


def test_constructors_agree_with_themselves_at_fifty_digits():
    with mpmath.workdps(50):
        for name in sorted(OWN_NAMES):
            found = entry(name)
            exact = found.construct(
                **{key: mpmath.mpf(value) for key, value in found.defaults.items()}
            )
            for fine, coarse in zip(exact.arrays, found.build().arrays, strict=True):
                np.testing.assert_allclose(fine, coarse, rtol=0, atol=4e-15)


def test_random_members_are_built_or_refused_with_a_reason():
    rng = np.random.default_rng(7)
    for name in sorted(OWN_NAMES):
        built = 0
        for _ in range(40):
            try:
                built += isinstance(entry(name).build(**entry(name).draw(rng)), Loop)
            except GeometryError as refused:
                assert refused.allowed
        assert built >= 5, name
