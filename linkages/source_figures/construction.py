"""Assemblies as the tables of the figures describe them: a loop in a configuration, and
joints and links added to it step by step.

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
from typing import NamedTuple

import numpy as np

from linkages.catalogue import entry
from linkages.loop import Loop
from linkages.source_figures.assembly import (
    Assembly,
    Axis,
    Bar,
    Role,
    Seat,
    bar_between,
    fourth_joint,
    joint_after,
    joint_on,
    loop_assembly,
)
from linkages.source_figures.bennett_network import network_assembly
from linkages.source_figures.configurations import configuration, linkage_of
from linkages.source_figures.table import Content

GREEK = {"a": "α", "b": "β", "c": "γ", "d": "δ", "e": "ε"}
PARAMETER = {"a": "alpha", "b": "beta", "c": "gamma", "d": "delta"}
ROLES = frozenset(role.value for role in Role)
SUM = re.compile(r"[a-e]([+-][a-e])*")
TERM = re.compile(r"([+-]?)([a-e])")


class BasicLink(NamedTuple):
    """Length and twist (rad) of a link that linkages are constructed from."""

    length: float
    twist: float


def assembly_of(panel: Content) -> Assembly:
    """The assembly that a panel of a figure describes."""
    links: dict[str, BasicLink]
    if "network" in panel:
        assembly = network_assembly(panel)
        links = {}
    else:
        loop = linkage_of(panel).loop
        names = panel.get("names", [str(i + 1) for i in range(loop.n)])
        labels = panel.get("labels", [""] * loop.n)
        assembly = loop_assembly(loop, configuration(panel), names, labels)
        links = basic_links(loop, labels, panel)
    for line in panel.get("joints", ()):
        _add_joint(assembly, line, links)
    for line in panel.get("links", ()):
        _add_link(assembly, line)
    for place, bar in enumerate(assembly.bars):
        assembly.bars[place] = replace(bar, label=link_text(bar.label))
    return assembly


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


def link_value(name: str, links: Mapping[str, BasicLink]) -> BasicLink:
    """Length and twist of a sum of basic links such as b+d; raises `ValueError` for
    another name, and for a link that nobody knows."""
    letters = {letter for _, letter in _terms(name)}
    if not letters or not letters <= set(links):
        known = ", ".join(sorted(links))
        raise ValueError(f"no sum of the basic links {known}: {name}")
    length = sum(sign * links[letter].length for sign, letter in _terms(name))
    twist = sum(sign * links[letter].twist for sign, letter in _terms(name))
    return BasicLink(length, twist)


def basic_links(
    loop: Loop, labels: Sequence[str], content: Content
) -> dict[str, BasicLink]:
    """Every basic link of a linkage by its letter.

    Those that are links of the loop come from its table, others from the parameters of
    the linkage, and what stands in one sum with known ones from that sum.
    """
    lengths, twists, _ = loop.arrays
    known: dict[str, BasicLink] = {}
    for label, length, twist in zip(labels, lengths, twists, strict=True):
        if len(label) == 1 and SUM.fullmatch(label):
            known.setdefault(label, BasicLink(float(length), float(twist)))
    for letter, degrees in content.get("basic", {}).items():
        twist = float(np.radians(degrees))
        scale = float(lengths[0] / np.sin(twists[0]))
        known[letter] = BasicLink(scale * float(np.sin(twist)), twist)
    _add_parameters(known, content)
    for label, length, twist in zip(labels, lengths, twists, strict=True):
        unknown = [term for term in _terms(label) if term[1] not in known]
        if len(unknown) != 1:
            continue
        sign, letter = unknown[0]
        rest = [term for term in _terms(label) if term[1] in known]
        other_length = sum(s * known[name].length for s, name in rest)
        other_twist = sum(s * known[name].twist for s, name in rest)
        known[letter] = BasicLink(
            sign * (float(length) - other_length), sign * (float(twist) - other_twist)
        )
    return known


def _add_parameters(known: dict[str, BasicLink], content: Content) -> None:
    """The basic links whose twists are parameters of the linkage, of one ratio of sine
    and length."""
    family = entry(content["linkage"])
    given = content.get("parameters", {})
    values = family.defaults | {k: float(np.radians(v)) for k, v in given.items()}
    if "a" in given:
        values["a"] = float(given["a"])
    if "a" not in values or "alpha" not in values:
        return
    ratio = np.sin(values["alpha"]) / values["a"]
    for letter, parameter in PARAMETER.items():
        if letter not in known and parameter in values:
            twist = values[parameter]
            known[letter] = BasicLink(float(np.sin(twist) / ratio), twist)


# --- steps ----------------------------------------------------------------------------


def _add_joint(assembly: Assembly, line: str, links: Mapping[str, BasicLink]) -> None:
    """Add the joint that a line of words describes; raises `ValueError` for words that
    describe none."""
    name, how, *words = line.split()
    if how == "on":
        first, last = words[0].split("-")
        link = link_value(words[1], links)
        one = _foot(assembly, first, last)
        other = _foot(assembly, last, first)
        assembly.axes[name] = joint_on(one, other, link.length, link.twist)
        fraction = link.length / float(np.linalg.norm(other.point - one.point))
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
        link = link_value(letters, links)
        assembly.axes[name] = joint_after(
            assembly.axes[before],
            assembly.axes[at],
            float(np.radians(float(degrees))),
            link.length,
            link.twist,
        )
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
    role = Role.KEPT
    label = ""
    for word in words:
        if word in ROLES:
            role = Role(word)
        else:
            label = word
    for place, bar in enumerate(assembly.bars):
        if {bar.first, bar.last} == {first, last}:
            assembly.bars[place] = Bar(
                bar.first, bar.last, bar.ends, label or bar.label, role
            )
            return
    assembly.bars.append(bar_between(assembly, first, last, label, role))
