"""The reference lists what is public; docstrings and studies become readable pages."""

import re
from importlib import import_module

import pytest

from docs.generator.docstrings import escape_marks
from docs.generator.places import DOCS, ROOT
from docs.generator.public_names import public_name
from docs.generator.study_scripts import RUN, gallery_script, study_names


@pytest.mark.parametrize("package", ["bifurc", "linkages"])
def test_the_reference_lists_every_public_name_once(package):
    page = (DOCS / "reference" / f"{package}.md").read_text(encoding="utf-8")
    listed = re.findall(r"^   (\w+)$", page, re.M)
    assert sorted(listed) == sorted(import_module(package).__all__)


def test_a_name_leads_to_its_public_one():
    assert public_name("bifurc.branch.Branch") == "bifurc.Branch"
    assert public_name("Atlas") == "bifurc.Atlas"
    assert public_name("bifurc.search.explore.explore") == "bifurc.explore"
    assert public_name("bifurc.numerics.corrector") is None


def test_marks_in_docstrings_stand_for_themselves():
    assert escape_marks("|F| of `a*b` and x_ * y_1") == r"\|F\| of `a*b` and x\_ \* y_1"


def test_every_study_becomes_a_script_with_a_title():
    names = study_names()
    assert set(names) >= RUN
    for name in names:
        script = gallery_script(name)
        compile(script, name, "exec")
        title, line = script.splitlines()[1:3]
        assert title and line == "=" * len(title)


def test_a_study_that_is_run_calls_its_command():
    script = gallery_script("special_double_subtractive_goldberg")
    assert script.endswith(
        'main(["--out", "out/special_double_subtractive_goldberg"], '
        "standalone_mode=False)\n"
    )
    assert "__main__" not in script


def test_studies_that_are_not_run_say_so():
    assert "does not run this study" in gallery_script("margins")


def test_nothing_that_is_installed_imports_the_generator():
    for package in ("bifurc", "linkages", "studies"):
        for path in (ROOT / package).rglob("*.py"):
            assert "docs.generator" not in path.read_text(encoding="utf-8"), path
