"""The examples in the docstrings of public names: every public function has one, and each
does what it shows."""

import doctest
import inspect

import matplotlib
import pytest

import bifurc
import linkages

WITH_EXAMPLES = ("FunctionProblem", "SymbolicProblem", "Loop")
PUBLIC = {
    name: getattr(package, name)
    for package in (bifurc, linkages)
    for name in package.__all__
    if inspect.isfunction(getattr(package, name)) or name in WITH_EXAMPLES
}


@pytest.mark.parametrize("name", PUBLIC)
def test_an_example_does_what_it_shows(name, tmp_path, monkeypatch):
    if name == "view":
        pytest.importorskip("anywidget")
    monkeypatch.chdir(tmp_path)
    matplotlib.use("Agg")
    finder = doctest.DocTestFinder(recurse=False)
    (example,) = finder.find(PUBLIC[name], name, globs={})
    assert example.examples, "there is no example"
    report: list[str] = []
    failures = doctest.DocTestRunner().run(example, out=report.append)
    assert failures.failed == 0, "".join(report)
