"""The stubs of the compiled modules name what these have, and their parameters."""

import ast
import importlib
from pathlib import Path

import pytest

import bifurc
import linkages


def stub_of(package):
    """{name: parameters} of the functions in a stub."""
    text = Path(package.__file__).with_name("_core.pyi").read_text("utf-8")
    functions = {}
    for node in ast.parse(text).body:
        if isinstance(node, ast.FunctionDef):
            functions[node.name] = [argument.arg for argument in node.args.args]
    return functions


@pytest.mark.parametrize("package", [bifurc, linkages], ids=lambda each: each.__name__)
def test_the_stub_names_the_functions_of_the_compiled_module(package):
    module = importlib.import_module(f"{package.__name__}._core")
    compiled = {name for name in dir(module) if not name.startswith("_")}
    assert compiled == set(stub_of(package))


@pytest.mark.parametrize("package", [bifurc, linkages], ids=lambda each: each.__name__)
def test_the_stub_names_the_parameters_of_every_function(package):
    module = importlib.import_module(f"{package.__name__}._core")
    for name, parameters in stub_of(package).items():
        signature = getattr(module, name).__doc__.splitlines()[0]
        for parameter in parameters:
            assert f"{parameter}: " in signature, f"{name}: {parameter}"
        assert signature.count(": ") == len(parameters), name
