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
    """The names that a stub states, those of a class after a dot. A class has what its
    bases have, of which those with an underscore stand in the stub alone."""
    found = set()
    members = {}
    for node in ast.parse(stub.read_text()).body:
        if isinstance(node, ast.FunctionDef):
            found.add(node.name)
        if isinstance(node, ast.ClassDef):
            own = {
                inner.name
                for inner in node.body
                if isinstance(inner, ast.FunctionDef) and inner.name[:2] != "__"
            }
            values = (inner for inner in node.body if isinstance(inner, ast.Assign))
            own |= {inner.targets[0].id for inner in values}
            bases = (base.id for base in node.bases if isinstance(base, ast.Name))
            members[node.name] = own.union(*(members.get(base, ()) for base in bases))
    for name, own in members.items():
        if name[0] != "_":
            found |= {name, *(f"{name}.{inner}" for inner in own)}
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
