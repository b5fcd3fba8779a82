"""Assemblies as the tables of the figures describe them: a loop in a configuration, or
the network of four Bennett linkages, and joints and links added to it step by step.

A joint is one line of words: ``X on 1-2 a`` stands on the link from 1 to 2, as far from
1 as the basic link a is long and turned by its twist; ``R fourth X 1 6`` completes a
Bennett linkage; ``S after Q P 60 c`` ends the basic link c that goes on from joint P,
60 degrees from where the link from Q to P leads. A link is ``X-5 b removed``: two
joints, what it is, and what becomes of it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from linkages.catalogue import entry
from linkages.loop import Loop
from linkages.networks.network import Network, build_network, other_angle
from linkages.networks.plan import FOUR_BENNETT
from linkages.source_figures.assembly import (
    Assembly,
    Axis,
    Role,
    Seat,
    bar_between,
    far_axis,
    fourth_joint,
    joint_after,
    loop_assembly,
    unit,
)
from linkages.source_figures.configurations import configuration, linkage_of
from linkages.source_figures.table import Content

GREEK = {"a": "α", "b": "β", "c": "γ", "d": "δ", "e": "ε"}
PARAMETER = {"a": "alpha", "b": "beta", "c": "gamma", "d": "delta"}
ROLES = frozenset(role.value for role in Role)
SUM = re.compile(r"[a-e]([+-][a-e])*")
TERM = re.compile(r"([+-]?)([a-e])")
SPOKES = (("2", "c"), ("4", "b"), ("6", "d"), ("8", "a"))  # of the network


def assembly_of(panel: Content) -> Assembly:
    """The assembly that a panel of a figure describes."""
    links: dict[str, np.ndarray] = {}
    if "network" in panel:
        assembly = _network_assembly(panel)
    else:
        loop = linkage_of(panel).loop
        labels = panel.get("labels", [""] * loop.n)
        names = panel.get("names", ())
        assembly = loop_assembly(loop, configuration(panel), names, labels)
        links = basic_links(loop, labels, panel)
    for line in panel.get("joints", ()):
        _add_joint(assembly, line, links)
    for line in panel.get("links", ()):
        _add_link(assembly, line)
    for place, bar in enumerate(assembly.bars):
        assembly.bars[place] = replace(bar, label=link_text(bar.label))
    return assembly


# --- the network of four Bennett linkages ---------------------------------------------


def _network_assembly(panel: Content) -> Assembly:
    """The network that a panel describes: its ring of eight joints, and the links to
    joint 0 in the middle.

    ``twists`` are those of a, b, c, d in degrees, each link as long as the sine of its
    own; ``odd`` the angles at the joints 1, 3 and 5; ``straight`` lists even joints
    that are to be straight, which the angles at the odd joints beyond them follow;
    joints of ``without`` are left out.
    """
    twists = [float(np.radians(panel["twists"][name])) for name in "abcd"]
    network = build_network(FOUR_BENNETT, float(np.sin(twists[0])), *twists)
    theta = network.ring_angles(_states(network, panel))
    plan = network.plan
    letters = [plan.bars[plan.ring_bar(place)] for place in range(len(plan.ring))]
    assembly = loop_assembly(network.ring_loop, theta, plan.ring, letters)
    around_first = [assembly.axes[name] for name in ("8", "1", "2")]
    assembly.axes["0"] = fourth_joint(*around_first)
    for joint, letter in SPOKES:
        assembly.bars.append(bar_between(assembly, "0", joint, letter))
    for joint in panel.get("without", ()):
        assembly.remove(joint)
    return assembly


def _states(network: Network, panel: Content) -> np.ndarray:
    """The angles (4,), rad, at the joints 1, 3, 5 and 7, with the even joints straight
    that are to be."""
    odd = [float(np.radians(angle)) for angle in panel["odd"]]
    for part, joint in enumerate(("2", "4")):
        if joint in panel.get("straight", ()):
            # the even angle is pi - inner + following = 0
            inner = other_angle(network.factors[part], np.array(odd[part]))
            following = other_angle(network.factors[part + 1], inner - np.pi)
            odd[part + 1] = float(following)
    return np.array([*odd, -sum(odd)])


# --- basic links ----------------------------------------------------------------------


def link_text(name: str) -> str:
    """A sum of basic links as the sources write it: a+c as a+c/α+γ."""
    if not SUM.fullmatch(name):
        return name
    twists = "".join(GREEK.get(letter, letter) for letter in name)
    return f"{name}/{twists}"


def _terms(name: str) -> list[tuple[float, str]]:
    """Signs and letters of a sum of basic links; none of another name."""
    if not SUM.fullmatch(name):
        return []
    return [
        (-1.0 if sign == "-" else 1.0, letter) for sign, letter in TERM.findall(name)
    ]


def link_value(name: str, links: Mapping[str, np.ndarray]) -> np.ndarray:
    """Length and twist (2,) of a sum of basic links such as b+d; raises `ValueError`
    for another name, and for a link that nobody knows."""
    terms = _terms(name)
    if not terms or any(letter not in links for _, letter in terms):
        allowed = ", ".join(sorted(links))
        raise ValueError(f"no sum of the basic links {allowed}: {name}")
    value: np.ndarray = np.sum([sign * links[letter] for sign, letter in terms], axis=0)
    return value


def basic_links(
    loop: Loop, labels: Sequence[str], content: Content
) -> dict[str, np.ndarray]:
    """Length and twist (2,), rad, of every basic link of a linkage by its letter.

    Those that are links of the loop come from its table, others from the parameters of
    the linkage, all of one ratio of sine and length, and what stands in one sum with
    known ones from that sum.
    """
    rows = np.stack([loop.arrays.lengths, loop.arrays.twists], axis=1)
    links: dict[str, np.ndarray] = {}
    for label, row in zip(labels, rows, strict=True):
        if len(label) == 1 and SUM.fullmatch(label):
            links.setdefault(label, row)
    for letter, degrees in content.get("basic", {}).items():
        twist = np.radians(degrees)
        length, first_twist = rows[0]
        links[letter] = np.array([length / np.sin(first_twist) * np.sin(twist), twist])
    _add_parameters(links, content)
    for label, row in zip(labels, rows, strict=True):
        terms = _terms(label)
        missing = [term for term in terms if term[1] not in links]
        if len(missing) == 1:
            rest = [sign * links[letter] for sign, letter in terms if letter in links]
            sign, letter = missing[0]
            links[letter] = sign * (row - np.sum(rest, axis=0))
    return links


def _add_parameters(links: dict[str, np.ndarray], content: Content) -> None:
    """The basic links whose twists are parameters of the linkage."""
    degrees = content.get("parameters", {})
    values = dict(entry(content["linkage"]).defaults)
    values |= {name: float(np.radians(value)) for name, value in degrees.items()}
    if "a" in degrees:
        values["a"] = float(degrees["a"])
    if "a" not in values or "alpha" not in values:
        return
    ratio = np.sin(values["alpha"]) / values["a"]
    for letter, parameter in PARAMETER.items():
        if parameter in values:
            twist = values[parameter]
            links.setdefault(letter, np.array([np.sin(twist) / ratio, twist]))


# --- steps ----------------------------------------------------------------------------


def _add_joint(assembly: Assembly, line: str, links: Mapping[str, np.ndarray]) -> None:
    """Add the joint that a line of words describes; raises `ValueError` for words that
    describe none."""
    name, how, *words = line.split()
    if how == "on":
        first, last = words[0].split("-")
        length, twist = link_value(words[1], links)
        start = _foot(assembly, first, last)
        span = _foot(assembly, last, first).point - start.point
        assembly.axes[name] = far_axis(start, unit(span), length, twist)
        fraction = float(length / np.linalg.norm(span))
        assembly.seats[name] = Seat(first, last, fraction)
    elif how == "fourth":
        first, middle, last = words
        assembly.axes[name] = fourth_joint(
            _foot(assembly, first, middle),
            assembly.axes[middle],
            _foot(assembly, last, middle),
        )
    elif how == "after":
        before, at, degrees, letters = words
        length, twist = link_value(letters, links)
        ends = assembly.axes[before], assembly.axes[at]
        angle = np.radians(float(degrees))
        assembly.axes[name] = joint_after(*ends, angle, length, twist)
    else:
        raise ValueError(f"{line!r} describes no joint")


def _foot(assembly: Assembly, name: str, other: str) -> Axis:
    """A joint axis with its foot on the link to another joint as its point."""
    axis = assembly.axes[name]
    for bar in assembly.bars:
        if (bar.first, bar.last) == (name, other):
            return Axis(bar.ends[0], axis.direction)
        if (bar.last, bar.first) == (name, other):
            return Axis(bar.ends[1], axis.direction)
    return axis


def _add_link(assembly: Assembly, line: str) -> None:
    """Add the link that a line of words describes, or change what becomes of one."""
    ends, *words = line.split()
    first, last = ends.split("-")
    roles = [Role(word) for word in words if word in ROLES]
    labels = [word for word in words if word not in ROLES]
    role = roles[-1] if roles else Role.KEPT
    label = labels[-1] if labels else ""
    for place, bar in enumerate(assembly.bars):
        if {bar.first, bar.last} == {first, last}:
            assembly.bars[place] = replace(bar, label=label or bar.label, role=role)
            return
    assembly.bars.append(bar_between(assembly, first, last, label, role))
