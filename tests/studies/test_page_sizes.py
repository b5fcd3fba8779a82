"""The study of the sizes of pages."""

from linkages.viewing.page import LARGEST, viewer_script
from studies.page_sizes import measure


def test_a_page_is_its_script_and_its_document(tmp_path):
    (size,) = measure(["bennett"], tmp_path)
    script = len(viewer_script().encode("utf-8"))
    assert size.page == (tmp_path / "bennett.html").stat().st_size < LARGEST
    assert 0 < size.page - size.document - script < 2000
    assert size.pieces > 5
