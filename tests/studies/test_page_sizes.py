"""The study of the sizes of pages."""

from linkages.catalogue import catalogue
from linkages.viewing.page import LARGEST, viewer_script
from studies.page_sizes import PAGE, describe, measure


def test_a_page_is_its_script_and_its_document(tmp_path):
    (size,) = measure(["bennett"], tmp_path)
    script = len(viewer_script().encode("utf-8"))
    assert size.page == (tmp_path / "bennett.html").stat().st_size < LARGEST
    assert 0 < size.page - size.document - script < 2000
    assert size.pieces > 5


def test_the_page_of_the_docs_lists_every_linkage():
    (size,) = measure(["bennett"])
    page = PAGE.read_text(encoding="utf-8")
    for name in catalogue():
        assert f"  {name} " in page
    assert describe([size]).splitlines()[0].split() == page.splitlines()[6].split()
