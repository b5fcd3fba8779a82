"""Data flows one way: studies know linkages, linkages know bifurc, and never the other
way round; no module leads back to itself, however it imports; and every module knows
its own row of the table in docs/architecture.md and the rows above it."""

import ast
import re
from functools import cache
from pathlib import Path

import networkx as nx
import pytest

import bifurc
import linkages

ROOT = Path(__file__).parents[1]
PACKAGES = ("bifurc", "linkages", "studies")
FORBIDDEN = {"bifurc": {"linkages", "studies"}, "linkages": {"studies"}}


def name_of(path):
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def source(path):
    return ast.parse(path.read_text(encoding="utf-8"))


MODULES = {
    name_of(path): path
    for package in PACKAGES
    for path in sorted((ROOT / package).glob("**/*.py"))
}


@cache
def imported_modules(path):
    """Modules named by any import in a file, also inside functions and for types. The
    trees are not kept: the collector would walk through all of them."""
    return list(_imported_modules(path))


def _imported_modules(path):
    for node in ast.walk(source(path)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path.name} line {node.lineno}: a relative import"
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                yield inner if inner in MODULES else node.module
        elif isinstance(node, ast.Call) and calls_import(node):
            constants = [a.value for a in node.args if isinstance(a, ast.Constant)]
            yield from map(str, constants)


def calls_import(node):
    name = getattr(node.func, "id", getattr(node.func, "attr", ""))
    return name in ("import_module", "__import__")


def rows_of_rooms():
    """The rooms of each row of the table in docs/architecture.md, as dotted names."""
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    table = page.partition("## The rooms")[2].partition("### ")[0]
    rows = [line.split("|")[1] for line in table.splitlines() if line.startswith("| `")]
    return [
        [room.rstrip("/").replace("/", ".") for room in re.findall(r"`([^`]+)`", row)]
        for row in rows
    ]


ROW_OF_ROOM = {room: n for n, row in enumerate(rows_of_rooms()) for room in row}


def row_of(name):
    """The number of the row that names a module, or else the nearest folder that it is
    in; None where there is none."""
    while name and name not in ROW_OF_ROOM:
        name = name.rpartition(".")[0]
    return ROW_OF_ROOM.get(name)


IN_ROWS = {
    name
    for name, path in MODULES.items()
    if not name.startswith("studies") and path.name != "__init__.py"
}


def test_a_module_knows_its_own_row_of_rooms_and_those_above_it():
    nowhere = [name for name in IN_ROWS if row_of(name) is None]
    assert nowhere == [], "they stand in no row of docs/architecture.md"
    below = {
        (name, module)
        for name in IN_ROWS
        for module in imported_modules(MODULES[name])
        if module in IN_ROWS and row_of(module) > row_of(name)
    }
    assert below == set()


def test_every_row_of_rooms_names_modules_or_folders_that_there_are():
    rooms = {module.rpartition(".")[0] for module in MODULES} | MODULES.keys()
    assert ROW_OF_ROOM.keys() <= rooms
    assert sum(map(len, rows_of_rooms())) == len(ROW_OF_ROOM)


def test_a_module_imports_no_package_above_its_own():
    above = {
        (name, module)
        for name, path in MODULES.items()
        for module in imported_modules(path)
        if module.split(".")[0] in FORBIDDEN.get(name.split(".")[0], ())
    }
    assert above == set()


def test_no_module_leads_back_to_itself_by_any_kind_of_import():
    graph = nx.DiGraph(
        (name, module)
        for name, path in MODULES.items()
        for module in imported_modules(path)
        if module in MODULES
    )
    circles = [c for c in nx.strongly_connected_components(graph) if len(c) > 1]
    assert circles == []
    assert graph.number_of_edges() > 100


def test_the_front_doors_import_no_module_before_it_is_used():
    for package in ("bifurc", "linkages"):
        assert not set(imported_modules(MODULES[package])) & set(MODULES)


STUDIES = [name for name in MODULES if name.startswith("studies.")]


@pytest.mark.parametrize("name", STUDIES)
def test_a_study_takes_public_names_from_the_front_doors(name):
    doors = {"bifurc": set(bifurc.__all__), "linkages": set(linkages.__all__)}
    for node in ast.walk(source(MODULES[name])):
        if isinstance(node, ast.ImportFrom):
            package, _, inner = node.module.partition(".")
            names = {alias.name for alias in node.names}
            assert not inner or not names & doors.get(package, set()), node.lineno


def test_tests_of_bifurc_know_no_linkage_by_any_chain_of_imports():
    tests = {name_of(path): path for path in (ROOT / "tests").glob("**/*.py")}
    graph = nx.DiGraph(
        (name, "linkages" if module.startswith("linkages.") else module)
        for name, path in (tests | MODULES).items()
        for module in imported_modules(path)
    )
    knowing = nx.ancestors(graph, "linkages")
    assert "tests.linkages.conftest" in knowing
    assert not [name for name in knowing if name.startswith("tests.bifurc.")]


@pytest.mark.parametrize("package", ("bifurc", "linkages"))
def test_the_tests_stand_in_folders_of_the_same_names(package):
    rooms = {p.parent.relative_to(ROOT) for p in (ROOT / package).glob("**/*.py")}
    for test in (ROOT / "tests" / package).glob("**/test_*.py"):
        assert test.parent.relative_to(ROOT / "tests") in rooms, test
