"""What is swept: a family or a network of the catalogue, the table, the mechanism or the
equations of a file; the quantities of it that can be varied, and its members at their values."""

from __future__ import annotations

import hashlib
import json
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, TypeAlias
from urllib.parse import quote

from linkages.app.choice import NO_NETWORK, check_limits, choose_linkage
from linkages.app.exit_codes import CommandError
from linkages.catalogue import entry
from linkages.entry import Linkage, Parameter, ParameterKind
from linkages.labels import FormLabels
from linkages.linkage import is_linkage_file, load
from linkages.mapping import map_linkage
from linkages.networks.entries import LENGTHS, NETWORKS
from linkages.parameters.table_family import family_of_table
from linkages.subject import subject_at

if TYPE_CHECKING:
    from bifurc.atlas import Atlas, Form
    from bifurc.settings import SearchSettings
    from bifurc.systems.equation_file import EquationFile, EquationSystem
    from linkages.loop import Loop
    from linkages.mechanisms.mechanism import Mechanism
    from linkages.parameters.mechanism_family import MechanismFamily

JointName: TypeAlias = str | int

PARAM = "--param"
LOCK = "--lock"


@dataclass(frozen=True)
class Quantity:
    """A parameter, or the value at which a joint is locked.

    ``name`` is what it is called in the dataset, ``key`` what behind its ``option`` on
    the command line. ``bounds`` are those of a random draw (rad for angles), where the
    catalogue has some.
    """

    name: str
    key: str
    option: str
    is_angle: bool
    meaning: str
    bounds: tuple[float, float] | None = None

    @classmethod
    def of_parameter(cls, parameter: Parameter) -> Quantity:
        """The parameter of a family or of a network."""
        name = parameter.name
        is_angle = parameter.kind is ParameterKind.ANGLE
        bounds = (parameter.low, parameter.high)
        return cls(name, name, PARAM, is_angle, f"{name} of the member", bounds)

    @classmethod
    def of_number(cls, parameter: Parameter) -> Quantity:
        """A number of a file, which is drawn from no range but a given one."""
        name = quote(parameter.name, safe="")
        of_parameter = cls.of_parameter(parameter)
        return replace(of_parameter, name=name, key=parameter.name, bounds=None)

    @classmethod
    def of_lock(cls, joint: str, is_angle: bool) -> Quantity:
        """The value at which a joint, or one variable of it, is locked."""
        # any text is the name of a joint; not so of an array and of its folder
        name = f"lock_{quote(joint, safe='')}"
        return cls(name, joint, LOCK, is_angle, f"value at which {joint} is locked")

    @classmethod
    def of_constant(cls, name: str) -> Quantity:
        """A constant of a file of equations."""
        return cls(name, name, PARAM, False, f"{name} of the equations")

    @property
    def unit(self) -> str:
        """The unit of its values in the dataset; none for lengths, which have that of
        the user."""
        return "rad" if self.is_angle else ""


class Member(ABC):
    """What is mapped."""

    @abstractmethod
    def atlas(self, settings: SearchSettings, seed: int) -> Atlas:
        """Its map; raises `GeometryError` for what cannot be mapped."""

    @abstractmethod
    def still_joints(self, atlas: Atlas, form: int) -> set[JointName]:
        """The joints of the subject that stand still in a form of its map."""

    @abstractmethod
    def closure(self, form: Form) -> float:
        """By how much a form misses the equations."""


@dataclass(frozen=True)
class LinkageMember(Member):
    """A linkage or a mechanism that is mapped.

    ``joints`` are the names of the joints of a loop, where they have some; ``replaced``
    are joints of the subject that it does not have, since they stand still.
    """

    linkage: Linkage | Mechanism
    joints: tuple[JointName, ...] = ()
    replaced: tuple[JointName, ...] = ()

    def atlas(self, settings: SearchSettings, seed: int) -> Atlas:
        return map_linkage(self.linkage, settings=settings, seed=seed)

    def still_joints(self, atlas: Atlas, form: int) -> set[JointName]:
        names: dict[JointName, JointName] = dict(enumerate(self.joints, start=1))
        still = subject_at(atlas).still_joints(atlas, form)
        return {names.get(one, one) for one in still} | {*self.replaced}

    def closure(self, form: Form) -> float:
        return FormLabels.of(form).max_residual


