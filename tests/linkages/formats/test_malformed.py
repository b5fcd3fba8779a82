"""Files that are broken anywhere are read, or refused in one line that names the file."""

import random
import re
import warnings
from pathlib import Path

import pytest

from linkages import load
from linkages.closure.closure import Closure
from linkages.file import LinkageFileError
from linkages.files.mechanism_file import mechanism_toml
from linkages.formats.mjcf_writing import mechanism_mjcf
from linkages.formats.sdf_writing import mechanism_sdf
from linkages.mechanisms.mechanism import Mechanism
from linkages.values import GeometryError
from tests.linkages.files.test_drawn_creases import CP, DRAWN, SVG
from tests.linkages.formats.examples import EXAMPLES
from tests.linkages.formats.robot_models import (
    MJCF,
    SDF,
    mjcf_text,
    sdf_text,
)
from tests.linkages.formats.worlds import CASES, world_text

PAGE = Path(__file__).parents[3] / "docs" / "mechanisms.md"
FOLD = """{"vertices_coords": [[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0.5],
 [0.5, 0], [1, 0.5], [0.5, 1], [0, 0.5]],
"faces_vertices": [[0, 5, 4, 8], [5, 1, 6, 4], [6, 2, 7, 4], [7, 3, 8, 4]],
"edges_vertices": [[4, 5], [4, 6], [4, 7], [4, 8]],
"edges_assignment": ["M", "V", "V", "V"],
"edges_foldAngle": [-30, 30, 30, 30]}"""
VALUES = [
    "nan",
    "inf",
    "1e400",
    "1e308",
    "-1",
    "0",
    "x",
    "[]",
    "{}",
    "true",
    "1e-320",
    "é",
    "[1,2]",
    "null",
    "-0.0",
]
VALUES += ["", '""', "1 2 3", "99999999999999999999999"]
SIGNS = "[]{}<>\"'=,;:#/\\ \n0"
TOKEN = re.compile(r"-?\d+\.?\d*(?:e-?\d+)?|\"[^\"]*\"|\w+")
COUNT = 40  # of each kind


def lines_of(text):
    return text.replace("><", ">\n<")


def texts():
    """Sound files, by the ending of their names."""
    page = PAGE.read_text(encoding="utf-8")
    examples = list(EXAMPLES.values())
    tomls = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    return {
        "toml": tomls + [mechanism_toml(one) for one in examples],
        "xml": [mechanism_mjcf(one) for one in examples]
        + [lines_of(mjcf_text(model)) for model in MJCF.values()],
        "sdf": [mechanism_sdf(one) for one in examples]
        + [lines_of(sdf_text(model)) for model in SDF.values()],
        "world": [world_text(case) for case in list(CASES.values())[:6]],
        "fold": [FOLD],
        "cp": [CP],
        "svg": [SVG.format(DRAWN)],
    }


def broken(text, rng):
    """The text with one thing changed, left out, doubled or moved."""
    lines = text.split("\n")
    first, second = rng.randrange(len(lines)), rng.randrange(len(lines))
    tokens = list(TOKEN.finditer(text))
    token, other = rng.choice(tokens), rng.choice(tokens)
    place = rng.randrange(len(text))
    match rng.randrange(7):
        case 0:
            return text[: token.start()] + rng.choice(VALUES) + text[token.end() :]
        case 1:
            return text[: token.start()] + other.group() + text[token.end() :]
        case 2:
            return text[:place] + rng.choice(SIGNS) + text[place + 1 :]
        case 3:
            return text[:place]
        case 4:
            lines.pop(first)
        case 5:
            lines.insert(second, lines[first])
        case _:
            lines[first], lines[second] = lines[second], lines[first]
    return "\n".join(lines)


@pytest.mark.parametrize("ending", ["toml", "xml", "sdf", "world", "fold", "cp", "svg"])
def test_a_broken_file_is_read_or_refused_in_one_line(ending, tmp_path):
    rng = random.Random(14)
    sound = texts()[ending]
    path = tmp_path / f"broken.{ending}"
    refused = 0
    for _ in range(COUNT):
        path.write_text(broken(rng.choice(sound), rng), encoding="utf-8")
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                mechanism = load(path)
                if isinstance(mechanism, Mechanism):
                    Closure(mechanism)
        except LinkageFileError as error:
            assert path.name in str(error)
            assert "\n" not in str(error)
            refused += 1
        except GeometryError as error:  # of what is closed, and rigid
            assert "\n" not in str(error)
            refused += 1
    assert refused >= COUNT // 2
    assert list(tmp_path.iterdir()) == [path]
