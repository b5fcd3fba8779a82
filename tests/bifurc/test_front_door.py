"""The front door of bifurc: every public name opens, and none is opened before it is
asked for."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import bifurc

STUB = Path(bifurc.__file__).with_suffix(".pyi")
HEAVY = ("matplotlib", "networkx", "scipy", "sympy", "xarray")


def public_names():
    """The names that the stub re-exports."""
    statements = ast.parse(STUB.read_text(encoding="utf-8")).body
    imports = [node for node in statements if isinstance(node, ast.ImportFrom)]
    return [alias.asname for node in imports for alias in node.names]


@pytest.mark.parametrize("name", public_names())
def test_a_public_name_opens_and_says_what_it_is(name):
    assert getattr(bifurc, name).__doc__


def test_what_python_lists_is_what_the_stub_says():
    assert sorted(bifurc.__all__) == sorted(public_names())
    assert set(public_names()) <= set(dir(bifurc))


def test_a_class_of_the_stub_documents_its_public_methods():
    for name in public_names():
        thing = getattr(bifurc, name)
        if not isinstance(thing, type):
            continue
        own = {key: value for key, value in vars(thing).items() if key[0] != "_"}
        functions = [key for key, value in own.items() if callable(value)]
        undocumented = [key for key in functions if not own[key].__doc__]
        assert not undocumented, f"{name}: {undocumented}"


def test_importing_bifurc_alone_imports_nothing_heavy():
    script = f"import sys, bifurc; print([m for m in {HEAVY} if m in sys.modules])"
    result = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stderr
    assert result.stdout.strip() == "[]"
