"""The study that tries to refute proofs of completeness."""

import numpy as np
from click.testing import CliRunner

from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from linkages.catalogue import entry
from linkages.closure.closure import Closure
from studies.missing_motions import linkages, main, same_motions


def test_every_second_linkage_has_a_small_motion_beside_a_large_one():
    drawn = linkages(np.random.default_rng(3))
    names, loops = zip(*(next(drawn) for _ in range(6)), strict=True)
    assert names[1::2] == ("beside a birth",) * 3
    for loop in loops[1::2]:
        small, large = sorted(
            form.branch.length
            for form in explore(
                Closure(loop), settings=SearchSettings(starts=20, count=True)
            ).forms
        )
        assert small < 1.0 < 5.0 < large


def test_a_motion_that_is_missing_is_noticed():
    one, other = (
        explore(Closure(entry(name).build()), settings=SearchSettings(starts=20))
        for name in ("bennett", "parallelogram")
    )
    assert same_motions(one, one)
    assert not same_motions(one, other)


def test_the_command_refutes_nothing():
    result = CliRunner().invoke(main, ["--count", "6"])
    assert result.exit_code == 0, result.output
    assert "0 counts refuted" in result.output
