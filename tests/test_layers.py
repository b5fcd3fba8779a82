"""Data flows one way: studies know linkages, linkages know bifurc, and never the other
way round."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FORBIDDEN = {"bifurc": {"linkages", "studies"}, "linkages": {"studies"}}
MODULES = [
    (package, path)
    for package in FORBIDDEN
    for path in sorted((ROOT / package).glob("**/*.py"))
]


def imported_packages(path):
    """Top-level packages named by any import in a file, also inside functions."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path.name} line {node.lineno}: a relative import"
            yield str(node.module).split(".")[0]
        elif isinstance(node, ast.Call) and getattr(node.func, "id", "") in (
            "import_module",
            "__import__",
        ):
            yield from (
                str(arg.value).split(".")[0]
                for arg in node.args
                if isinstance(arg, ast.Constant)
            )


@pytest.mark.parametrize(
    ("package", "path"), MODULES, ids=[f"{p}/{f.name}" for p, f in MODULES]
)
def test_a_module_imports_no_package_above_its_own(package, path):
    assert not FORBIDDEN[package] & set(imported_packages(path))


def test_there_are_modules_to_look_at():
    assert {package for package, _ in MODULES} == set(FORBIDDEN)
    assert len(MODULES) > 20


@pytest.mark.parametrize("package", FORBIDDEN)
def test_a_library_package_never_prints(package):
    for path in (ROOT / package).glob("**/*.py"):
        calls = [
            n
            for n in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            if isinstance(n, ast.Call)
        ]
        assert not [n.lineno for n in calls if getattr(n.func, "id", "") == "print"], (
            path
        )
