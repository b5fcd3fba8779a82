"""Paths of points of bodies on the page: they are where Python says that they are."""

import numpy as np
import pytest
from click.testing import CliRunner

from linkages import GeometryError
from linkages.app.cli import main
from linkages.links.traced_points import traced_path, traced_point
from linkages.subject import subject_at
from linkages.viewing.document import make_view_document
from tests.linkages.viewing.test_viewer import picture_of

GO = "([name, s]) => { bifurc.go(name, s); return bifurc.traced(); }"
EVEN = 400  # places of a path that are evenly spaced
CASES = {
    "tiny": "{1}:4e-61,2e-61,1e-61",
    "DSG of joints": "{1}:0.7,0.3,0.5",
    "slider-crank": "rod:2,1.5",
}


@pytest.mark.parametrize("name", CASES)
def test_a_traced_point_is_where_python_says_that_it_is(show, atlas_of, name):
    atlas = atlas_of(name)
    parts = subject_at(atlas).flat_parts
    text = CASES[name].format(*parts.names)
    shown = show(name, trace=[text])
    for form in atlas.forms[:2]:
        s = 150 * form.branch.length / EVEN
        (said,) = shown.page.evaluate(GO, [form.name, s])
        (place,) = traced_path(
            parts, traced_point(parts, text), form.branch(np.array([s]))
        )
        gaps = np.linalg.norm(np.subtract(said["path"], place), axis=1)
        assert said["name"] == text
        assert np.abs(said["place"] - place).max() < 1e-9 * parts.size
        assert gaps.min() < 1e-9 * parts.size
        assert gaps.max() > 0.1 * parts.size
        assert len(gaps) > EVEN
    assert shown.messages == []
    assert shown.page.locator(".bv-joint-number").all_text_contents()[-1] == text


def test_a_path_is_seen_from_the_body_that_is_held(show):
    shown = show("slider-crank", trace=["rod:2,1.5"])
    before = picture_of(shown)
    shown.page.locator(".bv-space-tools select").select_option("rod")
    (said,) = shown.bifurc("traced()")
    assert np.ptp(said["path"], axis=0) == pytest.approx(np.zeros(3), abs=1e-9)
    assert picture_of(shown) != before


def test_a_list_of_configurations_has_no_path(show):
    shown = show("rigid", trace=("12:0.1,0.2",))
    (said,) = shown.bifurc("traced()")
    assert said["path"] == []
    assert len(said["place"]) == 3
    assert shown.messages == []


def test_a_point_of_no_body_is_refused(atlas_of):
    with pytest.raises(GeometryError, match="frame, crank, rod, slider"):
        make_view_document(atlas_of("slider-crank"), trace=["rud:1,2"])


def test_map_and_view_take_points_and_refuse_others(tmp_path):
    run = CliRunner().invoke
    words = ["map", "four-bar", "--format", "svg", "--trace", "23:1,0.5"]
    result = run(main, [*words, "--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    for name in ("map.html", "linkage.svg"):
        assert "23:1,0.5" in (tmp_path / name).read_text(encoding="utf-8")
    for others in ([], ["--out", str(tmp_path), "--trace", "29:1,0.5"]):
        result = run(main, [*words, *others])
        assert result.exit_code != 0
        assert "trace" in result.output
    page = tmp_path / "page.html"
    view = ["view", str(tmp_path / "atlas.nc"), "--no-open", "--out", str(page)]
    result = run(main, [*view, "--trace", "23:1,0.5"])
    assert result.exit_code == 0, result.output
    assert '"name": "23:1,0.5"' in page.read_text(encoding="utf-8")
    page.unlink()
    result = run(main, [*view, "--trace", "29:1,0.5"])
    assert "12, 23, 34, 41" in result.output
    assert not page.exists()
