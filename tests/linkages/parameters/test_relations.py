"""Relations of parameters at which maps change: found, checked, and none made up."""

import mpmath
import numpy as np
import pytest

from bifurc.following.rest_problem import rest_problems
from bifurc.following.singular_problem import SingularPointProblem
from bifurc.limits import Deadline
from bifurc.settings import SearchSettings
from linkages.app.texts.parameters_text import changes_document, describe_changes
from linkages.catalogue import entry
from linkages.mapping import map_linkage
from linkages.parameters import relations
from linkages.parameters.members import Members
from linkages.parameters.relations import precise_changes
from linkages.parameters.special import ChangeKind, MapChange, SpecialValues

NEVER = Deadline(float("inf"))
PI = np.pi


@pytest.fixture(autouse=True)
def _few_members(monkeypatch):
    monkeypatch.setattr(relations, "CHECKED", 3)


def members(name, free, low, high, **values):
    family = entry(name)
    return Members(family, {**family.defaults, **values}, {free: (low, high)})


def change_of(problem):
    points, gaps = problem.project(problem.start[None])
    assert gaps[0] < 1e-13
    value = float(problem.place(points[0])[1][0])
    return MapChange(
        value, 1e-15, ChangeKind.SINGULAR, None, problem=problem, solution=points[0]
    )


def singular(chosen, u):
    return change_of(
        SingularPointProblem(chosen.problem, np.array(u), chosen.start, nullity=2)
    )


def relation_of(chosen, change):
    (precise,) = precise_changes(chosen, [change], NEVER)
    return precise.relation


@pytest.mark.parametrize(
    ("name", "free", "value", "u", "text"),
    [
        ("four-bar", "d", 3.4, (0, PI, 0, PI), "a + d = b + c"),
        ("four-bar", "d", 1.4, (PI, 0, PI, 0), "a + b = c + d"),
        ("bennett", "alpha", np.radians(40), (PI, PI, PI, PI), "alpha = beta"),
        (
            "spherical-four-bar",
            "alpha12",
            np.radians(105),
            (0, 0, 0, 0),
            "alpha12 + alpha23 + alpha34 + alpha41 = 2 pi",
        ),
    ],
)
def test_links_in_one_line_have_lengths_or_arcs_that_add_up(name, free, value, u, text):
    chosen = members(name, free, 0.1, 6.0, **{free: value})
    relation = relation_of(chosen, singular(chosen, u))
    assert relation.text == text
    assert (relation.held, relation.members) == (3, 3)
    assert relation.digits >= 45


def test_the_condition_of_a_bennett_form_is_found_and_its_value_to_50_digits():
    """Song 2013, eq. (5.2.25)."""
    alpha, beta, delta = np.radians([125, 60, 45]).tolist()
    low, high = np.radians([14.0, 14.4])
    twists = {"alpha": alpha, "beta": beta, "gamma": 0.247, "delta": delta}
    chosen = members("double-subtractive-goldberg", "gamma", low, high, **twists)
    settings = SearchSettings(certify=False)
    atlas = map_linkage(chosen.load(chosen.start), settings=settings)
    (form,) = [one for one in atlas.forms if one.name.startswith("Form II ")]
    problem, _ = rest_problems(chosen.problem, form.branch, chosen.start, 0.1)
    (precise,) = precise_changes(chosen, [change_of(problem)], NEVER)
    assert precise.relation.text == (
        "tan(alpha/2) tan(gamma/2) = tan(beta/2) tan(delta/2)"
    )
    assert (precise.relation.held, precise.relation.members) == (3, 3)
    with mpmath.workdps(60):
        tangents = [mpmath.tan(mpmath.mpf(x) / 2) for x in (beta, delta, alpha)]
        gamma = 2 * mpmath.atan(tangents[0] * tangents[1] / tangents[2])
        assert abs(mpmath.mpf(precise.value) - gamma) < mpmath.mpf(10) ** -49


