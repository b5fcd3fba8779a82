"""The command `export` with printable parts."""

import pytest
from click.testing import CliRunner

from linkages.app.cli import main
from linkages.app.exit_codes import ExitCode
from linkages.app.reports import printing
from linkages.printing import seating


def export(*arguments):
    return CliRunner().invoke(main, ["export", *map(str, arguments)])


@pytest.fixture
def cad(monkeypatch):
    """Input is checked, and seats are chosen, without what makes solids."""
    monkeypatch.setattr(printing, "find_spec", lambda name: name)


def assert_refused(result, out, *words):
    assert result.exit_code == ExitCode.BAD_INPUT
    assert len(result.stderr.splitlines()) == 1
    for word in words:
        assert word in result.stderr
    assert not out.exists()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--diameter", 0), ["--diameter", "0"]),
        (("--diameter", -2), ["--diameter", "-2"]),
        (("--diameter", "nan"), ["--diameter", "nan"]),
        (("--diameter", "thick"), ["--diameter", "thick"]),
        (("--diameter", 2), ["diameter", "2 mm", "at least 2.4 mm"]),
        (("--diameter", 100), ["--diameter", "100 mm", "less than 100 mm"]),
        (("--play", 0), ["--play"]),
        (("--wall", -1), ["--wall"]),
        (("--size", 0), ["--size"]),
        (("--size", 1e9), ["mean length of a link", "1e+09", "10000"]),
        (("--size", 50, "--unit", "cm"), ["--size", "--unit"]),
        (("--unit", "mm"), ["mean length of a link", "from 1 to 10000 mm"]),
        (("--unit", "mile"), ["--unit", "mile"]),
        (("--offsets", "1,2,3"), ["--offsets", "4 numbers"]),
        (("--offsets", "1,2,3,x"), ["--offsets", "4 numbers"]),
        (("--offsets", "1,2,3,nan"), ["--offsets", "4 numbers"]),
        (("--offsets", "1,2,3,1e9"), ["--offsets", "-1000 to 1000"]),
        (("--form", "Form 9"), ["--form", "'Bennett form'"]),
        (("--route", "1", "1"), ["--route", "has no effect on"]),
    ],
)
@pytest.mark.parametrize("ending", ["stl", "step"])
def test_bad_input_is_refused_in_a_line(options, words, ending, cad, tmp_path):
    out = tmp_path / f"bennett.{ending}"
    assert_refused(export("bennett", "--to", out, *options), out, *words)


def test_the_extra_that_is_missing_is_named(monkeypatch, tmp_path):
    monkeypatch.setattr(printing, "find_spec", lambda name: None)
    out = tmp_path / "bennett.stl"
    result = export("bennett", "--to", out)
    assert_refused(result, out, "build123d", "pip install 'bifurc[cad]'")


def test_options_of_parts_are_refused_for_other_files(tmp_path):
    out = tmp_path / "bennett.glb"
    assert_refused(export("bennett", "--to", out, "--play", 0.2), out, "--play")


def test_nothing_is_written_where_no_seats_are_seen(cad, monkeypatch, tmp_path):
    monkeypatch.setattr(seating, "REACHES", (0.25,))
    monkeypatch.setattr(seating, "ROUNDS", 2)
    out = tmp_path / "bennett.stl"
    result = export("bennett", "--to", out, "--diameter", 60)
    assert result.exit_code == ExitCode.PARTS_MEET
    assert "no offsets up to" in result.stderr
    assert "deg along Bennett form" in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert "joint angles (deg)" in result.stdout
    assert not out.exists()


def test_parts_are_written_with_offsets_that_keep_them_apart_and_also_with_others(
    tmp_path,
):
    pytest.importorskip("build123d", reason="solids need the extra 'cad'")
    out = tmp_path / "bennett.stl"
    result = export("bennett", "--to", out, "--offsets", "20.03,-12.42,24.67,-23.11")
    assert result.exit_code == ExitCode.DONE
    assert f"wrote {out}" in result.stderr
    assert "Outside hinges parts keep 0.3" in result.stdout
    assert "link 41, link 12, cap" in result.stdout
    laid_out = out.read_bytes()
    assert int.from_bytes(laid_out[80:84], "little") * 50 + 84 == len(laid_out)
    out = tmp_path / "bennett.step"
    result = export("bennett", "--to", out, "--offsets", "0,0,0,0")
    assert result.exit_code == ExitCode.PARTS_MEET
    assert out.read_text().startswith("ISO-10303-21;")
    assert "link 12 and link 34" in result.stdout
    assert "--offsets: parts do not keep 0.3 mm apart" in result.stderr
