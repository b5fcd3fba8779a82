"""A folder of crease patterns is answered file by file."""

import csv
import json

from click.testing import CliRunner

from studies.crease_patterns import Answer, describe, main

# a vertex of degree 4 in the middle of a square, folded along its diagonals
CORNERS = [[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0.5]]
SIDES = [[0, 1], [1, 2], [2, 3], [3, 0]]
CREASES = [[0, 4], [1, 4], [2, 4], [3, 4]]
PATTERN = {
    "vertices_coords": CORNERS,
    "edges_vertices": SIDES + CREASES,
    "edges_assignment": [*"BBBB", *"UUUU"],
    "faces_vertices": [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
}


def test_a_folder_is_answered(tmp_path):
    (tmp_path / "cross.fold").write_text(json.dumps(PATTERN))
    (tmp_path / "broken.fold").write_text("{")
    (tmp_path / "notes.txt").write_text("no pattern")
    table = tmp_path / "table.csv"
    arguments = ["--from", str(tmp_path), "--budget", "20", "--out", str(table)]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 0, result.output
    assert "1 of 2 files are answered" in result.output
    assert "broken.fold (0 faces" in result.output
    with table.open(newline="") as file:
        rows = {row["file"]: row for row in csv.DictReader(file)}
    assert rows["cross.fold"]["faces"] == "4"
    assert "moves with mobility 1" in rows["cross.fold"]["says"]


def test_what_ends_late_is_told():
    late = Answer("a.fold", 9, 0, "It moves.", 11.0, 10.0)
    text = describe([late], 10.0)
    assert "1 of 1 files are answered, and 1 end more than 5% after" in text
    assert "a.fold (9 faces, 11.0 s): It moves." in text