def test_six_bifurcations_begin_where_a_sum_of_sines_is_zero(monkeypatch):
    """K_d of Forms III and IV vanishes there, and joints 1 and 2 rest."""
    *_, sums = relations._products_with_sums([], ["alpha", "gamma", "delta"])
    monkeypatch.setattr(relations, "_shapes", lambda family, free: [sums])
    chosen = members("double-subtractive-goldberg", "delta", 0.5, 0.6, delta=0.5687)
    change = singular(chosen, (PI, PI, 2.2652, -2.2308, -2.2308, 2.2652))
    assert change.value == pytest.approx(0.5686571242643, abs=1e-12)
    relation = relation_of(chosen, change)
    assert relation.text == (
        "sin(alpha) + sin(alpha - gamma - delta) = sin(gamma) + sin(delta)"
    )
    assert (relation.held, relation.members) == (3, 3)


def test_sums_and_differences_stand_in_products():
    names = {"a": 1.2, "b": 0.7, "alpha": 0.4, "beta": 1.1}
    products, *_ = relations._products_with_sums(["a", "b"], ["alpha", "beta"])
    values = dict(
        zip([term.text for term in products.terms], products.terms, strict=True)
    )
    assert values["(a - b)"].value(names) == pytest.approx(0.5)
    assert float(values["sin(alpha + beta)"].value(names)) == pytest.approx(np.sin(1.5))


def test_what_follows_no_simple_relation_has_none(monkeypatch):
    # products and polynomials of many terms take seconds
    monkeypatch.setattr(relations, "MOST_TERMS", 8)
    monkeypatch.setattr(relations, "MOST_ANGLES", 3)
    chosen = members("reconfigurable-bricard-1", "alpha", 0.25, 0.4, alpha=0.3127)
    # a rank drop
    u = [0.867, 2.605, -0.145, 0.867, 2.605, -0.145]
    change = singular(chosen, u)
    assert change.value == pytest.approx(0.3126978667970, abs=1e-12)
    (precise,) = precise_changes(chosen, [change], NEVER)
    assert precise.relation is None
    assert precise.value.startswith("0.31269786679708")


def test_a_relation_that_holds_at_one_member_by_chance_is_not_proposed(monkeypatch):
    chosen = members("four-bar", "d", 0.1, 6.0, d=3.4)
    change = singular(chosen, (0, PI, 0, PI))
    wrong = [1, -2, 1, -1]
    lengths = next(relations._shapes(chosen.family, "d"))
    monkeypatch.setattr(relations, "_shapes", lambda family, free: [lengths])
    monkeypatch.setattr(relations, "_whole_numbers", lambda *arguments: wrong)
    assert relation_of(chosen, change) is None


def test_a_search_without_time_looks_for_none():
    chosen = members("four-bar", "d", 0.1, 6.0, d=3.4)
    change = singular(chosen, (0, PI, 0, PI))
    assert precise_changes(chosen, [change], Deadline(0.0)) == []


def test_ctrl_c_keeps_what_is_known(monkeypatch):
    answers = iter([None])

    def interrupted(*_):
        try:
            return next(answers)
        except StopIteration:
            raise KeyboardInterrupt from None

    monkeypatch.setattr(relations, "_precise_change", interrupted)
    chosen = members("four-bar", "d", 0.1, 6.0, d=3.4)
    change = singular(chosen, (0, PI, 0, PI))
    assert precise_changes(chosen, [change, change], NEVER) == [None]


def test_a_relation_stands_under_its_value():
    chosen = members("four-bar", "d", 0.1, 6.0, d=3.4)
    change = singular(chosen, (0, PI, 0, PI))
    special = SpecialValues((change, change), True, 0.1)
    precise = precise_changes(chosen, [change], NEVER)
    text = describe_changes(chosen, "", special, precise)
    assert "  a + d = b + c; holds for 3 of 3 random members to 50 digits" in text
    assert text.count("no relation was looked for: the time was over") == 1
    first, second = changes_document(chosen, special, precise)["changes"]
    assert first["relation"]["text"] == "a + d = b + c"
    assert first["precise"].startswith("3.39999999999999991118")  # 2.4 is a double
    assert (second["precise"], second["relation"]) == (None, None)
