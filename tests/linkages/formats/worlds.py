"""CUIK worlds written from numbers: links, joints and facts of data/cuik_worlds.json."""

import json
from pathlib import Path

DATA = Path(__file__).parents[3] / "data" / "cuik_worlds.json"
CASES = {
    case["name"]: case for case in json.loads(DATA.read_text(encoding="utf-8"))["cases"]
}


def _point(numbers):
    return f"({','.join(repr(number) for number in numbers)})"


def _side(joint, side):
    text = f"{joint['bodies'][side]} {_point(joint['points'][side])}"
    if "axes" in joint:
        text += f"+{_point(joint['axes'][side])}"
    return text


def _joint(joint):
    first, second = _side(joint, 0), _side(joint, 1)
    if joint["kind"] == "rigid":
        turns = zip(("Rx", "Ry", "Rz"), joint["turns_xyz"], strict=True)
        moves = [f"Txyz{_point(joint['points'][0])}", *(f"{n}({a})" for n, a in turns)]
        return f"fix: {' '.join(joint['bodies'])} {'*'.join(moves)}"
    text = f"{joint['kind']}: {first} {second}"
    if "range" in joint:
        text += f" range {joint['range']}"
    if "references" in joint:
        text += " ".join(_point(point) for point in joint["references"])
    return text


def world_text(case):
    """The text of a world with the joints of a case."""
    links = dict.fromkeys(body for joint in case["joints"] for body in joint["bodies"])
    lines = [
        "[LINKS]",
        *links,
        "[JOINTS]",
        *(_joint(joint) for joint in case["joints"]),
    ]
    return "\n".join(lines) + "\n"
