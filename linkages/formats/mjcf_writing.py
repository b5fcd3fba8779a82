"""Mechanisms as MJCF, the files of MuJoCo.

The frames of all bodies coincide in the reference configuration, so that every number of
the mechanism stands in the file as it is. A spanning tree of the bodies stands in
<worldbody>; the joints besides it are closed by <equality>: spherical joints by one
<connect>, revolute ones by two, rigid ones and copies of a body by <weld>.
"""

from __future__ import annotations

import itertools
from xml.sax.saxutils import quoteattr

import networkx as nx
import numpy as np

from linkages.formats.names import (
    WORLD,
    NameRules,
    body_name,
    pair_name,
    pair_names,
    row_text,
    with_names_for,
)
from linkages.mechanisms.joint import Joint, JointKind, Motion
from linkages.mechanisms.mechanism import Mechanism, Pair, Variable
from linkages.mechanisms.size import Size

CONNECTED = JointKind.REVOLUTE, JointKind.SPHERICAL
THICKNESS = 0.03  # of a drawn body, over the characteristic length
LEAST_INERTIA = 1e-12  # MuJoCo takes none of less than 1e-15


def mechanism_mjcf(mechanism: Mechanism) -> str:
    """The text of an MJCF model in which qpos0 is the reference configuration and joint
    coordinates, called after the variables, have their values. Masses are made up.
    Names that would stand there for two things are changed, and the log says so."""
    return _Writer(with_names_for(mechanism, _rules(mechanism))).text()


def _names_of_joint(joint: Joint) -> list[str]:
    """The names that may stand in a file for a joint: of its pairs, of the points that
    close them, of its variables, and of slides with a turn."""
    pairs = pair_names(joint)
    names = [*pairs, *joint.labels]
    for pair in pairs:
        names += [f"{pair}.1", f"{pair}.2"]
    return names + [_advance_name(label) for label in joint.labels]


def _advance_name(label: str) -> str:
    """What the slide is called that goes with a turn."""
    return f"{label}.advance"


def _copy_name(joint: str, pair: int) -> str:
    """What the copy of a body is called that closes a pair of a joint."""
    return f"{joint}.copy{pair}"


def _rules(mechanism: Mechanism) -> NameRules:
    """Bodies, joints and equalities have names of their own."""
    pairs = range(len(mechanism.pairs))
    return NameRules(
        is_allowed=lambda name: name != WORLD,
        of_joint=_names_of_joint,
        links_of_joint=lambda joint: [_copy_name(joint.name, pair) for pair in pairs],
        siblings=False,
    )


