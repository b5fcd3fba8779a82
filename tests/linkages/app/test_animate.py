"""The command `bifurc animate`, and pictures that `bifurc export` and `map` write."""

import sys

import matplotlib
import numpy as np
import pytest
from matplotlib.animation import FFMpegWriter
from PIL import Image, ImageSequence

from tests.linkages.app.test_files import names, run


def frames_of(path) -> list[np.ndarray]:
    with Image.open(path) as image:
        return [
            np.asarray(one.convert("L"), dtype=float)
            for one in ImageSequence.Iterator(image)
        ]


def test_a_form_goes_round_and_comes_back(tmp_path):
    out = tmp_path / "bennett.gif"
    result = run("animate", "bennett", "--out", out, "--count", 9, "--size", "2x2")
    assert result.exit_code == 0, result.stderr
    frames = frames_of(out)
    assert len(frames) >= 8 and frames[0].shape == (200, 200)
    half = len(frames) // 2
    assert np.abs(frames[0] - frames[half]).mean() > 1  # it has moved
    assert np.abs(frames[0] - frames[-1]).mean() < 1  # and is back
    margins = [frame[[0, -1]].min() for frame in frames]
    assert min(margins) > 250  # nothing is cut off


def test_several_forms_are_shown_one_after_another(tmp_path):
    shown = {}
    for words in ((1,), (2,), (1, 2)):
        out = tmp_path / "four_bar.gif"
        forms = [word for form in words for word in ("--form", form)]
        options = (*forms, "--count", 4, "--size", "2x2")
        assert run("animate", "four-bar", *options, "--out", out).exit_code == 0
        shown[words] = len(frames_of(out))
    assert shown[1, 2] == shown[1,] + shown[2,] > shown[1,] > 1


def test_mp4_is_written_by_the_ffmpeg_of_the_extra(tmp_path, monkeypatch):
    ffmpeg = pytest.importorskip("imageio_ffmpeg")
    monkeypatch.setattr(FFMpegWriter, "isAvailable", classmethod(lambda cls: False))
    out = tmp_path / "bennett.mp4"
    options = ("--count", 6, "--size", "2x2", "--out", out)
    with matplotlib.rc_context():
        result = run("animate", "bennett", *options)
    assert result.exit_code == 0, result.stderr
    frames, _ = ffmpeg.count_frames_and_secs(out)
    assert frames == 6


def test_a_route_is_shown_from_its_begin_to_its_end(tmp_path):
    out = tmp_path / "route.gif"
    options = ("--route", "Form I", "Form II", "--count", 5, "--size", "2x2")
    name = "special-double-subtractive-goldberg"
    result = run("animate", name, *options, "--out", out)
    assert result.exit_code == 0, result.stderr
    assert "to Form II" in result.stderr
    assert len(frames_of(out)) == 5


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--out", "a.avi"), ".gif or .mp4"),
        (("--out", "a.gif", "--form", "1", "--route", "a", "b"), "--route"),
        (("--out", "a.gif", "--form", "Form 9"), "Form 9"),
        (("--out", "a.gif", "--size", "0x3"), "inches"),
    ],
)
def test_wrong_options_end_in_one_line(options, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = run("animate", "bennett", *options)
    assert result.exit_code != 0
    assert message in result.stderr and len(result.stderr.splitlines()) == 1
    assert names(tmp_path) == []


def test_mp4_without_ffmpeg_is_said_before_anything_is_computed(tmp_path, monkeypatch):
    monkeypatch.setattr(FFMpegWriter, "isAvailable", classmethod(lambda cls: False))
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    result = run("animate", "bennett", "--out", tmp_path / "a.mp4")
    assert result.exit_code != 0 and "bifurc[movies]" in result.stderr


def test_pictures_are_exported(tmp_path):
    for ending in ("svg", "dxf"):
        out = tmp_path / f"four_bar.{ending}"
        assert run("export", "four-bar", "--to", out, "--form", 2).exit_code == 0
        assert out.stat().st_size > 1000


def test_a_map_has_figures_in_the_formats_that_are_asked_for(tmp_path):
    points = tmp_path / "points.csv"
    points.write_text("theta1,theta2\n10,20\n")
    options = ("--format", "pdf,png", "--size", "3.4x2.6", "--range", "0:360")
    out = tmp_path / "out"
    result = run("map", "bennett", "--out", out, *options, "--overlay", points)
    assert result.exit_code == 0, result.stderr
    figures = {name for name in names(out) if name.endswith(("pdf", "png", "svg"))}
    stems = ("joint_angles", "linkage", "singular_values", "transition_map")
    assert figures == {
        f"{stem}.{ending}" for stem in stems for ending in ("pdf", "png")
    }
    with Image.open(out / "transition_map.png") as image:
        assert image.size == (476, 364)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--size", "3"), "3.4x2.6"),
        (("--format", "gif"), "png, svg, pdf"),
        (("--range", "90:0"), "--range 90:0"),
        (("--form", "Form 9"), "Form 9"),
        (("--overlay", "bad.csv"), "theta1, theta2"),
        (("--overlay", "row.csv"), "row 3"),
        (("--overlay", "none.csv"), "none.csv: it cannot be read (No such file or dir"),
    ],
)
def test_wrong_options_of_figures_end_in_one_line(
    options, message, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad.csv").write_text("a,b\n1,2\n")
    (tmp_path / "row.csv").write_text("theta1,theta2\n1,2\n1,x\n")
    result = run("map", "bennett", "--out", "out", *options)
    assert result.exit_code != 0
    assert message in result.stderr.splitlines()[-1]


def test_options_of_figures_need_a_folder():
    result = run("map", "bennett", "--size", "3x3")
    assert result.exit_code != 0 and "--size" in result.stderr


@pytest.mark.parametrize("ending", ["svg", "dxf"])
def test_what_does_not_move_is_drawn_as_well(ending, tmp_path):
    table = tmp_path / "nearly.toml"
    table.write_text(
        "angles = 'deg'\nlengths = [1, 0.501, 1, 0.501]\n"
        "twists = [90, 30, 90, 30]\noffsets = [0, 0, 0, 0]\n"
    )
    out = tmp_path / f"picture.{ending}"
    result = run("export", table, "--to", out)
    assert result.exit_code == 3
    assert "nearly moves" in result.stderr
    assert out.stat().st_size > 1000
    motion = run("export", table, "--to", tmp_path / "motion.csv")
    assert motion.exit_code == 3
    assert not (tmp_path / "motion.csv").exists()
