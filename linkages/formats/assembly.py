"""A mechanism as files of other programs give it: each joint in the frames of the two
bodies that it joins, with no closed configuration or one that is rounded."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from linkages.mechanisms.couplings import Coupling
from linkages.mechanisms.joint import LARGEST, JointKind, Limits, Vector
from linkages.values import GeometryError, quoted, require


@dataclass(frozen=True, eq=False)
class BodyJoint:
    """A joint between two ``bodies``, with a frame (4, 4) in each of them.

    The third axis of a frame is the axis, the direction of a slide or the normal of a
    planar joint; of a universal joint it is the axis that is fixed in that body, and
    ``cosine`` is that of the angle between both. All variables are 0 where the frames
    coincide. A helical joint goes on by ``pitch`` in a full turn. ``limits``
    and ``locked`` have an entry for each variable, or none: rad and the file's unit of
    length. ``coupled`` has an entry for each variable that follows another one, by its
    label in the mechanism.
    """

    name: str
    kind: JointKind
    bodies: tuple[str, str]
    frames: tuple[np.ndarray, np.ndarray]
    cosine: float = 0.0
    pitch: float | None = None
    limits: tuple[Limits | None, ...] = ()
    locked: tuple[float | None, ...] = ()
    coupled: dict[str, Coupling] = field(default_factory=dict)

    @property
    def labels(self) -> tuple[str, ...]:
        """What every variable is called in the mechanism."""
        parts = self.kind.facets.parts
        return tuple(f"{self.name}.{part}" if part else self.name for part in parts)

    @property
    def points(self) -> tuple[np.ndarray, np.ndarray]:
        """The origins (3,) of both frames, each in its body."""
        first, second = self.frames
        return first[:3, 3], second[:3, 3]


@dataclass(frozen=True, eq=False)
class Assembly:
    """``bodies`` and the ``joints`` between them.

    ``poses`` (4, 4), by body, are a configuration in which the joints fit, or nearly
    so; empty where the file gives none. ``notes`` say what of a file was left out.
    Places are counted from the ``origin`` of the file, and may be off by ``rounding``,
    where that is more than they are as doubles. ``motors`` are the variables, by their
    labels in the mechanism, that motors drive.
    Raises `GeometryError` where a joint names a body that is not there, a name is given
    twice, or a coordinate is beyond all measure.
    """

    name: str
    bodies: tuple[str, ...]
    joints: tuple[BodyJoint, ...]
    poses: dict[str, np.ndarray] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    origin: Vector = (0.0, 0.0, 0.0)
    rounding: float = 0.0
    motors: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        _check_names("name of a body", self.bodies)
        _check_names("name of a joint", [joint.name for joint in self.joints])
        known = set(self.bodies)
        for joint in self.joints:
            owner = f"of joint {joint.name}"
            for body in joint.bodies:
                if body not in known:
                    allowed = f"one of {', '.join(self.bodies)}"
                    raise GeometryError(f"body {owner}", quoted(body), allowed)
            # squares of coordinates that are larger are beyond all numbers
            largest = float(np.abs(joint.points).max())
            allowed = f"within {LARGEST:.0e}"
            is_small = not largest > LARGEST
            require(is_small, f"point {owner}", f"at {largest:.3g}", allowed)
            first, second = joint.bodies
            allowed = "two different bodies"
            require(first != second, f"bodies {owner}", [first, second], allowed)

    @cached_property
    def numbers(self) -> dict[str, int]:
        """The number of every body."""
        return {body: k for k, body in enumerate(self.bodies)}

    def placed(
        self, joint: BodyJoint, poses: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Both frames (4, 4) of a joint where the bodies are at ``poses`` (b, 4, 4)."""
        first, second = (poses[self.numbers[body]] for body in joint.bodies)
        return first @ joint.frames[0], second @ joint.frames[1]


def _check_names(what: str, names: Sequence[str]) -> None:
    for name, count in Counter(names).items():
        require(count == 1, what, quoted(name), "given once")


def translation(point: Sequence[float] | np.ndarray) -> np.ndarray:
    """The transform (4, 4) that moves the origin to ``point`` (3,)."""
    result = np.eye(4)
    result[:3, 3] = point
    return result


def frame_along(
    point: Sequence[float] | np.ndarray,
    direction: Sequence[float] | np.ndarray,
    reference: Sequence[float] | np.ndarray | None = None,
) -> np.ndarray:
    """A frame (4, 4) at ``point`` (3,) with its third axis along ``direction`` (3,).

    The first axis is along ``reference`` (3,), as far as that is across, or along the
    coordinate axis that is most across. The direction must not be 0, the reference not
    along it.
    """
    third = np.asarray(direction, dtype=float)
    third = third / np.abs(third).max()
    third = third / np.linalg.norm(third)
    if reference is None:
        reference = np.eye(3)[np.argmin(np.abs(third))]
    first = np.asarray(reference, dtype=float)
    first = first - (first @ third) * third
    first = first / np.linalg.norm(first)
    result = translation(point)
    result[:3, :3] = np.column_stack([first, np.cross(third, first), third])
    return result


def without_joints(links: Sequence[str]) -> str:
    """The note on links of a file that no joint joins to others."""
    return f"left out, as they have no joints: links {listed(links)}"


def listed(names: Sequence[str]) -> str:
    """The first names, and how many more there are."""
    most = 6
    if len(names) <= most:
        return ", ".join(names)
    return f"{', '.join(names[:most])} and {len(names) - most} more"


def in_bodies(
    poses: Sequence[np.ndarray], frames: Sequence[np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Two ``frames`` (4, 4) as they are in the bodies at two ``poses`` (4, 4)."""
    first, second = (np.linalg.inv(p) @ f for p, f in zip(poses, frames, strict=True))
    return first, second
