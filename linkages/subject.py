"""What moves, and what is read of it: bodies and joints, with a Denavit-Hartenberg table
where they are a single loop of revolute joints.

Whoever maps or shows a linkage asks its subject, and does not ask which of them it is.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, partial
from itertools import compress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bifurc.atlas import Atlas
from bifurc.isometry import Isometry
from bifurc.problem import Problem
from linkages.closure.closure import Closure
from linkages.entry import Linkage
from linkages.labelling import label_atlas, name_atlas, recount_labelled
from linkages.labels import FormLabels, loop_of, subject_of, table_values
from linkages.loop import LARGEST, SMALLEST, Loop
from linkages.mechanisms.mechanism import Lock, Mechanism
from linkages.networks.mechanism import mechanism_at
from linkages.statements import LinkageDoubt
from linkages.tolerance import make_with_errors
from linkages.values import GeometryError

if TYPE_CHECKING:
    # they import networkx, which the map of a loop does not need
    from bifurc.files.table import Variable
    from linkages.links.parts import Parts
    from linkages.readout.beyond_limits import LimitedRange
    from linkages.readout.readout import Readout
    from linkages.structure.single_loop import SingleLoop

FREEDOMS = 6  # of a body in space
MOST_SHOWN = 12  # unknowns that a table shows all of
# what unknowns are shown in, by the units of an atlas
UNITS = {"rad": "deg", "size": "lengths", "": "entries ax to bz of rotation matrices"}


class Subject(ABC):
    """What the unknowns of an atlas are the joints of.

    ``unknowns`` are their names in datasets and ``labels`` those on the screen.
    ``table`` is the Denavit-Hartenberg table, where there is one, and ``to_angles``
    leads from the unknowns to its joint angles; to the unknowns as they are, where there
    is none. ``size`` is the characteristic length, ``gruebler`` Grübler's count: the
    freedoms of the joints, less those that loops take. The unknowns (n,) times
    ``factors`` are in rad and the user's unit of length. ``readout`` reads the variables
    of joints by their names; None where joints have numbers only. A table ``is_exact``
    that is known to more digits than doubles have. ``places`` says where errors of
    manufacturing are.
    """

    name: str
    unknowns: Sequence[str]
    labels: Sequence[str]
    table: Loop | None = None
    to_angles: Isometry
    size: float
    gruebler: int
    factors: np.ndarray
    readout: Readout | None = None
    kind = "linkage"  # what it is called without a name
    is_exact = False
    places = ""

    @property
    def held_freedoms(self) -> int:
        """The freedoms of what hangs on it in no closed loop, and is held."""
        return 0

    # --- equations --------------------------------------------------------------------

    @property
    @abstractmethod
    def closure(self) -> Problem:
        """The closure equations in the unknowns of an atlas."""

    @property
    def traced(self) -> Problem:
        """Those in which it is mapped."""
        return self.closure

    @abstractmethod
    def labelled(self, atlas: Atlas) -> Atlas:
        """The atlas of it, from what was found of the equations that are traced."""

    def in_loop_angles(self, atlas: Atlas) -> Atlas:
        """An atlas of it in the joint angles of the table, which is the subject then; as
        it is, where there is none."""
        return atlas

    def simpler(self) -> Subject | None:
        """The same with creases of a sheet at rest, in which it leaves its flat state; None
        where it is not known to be left in such a way."""
        return None

    @abstractmethod
    def closure_with_errors(self, error: float, rng: np.random.Generator) -> Problem:
        """The closure equations of one that is made with errors, of that standard
        deviation: in rad, and in characteristic lengths. Raises `GeometryError` for an
        ``error`` that is negative or not finite."""

    # --- what is given ----------------------------------------------------------------

    @property
    @abstractmethod
    def parts(self) -> Parts:
        """The links or the bodies, as they are drawn."""

    @property
    def flat_parts(self) -> Parts:
        """The links, or the bodies by the names that a file gives them, that lie in
        layers where all move in a plane."""
        return self.parts

    def parts_for(self, trace: Sequence[str]) -> Parts:
        """The parts with which the points of a ``trace`` are drawn: these are of bodies
        by the names of the file."""
        return self.flat_parts if trace else self.parts

    @property
    def given_layers(self) -> Mapping[str, int]:
        """The layers of bodies that a file gives."""
        return {}

    @abstractmethod
    def as_loop(self) -> Loop:
        """The loop that it is without limits, and with one link for every joint that is
        locked; raises `GeometryError` where it is none."""

    def ranges_beyond_limits(
        self, map_linkage: Callable[..., Atlas]
    ) -> list[LimitedRange]:
        """What limited variables are without their limits, where these keep out all
        configurations."""
        return []

    @property
    def locks(self) -> Sequence[Lock]:
        """What is locked."""
        return ()

    def table_values(self) -> Mapping[str, Any]:
        """The name, and the table where there is one, in values that JSON can hold."""
        return {"name": self.name}

    def document(self, atlas: Atlas) -> dict[str, Any]:
        """What a JSON document says of it besides."""
        return {}

    def files(self) -> dict[str, Callable[[Path], object]]:
        """What writes files of the subject itself, by their names."""
        return {}

    # --- configurations ---------------------------------------------------------------

    @abstractmethod
    def heading(self, atlas: Atlas) -> str:
        """What stands above configurations."""

    def place(self, point: np.ndarray) -> dict[str, Any]:
        """What a JSON document says of a configuration (n,) besides its numbers; nothing
        where joints have numbers only, as in all that follows."""
        return {}

    def variable(self, index: int) -> dict[str, str]:
        """What it says of an unknown, by index, besides its number."""
        return {}

    def motion(self, atlas: Atlas, form: int) -> dict[str, Any]:
        """What it says of what joints and bodies do along a form, by index."""
        return {}

    @abstractmethod
    def joint_values(self, points: np.ndarray) -> tuple[Sequence[str], np.ndarray]:
        """The names of all joint variables, and their values (k, v) at configurations
        (k, n), rad and the user's unit."""

    def dataset_variables(self, atlas: Atlas) -> dict[str, Variable]:
        """What a dataset holds besides the atlas, by name."""
        return {}

    @abstractmethod
    def still_joints(self, atlas: Atlas, form: int) -> Sequence[str | int]:
        """The joints that stand still along a form, by index: numbers from 1 in a table,
        names elsewhere."""

    def still(self, index: int, value: str) -> str:
        """A joint that stands still at a value along a form, by the index of its unknown,
        as text; where it stands is said of a table."""
        return self.labels[index]


