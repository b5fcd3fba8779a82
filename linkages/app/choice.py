"""The linkage that a command line names, an entry of the catalogue with parameters or a
file, with the joints that it locks or drives."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import click
import numpy as np

from bifurc.files.text_file import read_text
from bifurc.limits import Deadline, made_before_the_end, until
from linkages.app.exit_codes import CommandError
from linkages.app.options import AtlasOptions, HoldOptions
from linkages.arrays.entries import MECHANISMS
from linkages.catalogue import entry
from linkages.entry import Entry, Linkage, Parameter, ParameterKind
from linkages.file import read_linkage, read_precisely
from linkages.files.csv_table import from_modified, says_modified
from linkages.linkage import is_linkage_file, load
from linkages.loop import LARGEST, SMALLEST, Loop
from linkages.mechanisms.entry import MechanismEntry
from linkages.networks.entries import NETWORKS, NetworkEntry
from linkages.values import GeometryError, check_angle, require, told_apart

if TYPE_CHECKING:
    from linkages.mechanisms.mechanism import Mechanism
    from linkages.networks.mechanism import NetworkMechanism


Kind = TypeVar("Kind")
NOTHING_HELD = HoldOptions()


def require_kind(value: object, kind: type[Kind], refusal: str) -> Kind:
    """A value of this kind; raises `CommandError` for another one."""
    if not isinstance(value, kind):
        raise CommandError(refusal)
    return value


def require_table(text: str, table: Loop | None) -> Loop:
    """The table of what is called ``text``; raises `CommandError` where there is
    none."""
    if table is None:
        raise CommandError(
            f"{text}: it is a mechanism, which `bifurc export` writes to .glb, .csv, .svg "
            "and .dxf, planar ones to .stl and .step, and `bifurc convert` to the formats "
            "of mechanisms; this takes single loops of 4 to 12 revolute joints so far"
        )
    return table


def choose_linkage(
    text: str, parameters: Sequence[str] = (), hold: HoldOptions = NOTHING_HELD
) -> Linkage | Mechanism:
    """The linkage called ``text``, or the linkage or mechanism read from the file
    ``text`` if that is one (or ends with .toml).

    ``parameters`` are "key=value", angles in degrees; those of a file are its numbers.
    Of ``hold`` counts how files and sheets are read. Raises `CommandError`,
    `GeometryError`, `UnknownLinkageError` and `LinkageFileError`.
    """
    try:
        linkage = _loaded(text, parameters, hold)
    except OverflowError:
        raise CommandError(f"{text}: it holds a number that is too large") from None
    _require_size(text, linkage)
    return linkage


def _loaded(
    text: str, parameters: Sequence[str], hold: HoldOptions
) -> Linkage | Mechanism:
    """What is called ``text``, with parameters "key=value", those of a file among its
    numbers, or as it is read by options."""
    closures, triangulated = hold.closures, hold.triangulated
    if not parameters:
        return load(text, closures=closures, triangulated=triangulated)
    if is_linkage_file(text):
        reading = {"--closures": closures, "--triangulated": triangulated}
        for option, value in reading.items():
            require(not value, "--param", parameters[0], f"left out with {option}")
        from linkages.parameters.file_family import family_of_file

        of_file = family_of_file(text)
        member = of_file.build(**read_parameters(of_file.parameters, parameters))
        return Linkage(member) if isinstance(member, Loop) else member
    family: Entry | NetworkEntry | MechanismEntry
    family = NETWORKS.get(text) or MECHANISMS.get(text) or entry(text)
    values = read_parameters(family.parameters, parameters)
    return load(text, closures=closures, triangulated=triangulated, **values)


def _require_size(text: str, linkage: Linkage | Mechanism) -> None:
    """Raise `CommandError` for lengths whose squares leave the range of doubles."""
    with np.errstate(over="ignore"):
        size = linkage.extent
    if not SMALLEST < size < LARGEST:
        raise CommandError(
            f"{text}: the lengths are about {size:.1g}; choose a unit in which they "
            f"are between {SMALLEST:g} and {LARGEST:g}"
        )


def choose_precisely(text: str, parameters: Sequence[str] = ()) -> Loop:
    """The loop that `choose_linkage` finds, in mpmath numbers at the precision that is
    set.

    Parameters of a named linkage keep the values that its doubles have, and the
    constructor works on them exactly.
    """
    import mpmath

    if is_linkage_file(text):
        return read_precisely(text)
    family = entry(text)
    values = family.complete(read_parameters(family.parameters, parameters))
    exact = {name: mpmath.mpf(value) for name, value in values.items()}
    return family.build(**exact)


def read_parameters(
    known: Sequence[Parameter], texts: Sequence[str]
) -> dict[str, float]:
    """The parameters in "key=value", those ``known`` as angles turned from degrees to
    rad; raises `CommandError`.

    Whether a family has parameters of these names is for `Entry.complete` to say.
    """
    angles = {one.name for one in known if one.kind is ParameterKind.ANGLE}
    return _read_values(texts, "--param", lambda name: name in angles)


def _read_values(
    texts: Sequence[str], option: str, is_angle: Callable[[str], bool]
) -> dict[str, float]:
    """The numbers of "key=value" behind an option, angles turned from degrees to rad;
    raises `CommandError` and `GeometryError`."""
    values: dict[str, float] = {}
    for text in texts:
        name, value = split_parameter(text, option)
        if name in values:
            raise CommandError(f"{option} {name}: it is given twice")
        number = read_number(name, value, option)
        if is_angle(name):
            check_angle(f"{option} {name}", number, in_degrees=True)
            number = math.radians(number)
        values[name] = number
    return values


def split_parameter(text: str, option: str = "--param") -> tuple[str, str]:
    """Name and value of "key=value" behind an option; raises `GeometryError`."""
    name, equals, value = text.partition("=")
    if not equals:
        raise GeometryError(option, repr(text), "of the form key=value")
    return name.strip(), value


def read_number(name: str, text: str, option: str = "--param") -> float:
    """The finite number that ``text`` is, for what is called ``name`` behind an
    option; raises `GeometryError`."""
    try:
        number = float(text)
    except ValueError:
        raise GeometryError(f"{option} {name}", repr(text), "a number") from None
    if not math.isfinite(number):
        raise GeometryError(f"{option} {name}", number, "a finite number")
    return number


# why something has no centre to be left without
NO_NETWORK = "--without-centre: it takes a network, and {} is none"


@dataclass(frozen=True)
class Inputs:
    """A mechanism with joints held for a command, and ``notes`` on those that nobody
    asked for."""

    mechanism: Linkage | Mechanism
    notes: tuple[str, ...] = ()


def choose_in_time(
    text: str, choice: AtlasOptions, deadline: Deadline
) -> Linkage | Mechanism:
    """What `choose_held` gives; raises `OutOfTimeError` where it is not read before a
    deadline."""
    with until(deadline):
        return made_before_the_end(
            f"while {text} was read",
            lambda: choose_held(text, choice.parameters, choice.hold),
        )


def choose_held(
    text: str, parameters: Sequence[str], hold: HoldOptions
) -> Linkage | Mechanism:
    """What `choose_linkage` finds, with joints held; what nobody asked for is said on
    standard error. Raises as `choose_linkage` and `hold_joints`."""
    linkage = choose_linkage(text, parameters, hold)
    inputs = hold_joints(text, linkage, hold)
    for note in inputs.notes:
        click.echo(note, err=True)
    return inputs.mechanism


def hold_joints(text: str, linkage: Linkage | Mechanism, hold: HoldOptions) -> Inputs:
    """The mechanism called ``text`` with the locks, each "J=40", angles in degrees, and
    slides in the file's unit of length, and what else has to be held for one joint to
    drive it; of a network, where that is asked for, the loop without its centre.

    Raises `CommandError` for a linkage that takes none, `GeometryError` for a joint
    that it does not have.
    """
    if hold == NOTHING_HELD:
        return Inputs(linkage)
    if hold.is_modified:
        table = _require_usual_table(text, linkage)
        linkage = Linkage(from_modified(table))
        return hold_joints(text, linkage, replace(hold, is_modified=False))
    if hold.is_without_centre:
        _require_network(text, linkage)
    from linkages.mechanisms.mechanism import Mechanism

    refusal = (
        f"{hold.names}: it takes a mechanism with joints by name, and {text} is a "
        "single loop, a table or axes"
    )
    mechanism = _part(require_kind(linkage, Mechanism, refusal), hold.part)
    mechanism = replace(
        mechanism,
        with_flaps=hold.with_flaps,
        with_flat_creases=hold.with_flat_creases,
    )
    if hold.free_creases:
        mechanism = mechanism.with_free_creases()
    values = _read_values(hold.locks, "--lock", mechanism.holds_angle)
    check_limits(mechanism, values)
    locked = mechanism.held(values)
    inputs = Inputs(locked) if hold.driver is None else _driven(locked, hold.driver)
    if not hold.is_without_centre:
        return inputs
    loop = _without_centre(_require_network(text, inputs.mechanism))
    return Inputs(loop.mechanism, inputs.notes + loop.notes)


def _require_usual_table(text: str, linkage: Linkage | Mechanism) -> Loop:
    """The table in a file, as it is read in the usual convention; raises `CommandError`
    for what is no table in a file, and for one that says that it is in the other."""
    refusal = f"--modified-dh: it takes a file with a table, and {text} is none"
    table = require_kind(linkage, Linkage, refusal).loop
    if not is_linkage_file(text) or read_linkage(text)[1] is not None:
        raise CommandError(refusal)
    path = Path(text)
    if path.suffix.lower() == ".csv" and says_modified(read_text(path)):
        raise CommandError(f"--modified-dh: the headings of {text} say so themselves")
    return table


def _part(mechanism: Mechanism, number: int | None) -> Mechanism:
    """The part of this number, from 1; all of it without one."""
    if number is None:
        return mechanism
    parts = mechanism.parts
    allowed = f"from 1 to {len(parts)}, as it consists of so many mechanisms"
    require(number <= len(parts), "--part", number, allowed)
    return parts[number - 1]


def _driven(mechanism: Mechanism, driver: str) -> Inputs:
    """The mechanism with what has to be held for one joint to drive it."""
    from linkages.closure.driving import joints_to_hold

    held = joints_to_hold(mechanism, driver)
    notes: tuple[str, ...] = ()
    if held:
        names = ", ".join(held)
        notes = (
            f"--drive {driver}: so that it drives all, also held where they are in the "
            f"reference configuration: {names}",
        )
    return Inputs(replace(mechanism.with_locks(held), driver=driver), notes)


def read_kinks(texts: Sequence[str], option: str = "--lock") -> dict[str, float]:
    """The D-H angles, rad, by the names of joints, of "2=40", in degrees; raises
    `CommandError` and `GeometryError`."""
    return _read_values(texts, option, lambda joint: True)


def _require_network(text: str, linkage: Linkage | Mechanism) -> NetworkMechanism:
    from linkages.networks.mechanism import NetworkMechanism

    return require_kind(linkage, NetworkMechanism, NO_NETWORK.format(text))


def _without_centre(network: NetworkMechanism) -> Inputs:
    """The single loop that is left of a network without the bars inside."""
    loop, still = network.without_centre()
    note = (
        "--without-centre: every motion of the network is one of this loop, and the "
        "loop may have more: taking the middle away adds forms and bifurcations"
    )
    followers = [joint for joint in still if joint not in network.kinks]
    notes: tuple[str, ...] = (note,)
    if followers:
        names = ", ".join(followers)
        notes += (f"--without-centre: replaced as well, for it does not move: {names}",)
    return Inputs(Linkage(loop), notes)


def check_limits(mechanism: Mechanism, values: Mapping[str, float]) -> None:
    """Raise `GeometryError`, in degrees, for a lock, by the label of its variable,
    outside the limits of a file."""
    for one in mechanism.variables:
        value = values.get(one.label)
        if value is None or one.limits is None:
            continue
        low, high = one.limits
        if low <= value <= high:
            continue
        unit = math.radians(1.0) if one.motion.is_turn else 1.0
        word = " deg" if one.motion.is_turn else ""
        shown, least, most = told_apart(value / unit, low / unit, high / unit)
        allowed = f"within its limits {least} to {most}{word}"
        raise GeometryError(f"--lock {one.label}", f"{shown}{word}", allowed)
