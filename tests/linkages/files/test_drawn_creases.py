"""Crease patterns drawn as lines: CP and SVG files."""

import logging

import numpy as np
import pytest

import linkages
from bifurc.singular.locate import locate_singular_point
from linkages.closure.closure import Closure
from linkages.file import LinkageFileError

RIM = "1 0 0 4 0\n1 4 0 4 4\n1 4 4 0 4\n1 0 4 0 0\n"
# the diagonals of a sheet: one that is split where the other one crosses it
CP = RIM + "2 0 0 4 4\n3 4 0 2 2\n2 2 2 0 4\n"
SVG = """<?xml version="1.0"?>
<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "svg11.dtd">
<svg xmlns="http://www.w3.org/2000/svg"><style>.m, .n {{stroke: #F00}}</style>
<defs><line x1="0" y1="0" x2="9" y2="9" stroke="red"/></defs>
<g transform="translate(7, -3) rotate(30) scale(10)">{}</g></svg>"""
LOOSE_TRIANGLE = "2 1 1 3 1\n2 3 1 2 3\n2 2 3 1 1\n"
TRIANGLE_ON_A_CORNER = "2 0 0 3 1\n2 3 1 1 3\n2 1 3 0 0\n"
CUT_ON_FOLD = SVG.format(
    '<line x2="4" stroke="red"/>\n<line x2="4" stroke="lime"/><rect width="4" height="4"/>'
)
DRAWN = """<rect width="4px" height="4" stroke="black"/>
<line x1="0" y1="0" x2="4" y2="4" class="m"/>
<path d="M4 0l-2,2" style="fill:none;stroke:blue"/>
<g stroke="rgb(255, 0, 0)"><polyline points="2,2 0,4"/></g>"""


def read(tmp_path, text, ending):
    path = tmp_path / f"pattern.{ending}"
    path.write_text(text, encoding="utf-8")
    return linkages.load(path)


def creases(mechanism):
    return {one.joint: one.letter for one in mechanism.creases}


def test_lines_of_both_formats_are_one_pattern(tmp_path, caplog):
    cp = read(tmp_path, CP, "cp")
    svg = read(tmp_path, SVG.format(DRAWN), "svg")
    assert creases(cp) == creases(svg)
    assert creases(cp) == {"0-4": "M", "1-4": "V", "2-4": "M", "3-4": "M"}
    assert len(cp.panels) == 4
    assert "split where others meet them: 1" in caplog.text
    assert "beside" not in caplog.text
    # as it is drawn, y downwards: vertex 1 on the right, 3 below
    corners = {corner for panel in cp.panels for corner in panel.corners}
    assert (4.0, 0.0, 0.0) in corners and (0.0, -4.0, 0.0) in corners


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("2 0 0.003 4 4\n", "ends up to 0.003 from each other are one vertex"),
        ("2 0 0 2 2.002\n2 2 2 4 4\n", "up to 0.00141 beside them"),
        ("2 0 0 4 4\n2 1 1 3 3\n", "meet them: 3"),
        ("2 0 0 4 4\n3 3 1 3.001 1\n", "left out, of no length: 1"),
        ("2 0 0 4 4\n4 1 3 8 9\n0 1 3 2 2\n", "meet them: 2"),
    ],
)
def test_what_is_merged_split_and_left_out_is_said(line, said, tmp_path, caplog):
    with caplog.at_level(logging.WARNING):
        mechanism = read(tmp_path, RIM + line + "3 4 0 0 4\n", "cp")
    assert said in caplog.text
    assert len(mechanism.joints) == 4
    assert sorted(creases(mechanism).values()) == ["M", "M", "V", "V"]


def test_lines_that_cross_meet_in_a_vertex(tmp_path):
    mechanism = read(tmp_path, RIM + "2 0 0 4 4\n3 4 0 0 4\n", "cp")
    assert sorted(creases(mechanism).values()) == ["M", "M", "V", "V"]


def test_opacity_is_the_fold_angle(tmp_path, caplog):
    folded = DRAWN.replace('class="m"', 'class="m" opacity="0.25"')
    folded = folded.replace("stroke:blue", "stroke:blue; opacity:0.5")
    mechanism = read(tmp_path, SVG.format(folded), "svg")
    assert "the flat state is the reference: edges_foldAngle" in caplog.text
    assert {one.angle for one in mechanism.creases} == {0.0}
    book = """<rect width="4" height="4" stroke="#000"/>
<line x1="1" y1="0" x2="1" y2="4" stroke="red" stroke-opacity=".25"/>
<line x1="3" y1="0" x2="3" y2="4" stroke="blue"/>
<line x1="2" y1="0" x2="2" y2="4" stroke="orange"/>"""
    mechanism = read(tmp_path, SVG.format(book), "svg")
    angles = [one.angle for one in mechanism.creases]
    assert angles == pytest.approx([-0.7853981633974483, 3.141592653589793])
    assert "lines of other colours are no creases: 1 of orange" in caplog.text