class LoopSubject(Subject):
    """A ``linkage`` that is given as a table, whose joint angles are the unknowns."""

    is_exact = True

    def __init__(self, linkage: Linkage):
        loop = linkage.loop
        self.linkage = linkage
        self.table: Loop = loop
        self.labels = [str(number + 1) for number in range(loop.n)]
        self.unknowns = [f"theta{number}" for number in self.labels]
        self.to_angles = Isometry.identity(loop.n)
        self.size = loop.characteristic_length
        self.name = loop.name
        self.gruebler = loop.n - FREEDOMS
        self.factors = np.ones(loop.n)

    @cached_property
    def closure(self) -> Problem:
        return _closure_of(self.table)

    def labelled(self, atlas: Atlas) -> Atlas:
        """With names of forms."""
        return name_atlas(atlas, self.linkage)

    def closure_with_errors(self, error: float, rng: np.random.Generator) -> Problem:
        """Errors are in every number of the table."""
        return Closure(make_with_errors(self.table, error, rng))

    @property
    def parts(self) -> Parts:
        """The links."""
        from linkages.links.parts import Links

        return Links(self.table, self.to_angles)

    def as_loop(self) -> Loop:
        """The table."""
        return self.table

    def table_values(self) -> Mapping[str, Any]:
        return table_values(self.table)

    def heading(self, atlas: Atlas) -> str:
        return "joint angles (deg)"

    def joint_values(self, points: np.ndarray) -> tuple[Sequence[str], np.ndarray]:
        return self.unknowns, points

    def still_joints(self, atlas: Atlas, form: int) -> Sequence[int]:
        return FormLabels.of(atlas.forms[form]).inactive_joints

    def still(self, index: int, value: str) -> str:
        return f"{self.labels[index]} at {value}"