class _Writer:
    """Writes one mechanism."""

    def __init__(self, mechanism: Mechanism):
        self.mechanism = mechanism
        self.size = Size(mechanism).characteristic_length
        self.tree = self._tree_pairs()
        self.equalities: list[str] = []

    def text(self) -> str:
        """The whole model."""
        pairs = self.mechanism.pairs
        copies = {
            number: _copy_name(pairs[number].joint, number)
            for number in range(len(pairs))
            if number not in self.tree and not self._is_closed_by_points(number)
        }
        bodies = self._bodies(self.mechanism.frame, None, copies, depth=2)
        for number in range(len(pairs)):
            if number not in self.tree:
                self._close(number, copies)
        lines = [
            f"<mujoco model={quoteattr(self.mechanism.name or 'mechanism')}>",
            '  <compiler angle="radian" autolimits="true"/>',
            '  <option gravity="0 0 0">',
            '    <flag contact="disable"/>',
            "  </option>",
            "  <worldbody>",
            *bodies,
            "  </worldbody>",
        ]
        if self.equalities:
            lines += ["  <equality>", *self.equalities, "  </equality>"]
        return "\n".join([*lines, "</mujoco>"]) + "\n"

    # --- which joints are in the tree -------------------------------------------------

    def _tree_pairs(self) -> set[int]:
        """The pairs of a spanning tree, with as many as can be of those that no points
        close."""
        graph = nx.MultiGraph()
        graph.add_nodes_from(self.mechanism.bodies)
        for number, pair in enumerate(self.mechanism.pairs):
            weight = 1 if self._is_closed_by_points(number) else 0
            graph.add_edge(pair.base, pair.moved, key=number, weight=weight)
        tree = nx.minimum_spanning_tree(graph)
        return {number for _, _, number in tree.edges(keys=True)}

    def _is_closed_by_points(self, number: int) -> bool:
        """Whether points that both bodies share say all of the joint of a pair."""
        pair = self.mechanism.pairs[number]
        kind = self._joint(pair).kind
        if kind is JointKind.RIGID:
            return True
        leaders = [one.leader.number for one in self.mechanism.variables]
        for k in pair.variables:
            variable = self.mechanism.variables[k]
            is_alone = leaders[k] == k and leaders.count(k) == 1
            is_bound = variable.limits is not None or variable.locked is not None
            if is_bound or not is_alone:
                return False
        return kind in CONNECTED

    def _joint(self, pair: Pair) -> Joint:
        return self.mechanism.joint(pair.joint)

    # --- bodies -----------------------------------------------------------------------

    def _bodies(
        self, body: str, parent_pair: int | None, copies: dict[int, str], depth: int
    ) -> list[str]:
        """The lines of the bodies that stand in ``body``."""
        lines = []
        for number, pair in enumerate(self.mechanism.pairs):
            if body not in (pair.base, pair.moved) or number == parent_pair:
                continue
            other = pair.moved if pair.base == body else pair.base
            if number in self.tree:
                inner = self._bodies(other, number, copies, depth + 1)
                lines += self._body(other, number, body, inner, depth)
            elif number in copies and body == pair.base:
                lines += self._body(copies[number], number, body, [], depth)
        return lines

    def _body(
        self, name: str, number: int, parent: str, inner: list[str], depth: int
    ) -> list[str]:
        """The lines of a body that a pair joins to its parent, and what stands in
        it."""
        pair = self.mechanism.pairs[number]
        # none for a copy of a body
        points = [one.place for one in self.mechanism.joints if name in one.bodies]
        joint = self._joint(pair)
        center = np.mean(points or [joint.place], axis=0)
        moment = repr(max(self.size**2, LEAST_INERTIA))
        pad = "  " * depth
        shown = body_name(self.mechanism, name)
        return [
            f"{pad}<body name={quoteattr(shown)}>",
            f'{pad}  <inertial pos="{row_text(center)}" mass="1" '
            f'diaginertia="{moment} {moment} {moment}"/>',
            *(f"{pad}  {line}" for line in self._axes(pair, parent == pair.base)),
            *(f"{pad}  {line}" for line in self._shapes(points)),
            *inner,
            f"{pad}</body>",
        ]

    def _shapes(self, points: list[np.ndarray]) -> list[str]:
        """Rods between the points of a body, as it is drawn."""
        radius = THICKNESS * self.size
        lines = []
        for start, end in itertools.pairwise(points):
            if np.linalg.norm(end - start) > radius:
                ends = f"{row_text(start)} {row_text(end)}"
                lines.append(
                    f'<geom type="capsule" fromto="{ends}" size="{radius!r}" mass="0" '
                    'contype="0" conaffinity="0"/>'
                )
        return lines

    # --- joints -----------------------------------------------------------------------

    def _axes(self, pair: Pair, is_forward: bool) -> list[str]:
        """The joints of a body that a pair joins to its parent: of the moved body, or,
        the other way round, of the base."""
        joint = self._joint(pair)
        if pair.center is not None:
            name, place = pair_name(joint, pair), row_text(pair.center)
            return [f'<joint name={quoteattr(name)} type="ball" pos="{place}"/>']
        lines = []
        for number in pair.variables:
            lines += self._axis(self.mechanism.variables[number], is_forward)
        return lines if is_forward else lines[::-1]

    def _axis(self, variable: Variable, is_forward: bool) -> list[str]:
        """The line of a variable; two of them where a turn advances."""
        motion, label = variable.motion, variable.label
        if variable.locked is not None:
            self._couple(label, None, variable.locked, 0.0)
        elif self.mechanism.variables[variable.leader.number].label != label:
            leader = self.mechanism.variables[variable.leader.number].label
            self._couple(label, leader, variable.leader.offset, variable.leader.ratio)
        kind = "hinge" if motion.is_turn else "slide"
        sign = 1.0 if is_forward else -1.0
        lines = [_axis_line(label, kind, motion, sign, variable.limits)]
        if motion.is_turn and motion.advance:
            slide = _advance_name(label)
            lines.append(_axis_line(slide, "slide", motion, sign, None))
            self._couple(slide, label, 0.0, motion.advance)
        return lines

    def _couple(
        self, first: str, second: str | None, constant: float, factor: float
    ) -> None:
        other = "" if second is None else f" joint2={quoteattr(second)}"
        self.equalities.append(
            f"    <joint joint1={quoteattr(first)}{other} "
            f'polycoef="{float(constant)!r} {float(factor)!r} 0 0 0"/>'
        )

    # --- closing loops ----------------------------------------------------------------

    def _close(self, number: int, copies: dict[int, str]) -> None:
        """Add the equality that closes the joint of a pair outside of the tree."""
        pair = self.mechanism.pairs[number]
        joint = self._joint(pair)
        if number in copies:
            self._equate("weld", "", copies[number], pair.moved, None)
            return
        if joint.kind is JointKind.RIGID:
            self._equate("weld", "", pair.base, pair.moved, None)
            return
        name = pair_name(joint, pair)
        if joint.kind is JointKind.SPHERICAL:
            self._equate("connect", name, pair.base, pair.moved, joint.place)
            return
        motion = joint.motions[0]
        points = joint.place, joint.place + self.size * motion.direction
        for end, point in enumerate(points, start=1):
            self._equate("connect", f"{name}.{end}", pair.base, pair.moved, point)

    def _equate(
        self, tag: str, name: str, first: str, second: str, anchor: np.ndarray | None
    ) -> None:
        names = [quoteattr(body_name(self.mechanism, one)) for one in (first, second)]
        bodies = f"body1={names[0]} body2={names[1]}"
        named = f" name={quoteattr(name)}" if name else ""
        place = "" if anchor is None else f' anchor="{row_text(anchor)}"'
        self.equalities.append(f"    <{tag}{named} {bodies}{place}/>")


def _axis_line(
    label: str,
    kind: str,
    motion: Motion,
    sign: float,
    limits: tuple[float, float] | None,
) -> str:
    line = f'<joint name={quoteattr(label)} type="{kind}" '
    line += f'pos="{row_text(motion.point)}" axis="{row_text(sign * motion.direction)}"'
    if limits is not None:
        line += f' range="{row_text(limits)}"'
    return line + "/>"
