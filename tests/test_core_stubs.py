"""The stubs of both compiled cores."""

import ast
import inspect
from pathlib import Path

import pytest

import bifurc
import linkages
from bifurc import _core
from linkages import _core as linkages_core


def names_in(stub):
    """The names that a stub states, those of a class after a dot."""
    found = set()
    for node in ast.parse(stub.read_text()).body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            found.add(node.name)
        if isinstance(node, ast.ClassDef):
            found |= {
                f"{node.name}.{inner.name}"
                for inner in node.body
                if isinstance(inner, ast.FunctionDef) and inner.name[:2] != "__"
            }
            members = (inner for inner in node.body if isinstance(inner, ast.Assign))
            found |= {f"{node.name}.{inner.targets[0].id}" for inner in members}
    return found


def names_of(module):
    found = {name for name in dir(module) if not name.startswith("_")}
    for name, value in inspect.getmembers(module, inspect.isclass):
        found |= {f"{name}.{inner}" for inner in dir(value) if inner[0] != "_"}
    return found


@pytest.mark.parametrize(
    ("package", "module"), [(bifurc, _core), (linkages, linkages_core)]
)
def test_the_stub_states_what_the_module_has(package, module):
    stub = Path(package.__file__).with_name("_core.pyi")
    assert names_in(stub) == names_of(module)
