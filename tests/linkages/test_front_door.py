"""`import linkages`: its names are there, explained, and cost nothing until they are
used."""

import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import linkages

ROOT = Path(linkages.__file__).parents[1]


def modules_imported_by(statement):
    """Top-level packages in memory after a statement in a fresh interpreter."""
    code = f"{statement}\nimport sys\nprint(*sys.modules)"
    run = subprocess.run(
        [sys.executable, "-c", code],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    return {name.split(".")[0] for name in run.stdout.split()}


@pytest.mark.parametrize("name", linkages.__all__)
def test_every_public_name_can_be_imported_and_says_what_it_is(name):
    member = getattr(linkages, name)
    assert inspect.getdoc(member)
    assert member.__module__.split(".")[0] == "linkages"


def test_the_public_names_are_those_that_are_declared():
    assert {"Linkage", "Loop", "load", "loop_of", "map_linkage"} <= set(dir(linkages))
    with pytest.raises(AttributeError, match="no_such_name"):
        _ = linkages.no_such_name


def test_the_import_alone_is_light():
    heavy = {"networkx", "xarray", "matplotlib", "scipy", "sympy", "numpy"}
    assert not modules_imported_by("import linkages") & heavy


def test_a_map_as_json_needs_neither_scipy_nor_graphs_figures_symbols_or_datasets():
    statement = """
from click.testing import CliRunner
from linkages.app.cli import main
result = CliRunner().invoke(main, ["map", "special-double-subtractive-goldberg", "--json"])
assert result.exit_code == 0, result.output
"""
    heavy = {"scipy", "networkx", "xarray", "matplotlib", "sympy"}
    assert not modules_imported_by(statement) & heavy


def test_equations_are_solved_without_anything_of_linkages(tmp_path):
    path = tmp_path / "circle.toml"
    path.write_text(
        'equations = ["x^2 + y^2 = 1"]\n[unknowns]\nx = [-2, 2]\ny = [-2, 2]'
    )
    code = f"""
from click.testing import CliRunner
from linkages.app.cli import main
result = CliRunner().invoke(main, ["solve", {str(path)!r}])
assert result.exit_code == 0, result.output
import sys
print(*sys.modules)
"""
    run = subprocess.run(
        [sys.executable, "-c", code],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    loaded = {name for name in run.stdout.split() if name.startswith("linkages.")}
    assert {name.split(".")[1] for name in loaded} == {"app"}


def test_loading_a_linkage_needs_no_symbols_figures_or_datasets():
    statement = "import linkages; linkages.load('bennett')"
    assert not modules_imported_by(statement) & {"sympy", "matplotlib", "xarray"}