@dataclass(frozen=True)
class EquationMember(Member):
    """The equations of a file with values of its constants."""

    system: EquationSystem

    def atlas(self, settings: SearchSettings, seed: int) -> Atlas:
        return self.system.explore(settings=settings, seed=seed)

    def still_joints(self, atlas: Atlas, form: int) -> set[JointName]:
        return set()

    def closure(self, form: Form) -> float:
        return form.branch.max_residual


class MemberSource(ABC):
    """What is swept."""

    @property
    @abstractmethod
    def identity(self) -> dict[str, object]:
        """Plain values by which a journal knows the subject again."""

    @property
    @abstractmethod
    def quantities(self) -> Sequence[Quantity]:
        """All that can be varied."""

    @property
    @abstractmethod
    def joints(self) -> tuple[JointName, ...]:
        """The names, or the numbers from 1, of the joints of every member."""

    @abstractmethod
    def member(self, values: Mapping[str, float]) -> Member:
        """The member at values of quantities, by name, in rad for angles; raises
        `GeometryError` for those that it refuses."""

    def quantity(self, name: str) -> Quantity:
        """The quantity that has this name in the dataset."""
        return next(one for one in self.quantities if one.name == name)

    def by_key(self, option: str, values: Mapping[str, float]) -> dict[str, float]:
        """Those of the values, by name, that stand behind an option, by their keys
        there."""
        chosen = [one for one in self.quantities if one.option == option]
        return {one.key: values[one.name] for one in chosen if one.name in values}


@dataclass(frozen=True)
class Family(MemberSource):
    """The family called ``name``; raises `UnknownLinkageError` where it is used and
    there is none."""

    name: str

    @property
    def identity(self) -> dict[str, object]:
        return {"family": self.name}

    @cached_property
    def quantities(self) -> Sequence[Quantity]:
        return [Quantity.of_parameter(one) for one in entry(self.name).parameters]

    @cached_property
    def joints(self) -> tuple[JointName, ...]:
        return tuple(range(1, entry(self.name).build().n + 1))

    def member(self, values: Mapping[str, float]) -> Member:
        """The member with the forms that its source names."""
        return LinkageMember(
            load(self.name, closures=None, triangulated=False, **values)
        )


@dataclass(frozen=True)
class NetworkFamily(MemberSource):
    """The network of Bennett loops called ``name``, with joints locked, or the loop
    that its outer bars leave."""

    name: str
    is_without_centre: bool = False

    @property
    def identity(self) -> dict[str, object]:
        return {"network": self.name, "without_centre": self.is_without_centre}

    @cached_property
    def quantities(self) -> Sequence[Quantity]:
        source = NETWORKS[self.name]
        drawn = [Quantity.of_parameter(one) for one in source.parameters]
        # they follow from the others, and are only checked where they are given
        checked = [
            Quantity(name, name, PARAM, False, f"{name} of the member")
            for name in LENGTHS
        ]
        locks = [Quantity.of_lock(axis, True) for axis in source.plan.ring]
        return [*drawn, *checked, *locks]

    @property
    def joints(self) -> tuple[JointName, ...]:
        plan = NETWORKS[self.name].plan
        return plan.ring if self.is_without_centre else plan.axes

    def member(self, values: Mapping[str, float]) -> Member:
        from linkages.networks.mechanism import lock_network

        network = NETWORKS[self.name].build(**self.by_key(PARAM, values))
        mechanism = lock_network(network, self.by_key(LOCK, values))
        if not self.is_without_centre:
            return LinkageMember(mechanism)
        loop, still = mechanism.without_centre()
        left = tuple(axis for axis in network.plan.ring if axis not in still)
        return LinkageMember(Linkage(loop), left, still)


