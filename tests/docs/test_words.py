"""Words of results as links to what they mean."""

from docutils import nodes

from docs.generator.places import DOCS
from docs.generator.words import linked, pattern_of, terms_of

WORDS = (DOCS / "words.md").read_text(encoding="utf-8")


def test_the_first_of_each_word_is_a_link_to_its_definition():
    text = "2 forms, no form.\nRigid assemblies, near misses (no bifurcation), deform"
    seen = set()
    parts = linked(text, pattern_of(terms_of(WORDS)), "words.html", seen)
    assert "".join(part.astext() for part in parts) == text
    links = [part for part in parts if isinstance(part, nodes.reference)]
    assert [(link.astext(), link["refuri"]) for link in links] == [
        ("forms", "words.html#word-form"),
        ("Rigid assemblies", "words.html#word-rigid-assembly"),
        ("near misses", "words.html#word-near-miss"),
        ("bifurcation", "words.html#word-bifurcation"),
    ]
    assert seen == {"form", "rigid assembly", "near miss", "bifurcation"}


def test_what_a_search_finds_has_a_definition():
    wanted = {"form", "component", "mobility", "rank drop", "near motion", "surface"}
    assert wanted <= set(terms_of(WORDS))
