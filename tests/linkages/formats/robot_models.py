"""Models that others wrote, as MJCF and SDF texts made from the numbers in
data/robot_models.json."""

import json
from pathlib import Path

DATA = Path(__file__).parents[3] / "data" / "robot_models.json"
MODELS = json.loads(DATA.read_text(encoding="utf-8"))
MJCF = {model["name"]: model for model in MODELS["mjcf"]}
SDF = {model["name"]: model for model in MODELS["sdf"]}


def _attributes(values):
    return "".join(f' {key}="{value}"' for key, value in values.items())


def mjcf_text(model):
    """An MJCF text with the bodies and equalities of a model."""
    equality = "".join(
        f"<{tag}{_attributes(values)}/>" for tag, values in model["equality"]
    )
    return (
        f'<mujoco model="{model["name"]}">'
        f'<compiler angle="{model["angle"]}" autolimits="true"/>'
        f"<worldbody>{_children(model, '')}</worldbody>"
        f"<equality>{equality}</equality></mujoco>"
    )


def _children(model, parent):
    text = ""
    for body, name, place in model.get("sites", ()):
        if body == parent:
            text += f'<site name="{name}" pos="{place}"/>'
    for name, holder, values, joints in model["bodies"]:
        if holder != parent:
            continue
        text += f'<body name="{name}"{_attributes(values)}>'
        for joint, own in joints:
            text += f'<joint name="{joint}"{_attributes(own)}/>'
        text += f'<geom size="0.01"/>{_children(model, name)}</body>'
    return text


def sdf_text(model):
    """An SDF text with the links, frames and joints of a model, all about axes of the
    same coordinates."""
    attributes, direction = model["axis"]
    axis = f"<axis><xyz{_attributes(attributes)}>{direction}</xyz></axis>"
    text = f'<sdf version="{model["version"]}"><model name="{model["name"]}">'
    for name, own, pose in model["links"]:
        text += f'<link name="{name}">{_pose(own, pose)}</link>'
    for name, link, pose in model["frames"]:
        text += f'<frame name="{name}" attached_to="{link}">{_pose({}, pose)}</frame>'
    for name, parent, child, *pose in model["joints"]:
        text += f'<joint name="{name}" type="revolute">'
        text += _pose(*pose) if pose else ""
        text += f"<parent>{parent}</parent><child>{child}</child>{axis}</joint>"
    return f"{text}</model></sdf>"


def _pose(attributes, numbers):
    return f"<pose{_attributes(attributes)}>{numbers}</pose>"