@dataclass(frozen=True)
class FileTable(MemberSource):
    """The ``loop`` that was read from a file, with other entries of its table."""

    loop: Loop

    @cached_property
    def identity(self) -> dict[str, object]:
        """The name, and a fingerprint of the table."""
        table = [list(map(float, row)) for row in self.loop.arrays]
        return {"table": self.loop.name, "fingerprint": _fingerprint({"table": table})}

    @cached_property
    def quantities(self) -> Sequence[Quantity]:
        parameters = family_of_table(self.loop).parameters
        return [Quantity.of_number(one) for one in parameters]

    @property
    def joints(self) -> tuple[JointName, ...]:
        return tuple(range(1, self.loop.n + 1))

    def member(self, values: Mapping[str, float]) -> Member:
        loop = family_of_table(self.loop).build(**self.by_key(PARAM, values))
        return LinkageMember(Linkage(loop))


@dataclass(frozen=True)
class FileMechanism(MemberSource):
    """The mechanism that was read from a file, a ``family`` by its numbers, with joints
    locked."""

    family: MechanismFamily

    @cached_property
    def identity(self) -> dict[str, object]:
        """The name, and a fingerprint of all that the file says."""
        from linkages.mechanisms.subject import mechanism_subject

        mechanism = self.family.mechanism
        values = mechanism_subject(mechanism)["mechanism"]
        return {"mechanism": mechanism.name, "fingerprint": _fingerprint(values)}

    @cached_property
    def quantities(self) -> Sequence[Quantity]:
        numbers = [Quantity.of_number(one) for one in self.family.parameters]
        locks = [
            Quantity.of_lock(one.label, one.motion.is_turn)
            for one in self.family.mechanism.variables
        ]
        return [*numbers, *locks]

    @property
    def joints(self) -> tuple[JointName, ...]:
        return tuple(joint.name for joint in self.family.mechanism.joints)

    def member(self, values: Mapping[str, float]) -> Member:
        locks = self.by_key(LOCK, values)
        mechanism = self.family.build(**self.by_key(PARAM, values))
        check_limits(mechanism, locks)
        return LinkageMember(mechanism.with_locks(locks))


@dataclass(frozen=True)
class FileEquations(MemberSource):
    """The equations called ``name`` that were read from a file, whose constants can be
    varied."""

    name: str
    file: EquationFile

    @cached_property
    def identity(self) -> dict[str, object]:
        """The name, and a fingerprint of all that the file says."""
        return {"equations": self.name, "fingerprint": _fingerprint(self.file.content)}

    @cached_property
    def quantities(self) -> Sequence[Quantity]:
        return [Quantity.of_constant(name) for name in self.file.constants]

    @property
    def joints(self) -> tuple[JointName, ...]:
        return ()

    def member(self, values: Mapping[str, float]) -> Member:
        """The equations with these constants; raises `EquationFileError`."""
        return EquationMember(self.file.system(values))


def _fingerprint(values: Mapping[str, object]) -> str:
    """What is the same for the same values that JSON can hold."""
    text = json.dumps(values, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def choose_subject(text: str, is_without_centre: bool = False) -> MemberSource:
    """What is called ``text`` in the catalogue, or is in the file ``text``.

    Raises as `choose_linkage`, `EquationFileError`, and `CommandError` for anything but a
    network without its centre.
    """
    if text in NETWORKS and not is_linkage_file(text):
        return NetworkFamily(text, is_without_centre)
    if not is_linkage_file(text):
        entry(text)  # who has mistyped a name is told that first
    if is_without_centre:
        raise CommandError(NO_NETWORK.format(text))
    if not is_linkage_file(text):
        return Family(text)
    equations = _equations_in(text)
    if equations is not None:
        return FileEquations(equations.system({}).name, equations)
    chosen = choose_linkage(text)
    if isinstance(chosen, Linkage):
        return FileTable(chosen.loop)
    from linkages.parameters.file_family import mechanism_family

    return FileMechanism(mechanism_family(text, chosen))


def _equations_in(text: str) -> EquationFile | None:
    """The file called ``text`` where it is one of equations."""
    if not text.lower().endswith(".toml"):
        return None
    from bifurc.systems.equation_file import EquationFile, EquationFileError

    try:
        file = EquationFile.read(text)
    except EquationFileError:  # who reads it as a mechanism says what is wrong
        return None
    return file if file.is_of_equations else None
