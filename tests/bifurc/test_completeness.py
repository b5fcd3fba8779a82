"""Claims and doubts as records: levels come from them, and words are made of them last."""

import ast
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bifurc.completeness import Claim, Completeness, Level, Scope, completeness_document
from bifurc.files.dataset import from_dataset, to_dataset
from bifurc.search.answer.completeness import SearchClaim, SearchDoubt
from tests.bifurc.drawn_atlas import draw, ring

ROOT = Path(__file__).parents[2]
DATA = {
    "beside": 1e-5,
    "boxes": 12,
    "budget": 2.0,
    "complex": 8,
    "count": 2,
    "curves": 2,
    "degrees": [4, 2],
    "ends": 1,
    "factors": 3,
    "far": 1,
    "forms": 3,
    "inside": 3,
    "least": 1e-6,
    "left": 4,
    "lost": 2,
    "missed": 0.02,
    "multiple": 1,
    "outside": 1,
    "paths": 9,
    "places": [[0.25, 0.5], [1.0, 1.5]],
    "point": "B2",
    "point_kind": "bifurcation",
    "points": ["B1", "B2"],
    "rank": 1,
    "reached": 30,
    "real": 5,
    "reason": "sections disagree",
    "reasons": "too long",
    "residual": 1e-12,
    "rough": 1,
    "rounding": 1e-9,
    "singular": 1,
    "starts": 40,
    "together": 3,
    "trace": 1e-9,
    "unknowns": ["x", "y"],
    "unlisted": 2,
    "weakest": "nothing is missing",
}
# what a program may ask of a text: nothing of those in which claims are put
ASKING = {"startswith", "endswith", "find", "index", "partition", "split", "count"}


def claim(level, scope=Scope.MOTIONS):
    return Claim("test", "so it is", {}, scope, level)


def test_the_level_is_that_of_the_worst_claim():
    claims = (claim(Level.COUNTED), claim(None), claim(Level.CERTIFIED))
    assert Completeness(claims, (), 0.1).level is Level.CERTIFIED
    assert Completeness((claim(None),), (), 0.1).level is Level.ESTIMATED
    assert Completeness((claim(Level.OUT_OF_TIME),), (), 0.1).level is Level.OUT_OF_TIME


def test_what_older_files_call_proved_was_counted():
    assert Level("proved") is Level.COUNTED
    with pytest.raises(ValueError, match="'sure' is not a valid Level"):
        Level("sure")


@pytest.mark.parametrize("level", Level)
def test_a_doubt_leaves_nothing_counted(level):
    doubt = SearchDoubt.TOO_LONG.doubt("form 1")
    doubtful = Completeness((claim(level),), (doubt,), 0.1)
    expected = Level.ESTIMATED if level in ("counted", "certified") else level
    assert doubtful.level is expected
    assert doubtful.is_in_doubt
    assert (
        doubtful.statement == "in doubt: form 1 is longer than it was traced; so it is"
    )


@pytest.mark.parametrize("kind", [*SearchClaim])
def test_every_claim_is_told_by_its_kind_and_put_in_words(kind):
    made = kind.claim(Scope.MOTIONS, Level.COUNTED, **DATA)
    assert [one for one in SearchClaim if one.is_kind_of(made)] == [kind]
    assert "{" not in made.text and made.text


@pytest.mark.parametrize("kind", [*SearchDoubt])
def test_every_doubt_is_put_in_words(kind):
    made = kind.doubt("form 1", 1e-7, **DATA)
    assert "{" not in made.text and made.text


def test_numbers_are_shown_with_their_nouns_and_places_by_the_first():
    one = SearchDoubt.NEAR_MISSES.doubt(amount=1e-3, count=1, rounding=1e-4)
    assert one.text.startswith("1 near miss may be")
    two = SearchDoubt.NEAR_MISSES.doubt(amount=1e-3, count=2, rounding=1e-4)
    assert two.text.startswith("2 near misses may be")
    places = SearchDoubt.UNCERTIFIED.doubt("form 2", places=DATA["places"])
    assert places.text == (
        "form 2 is not certified between s = 0.25 and 0.5 and at 1 more place"
    )


def test_claims_and_doubts_come_back_from_a_dataset():
    claims = tuple(kind.claim(Scope.STARTS, None, **DATA) for kind in SearchClaim)
    doubts = tuple(
        kind.doubt("form 1", np.float64(0.1), **DATA) for kind in SearchDoubt
    )
    completeness = Completeness((*claims, claim(Level.COUNTED)), doubts, 0.25)
    atlas = replace(draw({"ring": ring(0.5)}, {}), completeness=completeness)
    back = from_dataset(to_dataset(atlas)).completeness
    assert back == completeness
    assert back.statement == completeness.statement
    assert back.level is completeness.level


def test_a_document_has_every_claim_and_every_doubt():
    doubt = SearchDoubt.TOO_LONG.doubt("form 1")
    document = completeness_document(
        Completeness((claim(Level.COUNTED),), (doubt,), 0.25)
    )
    assert document["claims"] == [
        {
            "kind": "test",
            "scope": "motions",
            "level": "counted",
            "data": {},
            "text": "so it is",
        }
    ]
    assert document["doubts"][0]["subject"] == "form 1"
    assert document["level"] == "estimated"


def asks_a_statement(node):
    """Whether a call or a comparison asks what is in a statement or a text of one."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
        return node.func.attr in ASKING and is_statement(node.func.value)
    if isinstance(node, ast.Compare):
        is_asked = any(isinstance(op, ast.In | ast.NotIn | ast.Eq) for op in node.ops)
        return is_asked and any(map(is_statement, [node.left, *node.comparators]))
    return False


def is_statement(node):
    name = getattr(node, "attr", getattr(node, "id", ""))
    return name in ("statement", "sentence")


def test_it_would_be_seen_if_a_statement_were_asked():
    for code in (
        "a.statement.startswith('in')",
        "'in' in atlas.completeness.statement",
    ):
        assert any(map(asks_a_statement, ast.walk(ast.parse(code))))


@pytest.mark.parametrize("package", ["bifurc", "linkages", "studies"])
def test_nothing_is_decided_by_a_sentence(package):
    for path in (ROOT / package).glob("**/*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        asking = [node.lineno for node in ast.walk(tree) if asks_a_statement(node)]
        assert not asking, path


@pytest.mark.parametrize("budget", [25, 25.0])
def test_a_number_of_seconds_may_be_whole(budget):
    claim = SearchClaim.OUT_OF_TIME.claim(
        Scope.SEARCH, Level.OUT_OF_TIME, budget=budget, left=4
    )
    assert claim.text == "the budget of 25 s was used up with 4 starts not looked at"
