"""Every number of a summary, a document or a dataset stands in docs/results.md with the
function that makes it."""

import re
from collections import defaultdict
from dataclasses import replace
from functools import cache
from importlib import import_module

import numpy as np
import pytest

from bifurc.settings import SearchSettings
from bifurc.singular.point import Kind
from bifurc.systems import document as equations_document
from bifurc.systems import summary as equations_summary
from bifurc.systems.equation_file import read_equations
from linkages.app.answer.document import make_document
from linkages.app.texts.summary import make_summary
from linkages.file import read_file
from linkages.loop import Loop
from linkages.networks.entries import NETWORKS
from linkages.networks.mechanism import lock_network
from linkages.subject import subject_at
from studies.results_page import PAGE, numbers, results_page, variables
from tests.linkages.app.slider_cranks import slider_crank_text
from tests.maps import map_of

FEW = SearchSettings(starts=20, charts=40)
LEVEL = (0.0,) * 5
NETWORK = "four-bennett-network"
SURFACE = Loop((1, 1, 1, 1, 1.2), LEVEL, LEVEL)
NEAR = Loop((1, 2, 1, 2), (0.002, 0, 0, 0), LEVEL[:4])
RIGID = Loop(
    (1.5, 0.7, 1.2, 0.9, 1.1, 0.6),
    tuple(np.radians([50, 80, 30, 100, 60, 110])),
    (0.2, -0.3, 0.5, 0.1, -0.4, 0.6),
)
EQUATIONS = """
equations = ["x' = x*(p - x^2)", "y' = -y"]
parameter = "p"
[unknowns]
x = [-2, 2]
y = [-2, 2]
p = [-1, 1]
[events]
half = "x = 1/2"
"""
# what a table of the screen calls after the unknowns or the joints of its subject
NAMES_OF_JOINTS = re.compile(r"\d+|p|x|y|J1, J2, .*")


@cache
def atlases(folder):
    """Maps that have something of every kind between them, the kinds of points that
    are rare by another name."""
    path = folder / "crank.toml"
    path.write_text(slider_crank_text((0.5, 0.8), 1.5))
    locked = lock_network(NETWORKS[NETWORK].build(), {"2": 0.7, "6": -1.3})
    subjects = ["parallelogram", SURFACE, NEAR, RIGID, read_file(path), locked]
    atlases = [map_of(subject, settings=FEW) for subject in subjects]
    drop, cusp = atlases[0].points
    points = (replace(drop, kind=Kind.RANK_DROP), replace(cusp, kind=Kind.CUSP))
    return [*atlases, replace(atlases[0], points=points)]


@cache
def atlas_of_equations(folder):
    path = folder / "equations.toml"
    path.write_text(EQUATIONS)
    return read_equations(path, {}).explore(settings=FEW)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("subjects")


def object_of(name):
    """What stands at a dotted name."""
    module, _, rest = name.rpartition(".")
    try:
        return getattr(import_module(module), rest)
    except ModuleNotFoundError:
        return getattr(object_of(module), rest)


def test_the_page_is_current():
    page = PAGE.read_text(encoding="utf-8")
    assert page == results_page(), "run python -m studies.pages results"


@pytest.mark.parametrize("function", sorted({row.function for row in numbers()}))
def test_what_makes_a_number_is_there(function):
    assert object_of(function) is not None


def test_every_variable_of_a_dataset_has_a_row():
    rows = {name for row in numbers() for name in row.variable.split()}
    assert {one["variable"] for one in variables()} <= rows


def heads_of(monkeypatch, folder):
    """The heads of all columns in the summaries, without units."""
    heads = set()

    def table(names, rows):
        heads.update(names)
        return ""

    for module in ("bifurc.tables", "linkages.app.texts.entry_text"):
        monkeypatch.setattr(f"{module}.table", table)
    for atlas in atlases(folder):
        make_summary(atlas)
        heads.discard(subject_at(atlas).heading(atlas))
    equations_summary.make_summary(atlas_of_equations(folder))
    names = {re.sub(r" \(.*\)$", "", head) for head in heads}
    return {name for name in names if not NAMES_OF_JOINTS.fullmatch(name)}


def test_every_column_of_a_summary_has_a_row(monkeypatch, folder):
    heads = heads_of(monkeypatch, folder)
    assert {"smallest s.v.", "curvature at most", "charts", "unstable"} <= heads
    assert heads <= {head for row in numbers() for head in row.printed.split(", ")}


def unlisted(value, path, keys):
    """The keys of a document that stand in no row, nor any of those around them."""
    if path in keys:
        return set()
    if isinstance(value, dict):
        inner = {f"{path}.{key}".lstrip("."): one for key, one in value.items()}
        return set().union(*(unlisted(one, key, keys) for key, one in inner.items()))
    if isinstance(value, list) and (not value or isinstance(value[0], dict)):
        return set().union(*(unlisted(one, path, keys) for one in value))
    return {path}


def test_every_key_of_a_document_has_a_row(folder):
    keys = {key for row in numbers() for key in row.key.split()}
    documents = [make_document(atlas) for atlas in atlases(folder)]
    lengths = defaultdict(int)
    for document in documents:
        assert unlisted(document, "", keys) == set()
        for key, value in document.items():
            lengths[key] += len(value) if isinstance(value, list) else 1
    assert all(lengths.values()), "something of every kind is looked at"
    document = equations_document.make_document(atlas_of_equations(folder))
    assert unlisted(document, "", keys) == set()
    assert document["diagram"]["stretches"] and document["singular_points"]