class MechanismSubject(Subject):
    """A mechanism of any joints, read by its ``readout``; all its errors are of joints on
    bodies."""

    kind = "mechanism"
    places = " of joints on bodies"

    def __init__(self, readout: Readout):
        structure = readout.structure
        self.readout: Readout = readout
        self.mechanism = readout.mechanism
        self.labels = self.unknowns = [one.label for one in structure.unknowns]
        self.to_angles = Isometry.identity(len(self.unknowns))
        self.size = structure.unit
        self.name = self.mechanism.name
        self.gruebler = self.mechanism.gruebler
        self.factors = structure.scales

    @cached_property
    def closure(self) -> Closure:
        from linkages.readout.rigidity import is_as_drawn

        closure = self.readout.closure
        closure.as_drawn = partial(is_as_drawn, self.readout)
        return closure

    @property
    def held_freedoms(self) -> int:
        structure = self.readout.structure
        return structure.hanging.freedoms if structure.holds_flaps else 0

    @property
    def values(self) -> dict[str, Any]:
        """The ``subject`` of its atlas."""
        from linkages.mechanisms.subject import mechanism_subject

        return {
            **mechanism_subject(self.mechanism),
            # what unknowns are multiplied with to be in rad and in the user's unit
            "scale": self.factors.tolist(),
            "drawn": self.readout.structure.reference.tolist(),
            "drivers": self.drivers,
        }

    @property
    def drivers(self) -> list[int]:
        """The unknowns, by index, of the joint that drives, else of those with motors or
        of the first that is free, and of those with limits, which every slide has."""
        unknown = set(self.labels)
        free = [one for one in self.mechanism.variables if one.label in unknown]
        limited = [one for one in free if one.limits or not one.motion.is_turn]
        driver, motors = self.mechanism.driver, self.mechanism.motors
        drives = [one for one in free if one.label == driver]
        drives = drives or [one for one in free if one.label in motors] or free[:1]
        labels = {one.label for one in [*drives, *limited]}
        return [k for k, label in enumerate(self.labels) if label in labels]

    def simpler(self) -> MechanismSubject | None:
        if not self.readout.structure.flat_vertices:
            return None  # of a single loop there are no other equations to be made
        ways = self.closure.flat_state.ways
        if not ways or not ways[0].rest.any():
            return None
        at_rest = (*self.mechanism.at_rest, *compress(self.labels, ways[0].rest))
        other = _of_mechanism(replace(self.mechanism, at_rest=at_rest))
        # fewer creases may leave it in another way
        return other.simpler() or other

    def labelled(self, atlas: Atlas) -> Atlas:
        """With labels on the forms."""
        labelled = label_atlas(atlas, self.closure, self.values)
        return self._as_assigned(self._with_doubt(labelled))

    def _with_doubt(self, atlas: Atlas) -> Atlas:
        """The atlas with what is in doubt where creases are at rest that may fold."""
        count = len(self.mechanism.at_rest)
        if not count:
            return atlas
        doubts = (*atlas.completeness.doubts, LinkageDoubt.AT_REST.doubt(count=count))
        return replace(atlas, completeness=replace(atlas.completeness, doubts=doubts))

    def _as_assigned(self, atlas: Atlas) -> Atlas:
        """The atlas with the names of forms that fold creases as they are assigned."""
        from linkages.readout.assignment import named_as_assigned

        return named_as_assigned(atlas, self.readout)

    def closure_with_errors(self, error: float, rng: np.random.Generator) -> Problem:
        """Every joint is off on each body that it joins (`draw_errors`): out of the
        plane, too, where the mechanism is planar."""
        from linkages.closure.errors import draw_errors

        structure = self.readout.structure
        errors = draw_errors(structure, error, rng)
        return Closure(self.mechanism, errors, structure)

    @cached_property
    def parts(self) -> Parts:
        """The bodies."""
        return self.flat_parts

    @property
    def flat_parts(self) -> Parts:
        from linkages.links.parts import Bodies

        return Bodies(self.readout.structure)

    @property
    def given_layers(self) -> Mapping[str, int]:
        return dict(self.mechanism.layers)

    def as_loop(self) -> Loop:
        """The loop through the axes of the joints."""
        from linkages.structure.single_loop import loop_geometry

        return loop_geometry(self.mechanism)

    @property
    def locks(self) -> Sequence[Lock]:
        return self.mechanism.locks

    def ranges_beyond_limits(
        self, map_linkage: Callable[..., Atlas]
    ) -> list[LimitedRange]:
        """Those of the mechanism without limits."""
        from linkages.readout.beyond_limits import ranges_beyond_limits

        return ranges_beyond_limits(self.mechanism, map_linkage)

    def document(self, atlas: Atlas) -> dict[str, Any]:
        """The mechanism, and the network that it may be."""
        from linkages.readout.mechanism_document import describe_mechanism

        described = {"mechanism": describe_mechanism(atlas, self.readout)}
        return {**described, **self.mechanism.document_values()}

    def files(self) -> dict[str, Callable[[Path], object]]:
        """The graph of bodies and joints."""
        from linkages.mechanisms.graphml import write_mechanism_graph

        write = partial(write_mechanism_graph, self.mechanism)
        return {"mechanism.graphml": write}

    def heading(self, atlas: Atlas) -> str:
        units = [words for unit, words in UNITS.items() if unit in atlas.units]
        names = ", ".join(self.labels)
        if len(self.labels) > MOST_SHOWN:
            names = "what is not 0"
        return f"{names} ({', '.join(units)})"

    def place(self, point: np.ndarray) -> dict[str, Any]:
        """The variables by joint, and the angles of the outer joints of a network."""
        place: dict[str, Any] = {"variables": self.readout.variables(point)}
        values = self.readout.values(point[None])[0].tolist()
        by_label = dict(zip(self.readout.labels(), values, strict=True))
        outer = {
            one.name: one.angle(by_label[one.label])
            for one in self.mechanism.outer_joints
        }
        return {**place, "ring_angles": outer} if outer else place

    def variable(self, index: int) -> dict[str, str]:
        """The label of the unknown."""
        return {"variable": self.labels[index]}

    def motion(self, atlas: Atlas, form: int) -> dict[str, Any]:
        """Ranges of variables, joints that stand still, bodies that move as one."""
        from linkages.readout.mechanism_document import describe_motion

        return describe_motion(atlas, form, self.readout)

    def joint_values(self, points: np.ndarray) -> tuple[Sequence[str], np.ndarray]:
        """All variables, and the unit quaternions of spherical joints."""
        from linkages.readout.poses import quaternions_without_jumps

        columns = [self.readout.values(points)]
        names = self.readout.labels()
        for label, rotations in self.readout.rotations(points).items():
            columns.append(quaternions_without_jumps(rotations[None])[0])
            names += [f"{label}.q{part}" for part in "xyzw"]
        return names, np.hstack(columns)

    def dataset_variables(self, atlas: Atlas) -> dict[str, Variable]:
        """All joint variables, those that are locked as well, and rotations."""
        from linkages.readout.dataset_variables import dataset_variables

        return dataset_variables(atlas, self.readout)

    def still_joints(self, atlas: Atlas, form: int) -> Sequence[str]:
        from linkages.readout.facts import form_facts

        return form_facts(atlas, form, self.readout).still


