"""The printed parts of planar mechanisms in layers, as solids."""

import pytest

build123d = pytest.importorskip("build123d", reason="solids need the extra 'cad'")
pytest.importorskip("trimesh", reason="it opens the parts again")

from linkages import map_linkage  # noqa: E402
from linkages.app.options import PrintOptions  # noqa: E402
from linkages.app.reports.stacking import stack_of  # noqa: E402
from linkages.printing.solids import make_stack, place_stack  # noqa: E402
from studies.printed_layers import (  # noqa: E402
    describe,
    measure_parts,
    mechanisms,
    most_shared,
)

SLIDER_CRANK = "planar slider-crank RRRP"


@pytest.fixture(scope="module")
def stack():
    atlas = map_linkage(mechanisms()[SLIDER_CRANK]())
    return stack_of(atlas, atlas.forms[:1], PrintOptions())


@pytest.fixture(scope="module")
def parts(stack):
    return make_stack(stack)


def test_parts_of_a_slider_crank_keep_apart_and_are_closed(stack, parts, tmp_path):
    row = measure_parts(SLIDER_CRANK, stack, parts, 2, tmp_path)
    assert row.holds
    assert (
        row.solids == 4 + 2 * 5
    )  # bodies; a pin and a cap a turn, two of each a slide
    assert describe([row]).splitlines()[-1].endswith("yes")
    (step,) = tmp_path.glob("*.step")
    again = build123d.import_step(step)
    assert len(again.children) == row.solids
    assert min(part.volume for part in again.children) > 0


def test_a_body_in_the_layer_of_another_one_is_seen(stack, parts):
    point = stack.plan.forms[0].branch(1.0)
    placed = place_stack(stack, parts, point)[:4]
    assert most_shared(placed) == (0.0, "")
    top = int(stack.layers.numbers.argmax())
    name, solid = placed[top]
    placed[top] = name, solid.moved(build123d.Location((0, 0, -stack.pitch)))
    assert most_shared(placed)[0] > 1
