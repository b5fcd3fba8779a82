"""Flow charts are read and drawn."""

import re
import xml.etree.ElementTree as tree

import pytest

from docs.generator.flow_chart import chart_svg, read_chart
from docs.generator.places import DOCS

TEXT = """graph LR
  A["first<br/>box"] --> B["second"]
  B --> C["a < b"]
  A --> C"""


def test_boxes_and_arrows_are_read():
    chart = read_chart(TEXT)
    assert chart.texts == {"A": ["first", "box"], "B": ["second"], "C": ["a < b"]}
    assert chart.arrows == [("A", "B"), ("B", "C"), ("A", "C")]


def test_a_chart_is_an_svg_with_a_box_for_each_key():
    drawing = tree.fromstring(chart_svg(read_chart(TEXT)))
    assert len(drawing.findall("rect")) == 3
    assert [text.text for text in drawing.findall("text")][-1] == "a < b"
    tops = [float(box.get("y")) for box in drawing.findall("rect")]
    assert tops == sorted(set(tops))  # a row each


@pytest.mark.parametrize("text", ["graph TD\n A --> B", "graph LR\n A --> B -.- C"])
def test_what_is_no_chart_is_refused(text):
    with pytest.raises(ValueError, match="flow chart"):
        read_chart(text)


def test_the_charts_of_the_pages_can_be_drawn():
    page = (DOCS / "architecture.md").read_text(encoding="utf-8")
    (text,) = re.findall(r"^```mermaid\n(.*?)^```", page, re.M | re.S)
    assert chart_svg(read_chart(text)).count("<rect") == 12
