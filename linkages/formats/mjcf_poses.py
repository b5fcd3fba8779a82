"""Settings, defaults and poses of an MJCF model, as MuJoCo takes them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from linkages.formats.assembly import frame_along
from linkages.formats.exact_poses import ExactPose
from linkages.formats.xml_tree import Element
from linkages.values import quoted

# what gives an orientation, with how many numbers
ORIENTATIONS = {"quat": 4, "axisangle": 4, "euler": 3, "xyaxes": 6, "zaxis": 3}
AT_REST = (0.0, 0.0, 0.0)
MAIN = "main"  # the class of defaults that holds where none is named


@dataclass
class Settings:
    """What <compiler> and <default> of a model say: the ``angle_unit`` in rad, the
    ``euler_sequence``, whether a range is a limit by itself, and the attributes of each
    class of ``defaults`` by tag."""

    angle_unit: float = math.pi / 180
    euler_sequence: str = "xyz"
    has_auto_limits: bool = True
    defaults: dict[str, dict[str, dict[str, str]]] = field(
        default_factory=lambda: {MAIN: {}}
    )

    def attributes(
        self, element: Element, childclass: str | None, kind: str | None = None
    ) -> Element:
        """The element with the defaults of its class filled in, those of its ``kind``,
        which is its tag as a rule; raises `GeometryError` for a class that is not
        there."""
        name = element.attributes.get("class", childclass or MAIN)
        allowed = f"one of {', '.join(self.defaults)}"
        element.require(name in self.defaults, "class", quoted(name), allowed)
        tag = "joint" if element.tag == "freejoint" else element.tag
        default = self.defaults[name].get(kind or tag, {})
        own = element.attributes
        if any(key in own for key in ORIENTATIONS):
            default = {k: v for k, v in default.items() if k not in ORIENTATIONS}
        return Element(
            element.tag, element.line, {**default, **own}, "", element.children
        )


def read_settings(root: Element) -> Settings:
    """The settings of a model; raises `GeometryError`."""
    settings = Settings()
    for compiler in root.all("compiler"):
        coordinate = compiler.attributes.get("coordinate", "local")
        is_local = coordinate == "local"
        compiler.require(is_local, "coordinate", quoted(coordinate), '"local"')
        unit = compiler.attributes.get("angle")
        if unit is not None:
            compiler.choice("angle", ("degree", "radian"), unit)
            settings.angle_unit = math.pi / 180 if unit == "degree" else 1.0
        sequence = compiler.attributes.get("eulerseq", settings.euler_sequence)
        is_sequence = len(sequence) == 3 and set(sequence) <= set("xyzXYZ")
        allowed = "three of x, y, z, X, Y, Z"
        compiler.require(is_sequence, "eulerseq", quoted(sequence), allowed)
        settings.euler_sequence = sequence
        if "autolimits" in compiler.attributes:
            automatic = compiler.choice("autolimits", ("true", "false"), "true")
            settings.has_auto_limits = automatic == "true"
    for default in root.all("default"):
        _read_defaults(default, {}, MAIN, settings)
    return settings


def _read_defaults(
    element: Element,
    inherited: dict[str, dict[str, str]],
    fallback: str | None,
    settings: Settings,
) -> None:
    """Enter a class of defaults, which begins with those of the class around it."""
    name = element.attributes.get("class", fallback)
    if name is None:
        element.refuse("class", "missing", "the name of the class")
    own = {tag: dict(values) for tag, values in inherited.items()}
    for child in element.children:
        if child.tag != "default":
            own.setdefault(child.tag, {}).update(child.attributes)
    known = settings.defaults.get(name, {})
    settings.defaults[name] = {**known, **own}
    for child in element.all("default"):
        _read_defaults(child, own, None, settings)


# --- poses ----------------------------------------------------------------------------


def pose_of(element: Element, settings: Settings) -> ExactPose:
    """The pose of a body, a frame or a site in the element around it; raises
    `GeometryError`."""
    given = [key for key in ORIENTATIONS if key in element.attributes]
    both = " and ".join(given[:2])
    element.require(len(given) < 2, both, "both given", "the only orientation")
    rotation = _orientation(element, given[0], settings) if given else None
    return ExactPose.at(element.numbers("pos", (3,)) or AT_REST, rotation)


def _orientation(element: Element, key: str, settings: Settings) -> np.ndarray:
    """The rotation (3, 3) that an attribute gives."""
    from scipy.spatial.transform import Rotation

    numbers = np.array(element.numbers(key, (ORIENTATIONS[key],)))
    if key == "euler":
        angles = settings.angle_unit * numbers
        # a small letter of MJCF is an axis that moves, and a capital in scipy
        sequence = settings.euler_sequence.swapcase()
        result = np.eye(3)
        for letter, angle in zip(sequence, angles, strict=True):
            step = Rotation.from_euler(letter.lower(), angle).as_matrix()
            result = result @ step if letter.isupper() else step @ result
        return result
    direction = numbers[:3] if key == "axisangle" else numbers
    if key == "xyaxes":
        direction = np.cross(numbers[:3], numbers[3:])
    words = {
        "quat": "a quaternion of a length other than zero",
        "xyaxes": "two directions that are not parallel",
    }
    allowed = words.get(key, "directions of a length other than zero")
    is_given = bool(np.any(direction))
    element.require(is_given, key, quoted(element.attributes[key]), allowed)
    if key == "quat":
        return rotation_of_quaternion(numbers)
    if key == "xyaxes":
        return frame_along((0.0, 0.0, 0.0), direction, numbers[:3])[:3, :3]
    axis = direction / np.linalg.norm(direction)
    if key == "zaxis":
        return _least_turn(axis)
    turn = settings.angle_unit * numbers[3] * axis
    rotation: np.ndarray = Rotation.from_rotvec(turn).as_matrix()
    return rotation


def rotation_of_quaternion(quaternion: np.ndarray) -> np.ndarray:
    """The rotation (3, 3) of a quaternion (4,), its real part first."""
    from scipy.spatial.transform import Rotation

    if np.array_equal(quaternion, [1.0, 0.0, 0.0, 0.0]):
        return np.eye(3)
    rotation: np.ndarray = Rotation.from_quat(quaternion, scalar_first=True).as_matrix()
    return rotation


def _least_turn(direction: np.ndarray) -> np.ndarray:
    """The least turn (3, 3) of the third axis to a unit vector (3,)."""
    from scipy.spatial.transform import Rotation

    axis = np.cross([0.0, 0.0, 1.0], direction)
    sine = float(np.linalg.norm(axis))
    angle = math.atan2(sine, float(direction[2]))
    axis = axis / sine if sine > 0 else np.array([1.0, 0.0, 0.0])
    rotation: np.ndarray = Rotation.from_rotvec(angle * axis).as_matrix()
    return rotation