class SingleLoopSubject(MechanismSubject):
    """A mechanism that is a ``single`` loop of revolute joints: mapped and drawn as that,
    and shown in the variables of its joints."""

    def __init__(self, readout: Readout, single: SingleLoop):
        super().__init__(readout)
        self.single = single
        self.table: Loop = single.loop
        self.to_angles = single.to_unknowns(readout.structure).inverse

    @cached_property
    def traced(self) -> Problem:
        """The closure of the loop."""
        return _closure_of(self.table)

    def labelled(self, atlas: Atlas) -> Atlas:
        """With names of forms, in the variables of the joints."""
        named = name_atlas(atlas, Linkage(self.table))
        back = self.to_angles.inverse
        recounted = recount_labelled(named, back, self.unknowns, self.values)
        return self._as_assigned(self._with_doubt(recounted))

    def in_loop_angles(self, atlas: Atlas) -> Atlas:
        names, subject = self.traced.domain.names, subject_of(self.table)
        return recount_labelled(atlas, self.to_angles, names, subject)

    @cached_property
    def parts(self) -> Parts:
        """The links; the bodies, where they are panels, or others hang on them."""
        from linkages.links.parts import Bodies, Links

        if self.mechanism.panels or self.readout.structure.hanging.pairs:
            return Bodies(self.readout.structure)
        return Links(self.table, self.to_angles, self.unknowns, self.orientation)

    @property
    def orientation(self) -> np.ndarray:
        """The rotation (3, 3) that brings the frame of the first joint of the loop to
        where it is in the reference configuration of the mechanism."""
        return self.single.orientation(self.readout.structure)

    def table_values(self) -> Mapping[str, Any]:
        return table_values(self.table)