@pytest.mark.parametrize(
    ("line", "letters"),
    [
        pytest.param("3 0 0 2 2\n", {"0-4": None}, id="a valley on a mountain"),
        pytest.param(
            "3 0 0 2 2\n2 0 0 2 2\n", {"0-4": None}, id="and a mountain on both"
        ),
        pytest.param("1 0 0 2 2\n", {"0-4": "M"}, id="a boundary on a mountain"),
        pytest.param("3 0 0 4 0\n", {}, id="a valley on the rim"),
    ],
)
def test_of_lines_on_each_other_the_fold_counts(line, letters, tmp_path, caplog):
    given = creases(read(tmp_path, CP, "cp"))
    found = read(tmp_path, CP + line, "cp")
    assert {joint.name for joint in found.joints} == set(given)
    expected = {**given, **letters}
    assert creases(found) == {k: one for k, one in expected.items() if one}
    assert "lines lie on others of another letter" in caplog.text
    assert "line 8 on line" in caplog.text


def test_creases_that_end_inside_of_faces_fold_nothing(tmp_path, caplog):
    given = read(tmp_path, CP, "cp")
    found = read(tmp_path, CP + "2 0 0 1 0.5\n3 2 0.5 2.5 1\n", "cp")
    assert creases(found) == creases(given)
    assert len(found.panels) == len(given.panels)
    assert "end inside of a face fold nothing: 0-5, 6-7" in caplog.text


def test_a_crease_inside_of_one_body_does_not_fold(tmp_path, caplog):
    """Of three creases about a vertex two are flat, so that the third one cannot fold."""
    drawn = """<rect width="4" height="4" stroke="black"/>
    <path d="M0 0L1 1M4 0L1 1" stroke="yellow"/>
    <path d="M1 1L0 4M4 2L2 4" stroke="red"/>"""
    found = read(tmp_path, SVG.format(drawn), "svg")
    assert len(found.joints) == 1
    assert "make both faces one body do not fold" in caplog.text


@pytest.mark.parametrize(
    ("text", "ending", "message"),
    [
        ("", "cp", "lines: none is not allowed"),
        ("1 0 0 1\n", "cp", 'line 1: "1 0 0 1" is not allowed; it must be type x1'),
        ("1 0 0 1 0\n7 0 0 1 1\n", "cp", 'line 2: "7 0 0 1 1"'),
        ("2 0 0 1 x\n", "cp", 'line 1: "x" is not allowed; it must be a number'),
        ("2 0 0 1 1e999\n", "cp", "line 1: inf"),
        ("2 1 1 1 1\n", "cp", "lines: all in one point"),
        (CUT_ON_FOLD, "svg", "C, and M of <line> on line 5 lies on it"),
        (RIM, "cp", "creases: none, of 4 B, is not allowed"),
        (RIM + LOOSE_TRIANGLE, "cp", "vertex 4: inside of face f0"),
        (RIM + TRIANGLE_ON_A_CORNER, "cp", "edges at vertex: 0"),
        ("<svg><g></svg>", "svg", "mismatched tag"),
        ("<html/>", "svg", "first element, line 1: <html>"),
        (SVG.format('<path d="M0 0C1 1 2 2 3 3" stroke="red"/>'), "svg", '"C"'),
        (SVG.format('<path d="M0 0 Z 4" stroke="red"/>'), "svg", '""'),
        (
            SVG.format('<path d="M0 0 L4" stroke="red"/>'),
            "svg",
            "d of <path> on line 5",
        ),
        (SVG.format('<circle r="3" stroke="red"/>'), "svg", "<circle> on line 5: red"),
        (SVG.format('<g transform="skewX(3)"/>'), "svg", '"skewX"'),
        (SVG.format('<line x2="1" stroke="red" opacity="7"/>'), "svg", "from 0 to 1"),
        (SVG.format('<polygon points="1 2 3" stroke="red"/>'), "svg", "pairs of"),
    ],
)
def test_a_file_that_is_no_pattern_is_refused_in_one_line(
    text, ending, message, tmp_path
):
    with pytest.raises(LinkageFileError) as error:
        read(tmp_path, text, ending)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_creases_that_meet_nowhere_are_located_without_equations(tmp_path):
    strip = RIM + "2 1 0 1 4\n3 2 0 2 4\n"
    problem = Closure(read(tmp_path, strip, "cp"))
    flat = np.zeros(2)
    assert problem.residuals(flat[None]).shape == (1, 0)
    located = locate_singular_point(problem, flat, 2, 0.5)
    assert located is not None
    assert located.u == pytest.approx(flat)
