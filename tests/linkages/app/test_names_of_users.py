"""Names may hold anything: a command ends in a line or a figure."""

import pytest
from click.testing import CliRunner

from linkages.app.cli import LONGEST, in_one_line, main

NAMES = [
    "$x^$",
    r"$\frac{$",
    "$^$",
    "a$b",
    "\u202eabc",
    "\u05d0\u05d1",
    "{}%s",
    "_" * 10_000,
    "tab\there",
    "\\",
    "&<>'",
]


def escaped(name):
    return "".join(f"\\u{ord(letter):04x}" for letter in name)


@pytest.mark.parametrize("name", NAMES)
def test_names_of_events_units_and_equations_may_be_anything(tmp_path, name):
    path, text = tmp_path / "names.toml", escaped(name)
    path.write_text(
        f"""name = "{text}"
        parameter = "p"
        [unknowns]
        x = {{ bounds = [-2, 2], unit = "{text}" }}
        p = [-2, 2]
        [equations]
        "{text}" = "x^2 + p^2 - 1"
        [events]
        "{text}" = "x - 0.5"
        """
    )
    out = tmp_path / "out"
    result = CliRunner().invoke(main, ["solve", str(path), "--out", str(out)])
    assert result.exit_code == 0, result.output
    assert (out / "diagram.png").stat().st_size > 1000


@pytest.mark.parametrize("name", NAMES)
def test_an_error_is_one_line_that_can_be_printed(tmp_path, name):
    path = tmp_path / "names.toml"
    path.write_text(
        f'equations = ["{escaped(name)}"]\n[unknowns]\nx = [0, 1]\ny = [0, 1]'
    )
    result = CliRunner().invoke(main, ["solve", str(path)])
    (line,) = result.stderr.splitlines()
    assert result.exit_code == 2
    assert line.isprintable() and len(line) <= LONGEST + len("Error: ")


def test_a_long_error_keeps_its_beginning_and_its_end():
    line = in_one_line("equations.1: '" + "x+" * 1000 + "': no symbol at column 7")
    assert len(line) <= LONGEST
    assert line.startswith("equations.1: ") and line.endswith("at column 7")