def _closure_of(loop: Loop) -> Closure:
    """The closure of a loop; raises `GeometryError` for lengths whose squares leave the
    range of doubles."""
    size = loop.characteristic_length
    if not SMALLEST < size < LARGEST:
        allowed = f"between {SMALLEST:g} and {LARGEST:g}; choose another unit"
        raise GeometryError("characteristic length", f"{size:.1g}", allowed)
    return Closure(loop)


def as_subject(linkage: Linkage | Loop | Mechanism) -> Subject:
    """What `linkages.load` returns, or a loop, as a subject; raises `GeometryError` for
    anything else."""
    match linkage:
        case Loop():
            return LoopSubject(Linkage(linkage))
        case Linkage():
            return LoopSubject(linkage)
        case Mechanism():
            return _of_mechanism(linkage)
    allowed = "what `linkages.load` returns, a `Linkage` or a `Mechanism`, or a `Loop`"
    raise GeometryError("linkage", repr(linkage), allowed)


def _of_mechanism(mechanism: Mechanism) -> MechanismSubject:
    from linkages.readout.readout import Readout

    readout = Readout(mechanism)
    single = readout.single_loop
    if single is None:
        return MechanismSubject(readout)
    return SingleLoopSubject(readout, single)


_LATEST: dict[Atlas, Subject] = {}  # the last that were asked for
MOST_KEPT = 8


def subject_at(atlas: Atlas) -> Subject:
    """The subject of an atlas; raises `NoLinkageError` where it is no linkage."""
    if atlas not in _LATEST:
        _keep(atlas, as_subject(mechanism_at(atlas) or loop_of(atlas)))
    return _LATEST[atlas]


def keep_subject(atlas: Atlas, subject: Subject) -> None:
    """Let a mechanism be the subject of an atlas as it is, with its loops and equations:
    those of a large one take long."""
    if isinstance(subject, MechanismSubject):
        _keep(atlas, subject)


def _keep(atlas: Atlas, subject: Subject) -> None:
    _LATEST[atlas] = subject
    if len(_LATEST) > MOST_KEPT:
        del _LATEST[next(iter(_LATEST))]
