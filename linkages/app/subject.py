"""What moves, and what it says of its configurations: a loop given as a table, a
mechanism, or a network of Bennett loops.

Whoever shows an atlas asks its subject, and does not ask which of them it is.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bifurc.atlas import Atlas
from bifurc.branch import Branch
from bifurc.isometry import Isometry
from bifurc.problem import Problem
from bifurc.torus import wrap
from linkages.app.exit_codes import CommandError
from linkages.app.texts.numbers import in_degrees, in_lengths, link_name
from linkages.labels import FormLabels, loop_of
from linkages.linkage import Linkage
from linkages.loop import Loop

if TYPE_CHECKING:
    from bifurc.files.table import Variable
    from linkages.app.reports.beyond_limits import LimitedRange
    from linkages.links.clearance import Approach
    from linkages.mechanisms.mechanism import Mechanism
    from linkages.networks.mechanism import NetworkMechanism


FREEDOMS = 6  # of a body in space
# what unknowns are shown in, by the units of an atlas
UNITS = {"rad": "deg", "size": "lengths", "": "entries ax to bz of rotation matrices"}


class Values(NamedTuple):
    """The ``values`` (k, v) of joint variables with their ``names``, rad and the user's
    unit."""

    names: Sequence[str]
    values: np.ndarray


class Subject(ABC):
    """What the unknowns of an atlas are the joints of.

    ``unknowns`` are their names in datasets and ``labels`` those on the screen.
    ``table`` is the Denavit-Hartenberg table, where it is a single loop of revolute
    joints, and ``to_angles`` leads from the unknowns to its joint angles; to the
    unknowns as they are, where there is none. ``size`` is the characteristic length.
    """

    unknowns: list[str]
    labels: list[str]
    table: Loop | None
    to_angles: Isometry
    size: float
    name: str
    # Grübler's count: the freedoms of the joints, less those that loops take
    gruebler: int
    # what the unknowns (n,) are multiplied with to be in rad and the user's unit of length
    factors: np.ndarray
    # what is made: the table, where there is one
    geometry: Loop | Mechanism
    # what moves: "links" of a loop, "bodies" elsewhere
    parts: str
    # where errors of manufacturing are, in words
    places: str

    @abstractmethod
    def as_loop(self) -> Loop:
        """The loop that it is without limits, and with one link for every joint that is
        locked; raises `GeometryError` where it is none, `CommandError` for a network."""

    @abstractmethod
    def still_joints(self, atlas: Atlas, form: int) -> Sequence[str | int]:
        """The joints that stand still along a form: numbers from 1 in a table, names
        elsewhere."""

    @abstractmethod
    def heading(self, atlas: Atlas) -> str:
        """What stands above configurations."""

    @abstractmethod
    def equations(self) -> Problem:
        """The closure equations of the atlas."""

    def in_loop_angles(self, atlas: Atlas) -> Atlas:
        """An atlas in the joint angles of the table; as it is, where there is none."""
        return atlas

    def place(self, point: np.ndarray) -> dict[str, Any]:
        """What a JSON document says of a configuration (n,) besides its numbers; nothing
        where these are the joint angles of a table, as in all that follows."""
        return {}

    def variable(self, index: int) -> dict[str, str]:
        """What it says of an unknown, by index, besides its number."""
        return {}

    @abstractmethod
    def still(self, index: int, value: float) -> str:
        """A joint that stands still along a form, by the index of its unknown, as text;
        where it stands is said of a table."""

    def motion(self, atlas: Atlas, form: int) -> dict[str, Any]:
        """What it says of what joints and bodies do along a form, by index."""
        return {}

    def document(self, atlas: Atlas) -> dict[str, Any]:
        """What it says of the subject besides its table."""
        return {}

    @property
    def part_names(self) -> tuple[str, ...]:
        """What the links, by the joints that they join, or the bodies are called."""
        assert self.table is not None
        n = self.table.n
        return tuple(link_name(link, n) for link in range(n))

    def approaches(self, branch: Branch) -> tuple[Approach, ...]:
        """Where every two links or bodies that share no joint are nearest along a
        branch of the atlas, the nearest first."""
        from linkages.links.clearance import approaches_along

        assert self.table is not None
        angles = self.to_angles
        return tuple(
            replace(approach, theta=angles.inverse.points(approach.theta))
            for approach in approaches_along(self.table, angles.branch(branch))
        )

    def ranges_beyond_limits(self) -> list[LimitedRange]:
        """What limited variables are without their limits, where these keep out all
        configurations."""
        return []

    @abstractmethod
    def joint_values(self, points: np.ndarray) -> Values:
        """The values of all joint variables at configurations (k, n)."""

    def dataset_variables(self, atlas: Atlas) -> dict[str, Variable]:
        """What a dataset holds besides the atlas, by name."""
        return {}

    def files(self) -> dict[str, Callable[[Path], object]]:
        """What writes files of the subject itself, by their names."""
        return {}


class LoopSubject(Subject):
    """A loop given as a table, whose joint angles are the unknowns."""

    parts = "links"
    places = ""

    def __init__(self, loop: Loop):
        self.table: Loop = loop
        self.labels = [str(number + 1) for number in range(loop.n)]
        self.unknowns = [f"theta{number}" for number in self.labels]
        self.to_angles = Isometry.identity(loop.n)
        self.size = loop.characteristic_length
        self.name = loop.name
        self.gruebler = loop.n - FREEDOMS
        self.factors = np.ones(loop.n)
        self.geometry = loop

    def as_loop(self) -> Loop:
        """The table."""
        return self.table

    def still_joints(self, atlas: Atlas, form: int) -> Sequence[int]:
        return FormLabels.of(atlas.forms[form]).inactive_joints

    def heading(self, atlas: Atlas) -> str:
        return "joint angles (deg)"

    def equations(self) -> Problem:
        """The closure of the loop."""
        from linkages.closure.closure import Closure

        return Closure(self.table)

    def still(self, index: int, value: float) -> str:
        return f"{index + 1} at {in_degrees(value)}"

    def joint_values(self, points: np.ndarray) -> Values:
        return Values(self.unknowns, points)


class MechanismSubject(Subject):
    """A mechanism of any joints, read by its ``readout``."""

    places = " of joints on bodies"

    def __init__(self, mechanism: Mechanism):
        from linkages.readout.loop_atlas import to_loop_angles
        from linkages.readout.readout import Readout

        self.readout = Readout(mechanism)
        single = self.readout.single_loop
        self.table = None if single is None else single.loop
        self.parts = "bodies" if single is None else "links"
        self.to_angles = to_loop_angles(self.readout)
        self.labels = [one.label for one in self.readout.structure.unknowns]
        self.unknowns = self.labels
        self.size = self.readout.structure.unit
        self.name = mechanism.name
        self.gruebler = mechanism.gruebler
        self.factors = self.readout.structure.scales
        self.geometry = mechanism if self.table is None else self.table

    def as_loop(self) -> Loop:
        """The loop through the axes of the joints."""
        from linkages.structure.single_loop import loop_geometry

        return loop_geometry(self.readout.mechanism)

    def still_joints(self, atlas: Atlas, form: int) -> Sequence[str]:
        from linkages.readout.facts import form_facts

        return tuple(form_facts(atlas, form, self.readout).still)

    def heading(self, atlas: Atlas) -> str:
        units = [words for unit, words in UNITS.items() if unit in atlas.units]
        return f"{', '.join(self.labels)} ({', '.join(units)})"

    def equations(self) -> Problem:
        return self.readout.closure

    def in_loop_angles(self, atlas: Atlas) -> Atlas:
        from linkages.readout.loop_atlas import in_loop_angles

        return in_loop_angles(atlas, self.readout)

    def place(self, point: np.ndarray) -> dict[str, Any]:
        """The variables by joint."""
        return {"variables": self.readout.variables(point)}

    def variable(self, index: int) -> dict[str, str]:
        """The label of the unknown."""
        return {"variable": self.readout.label_of_unknown(index)}

    @property
    def part_names(self) -> tuple[str, ...]:
        """The bodies by name; of a single loop the links."""
        if self.table is None:
            return self.readout.mechanism.bodies
        return super().part_names

    def approaches(self, branch: Branch) -> tuple[Approach, ...]:
        """Those of bodies; of a single loop those of links."""
        if self.table is not None:
            return super().approaches(branch)
        from linkages.links.clearance import approaches_of_bodies

        return tuple(approaches_of_bodies(self.readout.structure, branch))

    def ranges_beyond_limits(self) -> list[LimitedRange]:
        """Those of the mechanism without limits."""
        from linkages.app.reports.beyond_limits import ranges_beyond_limits

        return list(ranges_beyond_limits(self.readout.mechanism))

    def still(self, index: int, value: float) -> str:
        return self.labels[index]

    def motion(self, atlas: Atlas, form: int) -> dict[str, Any]:
        """Ranges of variables, joints that stand still, bodies that move as one."""
        from linkages.app.answer.mechanism_document import describe_motion

        return dict(describe_motion(atlas, form, self.readout))

    def document(self, atlas: Atlas) -> dict[str, Any]:
        """The mechanism."""
        from linkages.app.answer.mechanism_document import describe_mechanism

        return {"mechanism": describe_mechanism(atlas, self.readout)}

    def joint_values(self, points: np.ndarray) -> Values:
        """All variables, and the unit quaternions of spherical joints."""
        from linkages.export.model import quaternions_without_jumps

        columns = [self.readout.values(points)]
        names = self.readout.labels()
        for label, rotations in self.readout.rotations(points).items():
            columns.append(quaternions_without_jumps(rotations[None])[0])
            names += [f"{label}.q{part}" for part in "xyzw"]
        return Values(names, np.hstack(columns))

    def dataset_variables(self, atlas: Atlas) -> dict[str, Variable]:
        """All joint variables, those that are locked as well, and rotations."""
        from linkages.readout.dataset_variables import dataset_variables

        return dataset_variables(atlas, self.readout)

    def files(self) -> dict[str, Callable[[Path], object]]:
        """The graph of bodies and joints."""
        from linkages.mechanisms.graphml import write_mechanism_graph

        write = partial(write_mechanism_graph, self.readout.mechanism)
        return {"mechanism.graphml": write}


class NetworkSubject(MechanismSubject):
    """A ``network`` of Bennett loops, whose outer joints have names and locks of its
    own."""

    def __init__(self, network: NetworkMechanism):
        super().__init__(network)
        self.network = network

    def as_loop(self) -> Loop:
        """None: a network has several loops."""
        raise CommandError(
            f"{self.name}: it is a network, with several loops; --without-centre "
            "takes the single loop that its outer bars leave under --lock"
        )

    def place(self, point: np.ndarray) -> dict[str, Any]:
        """The variables by joint, and the angles of the outer joints."""
        values = self.readout.values(point[None])[0].tolist()
        by_label = dict(zip(self.readout.labels(), values, strict=True))
        ring_angles = self.network.placed.ring_values(by_label)
        return {**super().place(point), "ring_angles": ring_angles}

    def document(self, atlas: Atlas) -> dict[str, Any]:
        """The mechanism, and the network that it is."""
        network = self.network.placed.network
        values = {
            "name": network.name,
            "parameters": dict(network.parameters),
            "kinks": self.network.kinks,
        }
        return {**super().document(atlas), "network": values}


def as_subject(linkage: Linkage | Mechanism) -> Subject:
    """What `linkages.load` returns, as a subject."""
    if isinstance(linkage, Linkage):
        return LoopSubject(linkage.loop)
    from linkages.networks.mechanism import NetworkMechanism

    if isinstance(linkage, NetworkMechanism):
        return NetworkSubject(linkage)
    return MechanismSubject(linkage)


@lru_cache(maxsize=2)
def subject_at(atlas: Atlas) -> Subject:
    """What an atlas is of; raises `NoLinkageError` where that is no linkage."""
    return as_subject(_linkage_of(atlas))


def _linkage_of(atlas: Atlas) -> Linkage | Mechanism:
    if "mechanism" not in atlas.subject:
        return Linkage(loop_of(atlas))
    from linkages.mechanisms.subject import mechanism_of
    from linkages.networks.mechanism import network_of

    mechanism = network_of(atlas) or mechanism_of(atlas)
    assert mechanism is not None
    return mechanism


SHOWN_SHARE = 0.5e-4 / 360  # of a turn, that four digits of a degree do not show


def numbers_at(atlas: Atlas, point: NDArray[np.float64]) -> list[float]:
    """The unknowns (n,) of an atlas, angles between -pi and pi, lengths in the user's
    unit; of a mechanism that is a single loop the joint angles of this loop."""
    subject = subject_at(atlas)
    to_angles = subject.to_angles
    periods = atlas.periods[to_angles.columns]
    factors = subject.factors[to_angles.columns]
    numbers = wrap(to_angles.points(point), periods) * factors
    return [float(number) for number in numbers]


class ArclengthUnit(NamedTuple):
    """How arclengths are shown: times ``factor``, with ``name`` behind."""

    factor: float
    name: str


def arclength_unit(atlas: Atlas) -> ArclengthUnit:
    """The unit of arclengths on the screen: degrees, where all unknowns are angles;
    else that of the unknowns, in which lengths are over the characteristic length."""
    if set(atlas.units) == {"rad"}:
        return ArclengthUnit(float(np.degrees(1.0)), "deg")
    return ArclengthUnit(1.0, unit_of_arclengths(atlas))


def unit_of_arclengths(atlas: Atlas) -> str:
    """What arclengths count as they are in the atlas and in files: rad, lengths over
    the characteristic length, or both."""
    if set(atlas.units) == {"rad"}:
        return "rad"
    lengths = f"lengths over {subject_at(atlas).size:.4g}"
    return f"rad, {lengths}" if "rad" in atlas.units else lengths


def show_configuration(atlas: Atlas, point: NDArray[np.float64]) -> str:
    """The unknowns (n,) as text: angles in degrees, above -180 and up to 180, lengths
    in the user's unit; those of a mechanism from its reference configuration."""
    angles = wrap(point, atlas.periods, within=SHOWN_SHARE)
    return " ".join(f"{text:>9}" for text in show_travel(atlas, angles))


def show_travel(atlas: Atlas, point: NDArray[np.float64], digits: int = 4) -> list[str]:
    """The unknowns (n,) as texts, as they stand, with so many digits of a degree."""
    is_angle = [unit == "rad" for unit in atlas.units]
    texts = []
    for value, factor, angle in zip(
        point, subject_at(atlas).factors, is_angle, strict=True
    ):
        if angle:
            texts.append(in_degrees(value, digits))
        else:
            texts.append(in_lengths(factor * value, factor))
    return texts
