"""Options and arguments that several commands share."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from linkages.app.output import say_more

if TYPE_CHECKING:
    from bifurc.settings import SearchSettings


Command = Callable[..., None]
Option = Callable[[Command], Command]

MOST_STARTS = 1_000_000
LARGEST_SEED = 2**63 - 1  # files store the seed as a signed number of 64 bits


class NumberRange(click.FloatRange):
    """A range of floats. "Not a number" compares with no bound, and is refused;
    infinity only goes where ``allows_infinity`` says so."""

    def __init__(
        self,
        min: float | None = None,
        max: float | None = None,
        min_open: bool = False,
        allows_infinity: bool = False,
    ):
        self.allows_infinity = allows_infinity
        super().__init__(min=min, max=max, min_open=min_open)

    def convert(
        self, value: float, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """The number that ``value``, also as text, is; raises `click.BadParameter`."""
        number = float(super().convert(value, param, ctx))
        if math.isnan(number):
            self.fail(f"{value} is not a number.", param, ctx)
        if math.isinf(number) and not self.allows_infinity:
            allowed = self._describe_range()
            self.fail(f"{value} is not a finite number in {allowed}.", param, ctx)
        return number


class NamedPath(click.Path):
    """The path of a file or a folder that has a name: an empty text would stand for the
    current folder."""

    def __init__(self, *, file_okay: bool = True, dir_okay: bool = True):
        super().__init__(path_type=Path, file_okay=file_okay, dir_okay=dir_okay)

    def convert(
        self,
        value: str | os.PathLike[str],
        param: click.Parameter | None,
        ctx: click.Context | None,
    ) -> str | bytes | os.PathLike[str]:
        """The path that ``value`` is; raises `click.BadParameter`."""
        if not os.fspath(value).strip():
            kind = "folder" if self.dir_okay else "file"
            self.fail(f"{value!r} is no name of a {kind}.", param, ctx)
        return super().convert(value, param, ctx)


FILE = NamedPath(dir_okay=False)
FOLDER = NamedPath(file_okay=False)


class JointWords(click.ParamType[tuple[str, ...]]):
    """Names or numbers of different joints, separated by commas: ``least`` to ``most``
    of them, as a tuple."""

    name = "joints"
    numbered = "names, or numbers from 1"

    def __init__(self, least: int, most: int):
        self.least = least
        self.most = most

    @property
    def how_many(self) -> str:
        """How many of them there must be, in words."""
        if self.least == self.most:
            return {1: "one joint", 2: f"two {self.name}"}[self.most]
        return f"{self.least} to {self.most} {self.name}"

    def convert(
        self,
        value: str | tuple[str, ...],
        param: click.Parameter | None,
        ctx: click.Context | None,
    ) -> tuple[str, ...]:
        """The words that a text lists; raises `click.BadParameter`."""
        if isinstance(value, tuple):
            return value
        words = tuple(word.strip() for word in value.split(","))
        is_list = all(words) and len(words) == len(set(words))
        if not is_list or not self.least <= len(words) <= self.most:
            self.fail(
                f"{value!r} does not name {self.how_many}; write {self.numbered}, "
                "all different, with commas between them.",
                param,
                ctx,
            )
        return words


class AxisWords(JointWords):
    """What two axes of a diagram show, as a tuple."""

    name = "axes"
    numbered = "unknowns, |x| for the size of x, or |u| for the norm of all of them"

    def __init__(self) -> None:
        super().__init__(2, 2)


POSITIVE = NumberRange(min=0, min_open=True, allows_infinity=True)


def number_option(
    flag: str, kind: click.ParamType[Any], default: float, text: str
) -> Option:
    """The option ``flag`` for a number of a kind, which its help says with the
    ``default``."""
    return click.option(flag, type=kind, default=default, show_default=True, help=text)


def starts_option(text: str) -> Option:
    """The option ``--starts`` with the help ``text``."""
    return number_option("--starts", click.IntRange(1, MOST_STARTS), 200, text)


def seed_option(text: str) -> Option:
    """The option ``--seed`` with the help ``text``."""
    return number_option("--seed", click.IntRange(0, LARGEST_SEED), 0, text)


def record_options(
    name: str, record: type, options: Mapping[str, Option]
) -> Callable[[Command], Command]:
    """What gives a command ``options`` by the names of their values: it takes all of them
    as one ``record``, whose fields are so called, behind ``name``."""

    def with_options(command: Command) -> Command:
        @wraps(command)
        def taking_record(**values: object) -> None:
            own = {key: values.pop(key) for key in options}
            command(**{name: record(**own)}, **values)

        decorated: Command = taking_record
        for option in reversed(list(options.values())):
            decorated = option(decorated)
        return decorated

    return with_options


@dataclass(frozen=True)
class SearchOptions:
    """How a linkage is explored: what stands on the command line.

    ``starts`` is the number of random starts, ``seed`` that of their generator,
    ``tolerance`` that of the curves, ``budget`` the most seconds; ``certify``: whether
    forms get certificates; ``boxes``: into how many the bounds of equations are divided
    at most; ``paths``: along how many isolated solutions are followed at most;
    ``charts``: with how many surfaces are covered at most.
    """

    starts: int = 200
    seed: int = 0
    tolerance: float = 1e-13
    budget: float = math.inf
    certify: bool = True
    boxes: int = 20_000
    paths: int = 200
    charts: int = 1500

    def settings(self) -> SearchSettings:
        """The settings of the search; raises `bifurc.ProblemError`."""
        from bifurc.settings import SearchSettings, TraceSettings

        tracing = TraceSettings(tolerance=self.tolerance)
        return SearchSettings(
            starts=self.starts,
            budget=self.budget,
            certify=self.certify,
            boxes=self.boxes,
            paths=self.paths,
            charts=self.charts,
            tracing=tracing,
        )


SEARCH_OPTIONS: dict[str, Option] = {
    "starts": starts_option(
        "Random starts; of a mechanism up to 16 times as many where some of what "
        "it has is met by few."
    ),
    "seed": seed_option("Seed of the random starts."),
    "tolerance": number_option(
        "--tolerance",
        NumberRange(1e-14, 1e-7),
        1e-13,
        "How closely curves are followed.",
    ),
    "budget": click.option(
        "--budget",
        type=POSITIVE,
        default=math.inf,
        metavar="SECONDS",
        help="End the search after so long, with what was found.  [default: none]",
    ),
}
search_options = record_options("search", SearchOptions, SEARCH_OPTIONS)


@dataclass(frozen=True)
class HoldOptions:
    """Joints of a mechanism that are held, and how a table is read: what stands on the
    command line.

    ``locks`` are "J=40" each, ``driver`` is the joint that has to move all others.
    ``is_without_centre``: of a network only the loop that its outer bars leave.
    ``with_flaps``: what hangs on joints in no closed loop is free; ``with_flat_creases``:
    so are creases that stay flat about the flat state of a sheet. ``part`` is the number
    of one of several mechanisms of a file. ``free_creases``: those of a pattern fold
    either way, however they are assigned; its panels are ``triangulated``.
    ``closures`` is a file that closes the loops of a robot.
    ``is_modified``: in the rows of a table stand the links before the joints.
    """

    locks: tuple[str, ...] = ()
    driver: str | None = None
    is_without_centre: bool = False
    with_flaps: bool = False
    with_flat_creases: bool = False
    part: int | None = None
    free_creases: bool = False
    triangulated: bool = False
    closures: Path | None = None
    is_modified: bool = False

    @property
    def arguments(self) -> list[tuple[str, ...]]:
        """The options that are given, each with its value if it has one."""
        flags = {
            "--without-centre": self.is_without_centre,
            "--with-flaps": self.with_flaps,
            "--with-flat-creases": self.with_flat_creases,
            "--free-creases": self.free_creases,
            "--triangulated": self.triangulated,
            "--modified-dh": self.is_modified,
        }
        given: list[tuple[str, ...]] = [("--lock", lock) for lock in self.locks]
        if self.driver is not None:
            given.append(("--drive", self.driver))
        if self.closures is not None:
            given.append(("--closures", str(self.closures)))
        if self.part is not None:
            given.append(("--part", str(self.part)))
        return given + [(flag,) for flag, is_given in flags.items() if is_given]

    @property
    def names(self) -> str:
        """The options that are given, without their values."""
        return ", ".join(dict.fromkeys(name for name, *_ in self.arguments))


HOLD_OPTIONS: dict[str, Option] = {
    "locks": click.option(
        "--lock",
        "locks",
        multiple=True,
        metavar="JOINT=VALUE",
        help=(
            "Hold a joint of a mechanism at a value, an angle in degrees, whatever its "
            "file counts in, a slide in the file's unit of length, or an outer joint of "
            "a network at a D-H angle; may be given several times."
        ),
    ),
    "driver": click.option(
        "--drive",
        "driver",
        metavar="JOINT",
        help=(
            "Hold as many joints of a mechanism as it takes for this one to move all "
            "others; says which."
        ),
    ),
    "is_without_centre": click.option(
        "--without-centre",
        "is_without_centre",
        is_flag=True,
        help="Of a network with locks, take the single loop that its outer bars leave.",
    ),
    "with_flaps": click.option(
        "--with-flaps",
        "with_flaps",
        is_flag=True,
        help="Let what hangs on joints in no closed loop move: it is held else.",
    ),
    "with_flat_creases": click.option(
        "--with-flat-creases",
        "with_flat_creases",
        is_flag=True,
        help=(
            "Let creases of a flat sheet fold that stay flat about its flat state: they "
            "are held else."
        ),
    ),
    "part": click.option(
        "--part",
        "part",
        type=click.IntRange(min=1),
        metavar="NUMBER",
        help="Of a file with several mechanisms, take this one, from 1.",
    ),
    "free_creases": click.option(
        "--free-creases",
        "free_creases",
        is_flag=True,
        help="Let mountains and valleys of a crease pattern fold either way.",
    ),
    "triangulated": click.option(
        "--triangulated",
        "triangulated",
        is_flag=True,
        help="Let panels of a crease pattern bend along their shortest diagonals.",
    ),
    "closures": click.option(
        "--closures",
        "closures",
        type=FILE,
        metavar="FILE.yaml",
        help=(
            "The file that closes the loops of a robot in URDF.  [default: of the same "
            "name, or robot.yaml, beside it]"
        ),
    ),
    "is_modified": click.option(
        "--modified-dh",
        "is_modified",
        is_flag=True,
        help="Read a table in the modified convention of Denavit and Hartenberg.",
    ),
}
hold_options = record_options("hold", HoldOptions, HOLD_OPTIONS)


form_option = click.option(
    "--form",
    "forms",
    multiple=True,
    metavar="FORM",
    help="A form, by its name or its number in the summary.  [default: every form]",
)
trace_option = click.option(
    "--trace",
    "trace",
    multiple=True,
    metavar="BODY:X,Y[,Z]",
    help="The path of a point of a body, in the coordinates of the file; may be given "
    "several times.",
)
param_option = click.option(
    "--param",
    "parameters",
    multiple=True,
    metavar="KEY=VALUE",
    help="Parameter of a named linkage, angles in degrees; may be given several times.",
)


free_param_option = click.option(
    "--param",
    "parameters",
    multiple=True,
    metavar="KEY[=VALUE|=LOW:HIGH]",
    help="A parameter with its value, or a free one, within its usual range or from low "
    "to high; angles in degrees.",
)


def _say_more(ctx: click.Context, param: click.Parameter, value: bool) -> bool:
    if value:
        say_more()
    return value


verbose_option = click.option(
    "-v",
    "--verbose",
    is_flag=True,
    expose_value=False,
    callback=_say_more,
    help="Say more on standard error.",
)
whole_option = click.option(
    "-v",
    "--verbose",
    is_flag=True,
    callback=_say_more,
    help="Show all tables and claims, and say more on standard error.",
)


@dataclass(frozen=True)
class AtlasOptions:
    """What atlas a command works on, besides its name: ``parameters`` of a linkage, how
    joints are held, how it is searched; and whether it is shown whole, ``verbose``."""

    parameters: tuple[str, ...] = ()
    search: SearchOptions = SearchOptions()
    hold: HoldOptions = HoldOptions()
    verbose: bool = False


def atlas_options(command: Command) -> Command:
    """``command`` with the options of an atlas, which it takes as one `AtlasOptions`
    called ``choice``, and with ``--verbose``."""

    @wraps(command)
    def taking_options(
        parameters: tuple[str, ...],
        search: SearchOptions,
        hold: HoldOptions,
        verbose: bool,
        **values: object,
    ) -> None:
        command(choice=AtlasOptions(parameters, search, hold, verbose), **values)

    searched = search_options(whole_option(taking_options))
    return hold_options(param_option(searched))


no_certify_option = click.option(
    "--no-certify",
    is_flag=True,
    help="Do not certify that no form jumps from one arc to another.",
)


def json_option(angles: str = "") -> Option:
    """The option ``--json``; ``angles`` says what follows in its help."""
    text = f"Print one JSON document and nothing else{angles}."
    return click.option("--json", "as_json", is_flag=True, help=text)


def out_option(content: str) -> Option:
    """The option ``--out``, a folder for ``content``."""
    return click.option("--out", type=FOLDER, help=f"Folder for {content}.")


@dataclass(frozen=True)
class ProofOptions:
    """Whether a map is proved, and the file of its ``certificate``, if any: what stands
    on the command line."""

    rigorous: bool
    certificate: Path | None

    @property
    def names(self) -> list[str]:
        """The options that are given."""
        given = {
            "--rigorous": self.rigorous,
            "--certificate": self.certificate is not None,
        }
        return [name for name, is_given in given.items() if is_given]


PROOF_OPTIONS: dict[str, Option] = {
    "rigorous": click.option(
        "--rigorous",
        is_flag=True,
        help=(
            "Prove in ball arithmetic that no form jumps, that it is there, and what "
            "leaves its singular points (docs/proof.md)."
        ),
    ),
    "certificate": click.option(
        "--certificate",
        type=FILE,
        metavar="FILE.json.gz",
        help="Prove it, and write what `bifurc check` needs to prove it again.",
    ),
}
proof_options = record_options("proof", ProofOptions, PROOF_OPTIONS)


POSITIVE_LENGTH = NumberRange(min=0, min_open=True)
UNITS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4}  # mm


@dataclass(frozen=True)
class PrintOptions:
    """How parts are printed: what stands on the command line, mm; None for what does
    not stand there and has no default."""

    diameter: float = 6.0
    play: float = 0.3
    wall: float = 1.2
    size: float | None = None
    unit: str | None = None
    offsets: str | None = None

    @property
    def unit_in_mm(self) -> float | None:
        """The unit of the linkage, where one is given."""
        return None if self.unit is None else UNITS[self.unit]


def _size_option(flag: str, meaning: str, default: float | None = None) -> Option:
    """An option of printed parts for a length, mm."""
    text = f"For .stl and .step: {meaning}"
    return click.option(
        flag, type=POSITIVE_LENGTH, default=default, metavar="MM", help=text
    )


PRINT_OPTIONS: dict[str, Option] = {
    "diameter": _size_option("--diameter", "diameter of the rods.  [default: 6]", 6.0),
    "play": _size_option(
        "--play",
        "gap between surfaces that turn on each other, and the least one between parts "
        "on the way.  [default: 0.3]",
        0.3,
    ),
    "wall": _size_option("--wall", "least thickness of a wall.  [default: 1.2]", 1.2),
    "size": _size_option(
        "--size", "the linkage's mean length of a link.  [default: 100]"
    ),
    "unit": click.option(
        "--unit",
        type=click.Choice(list(UNITS)),
        help="For .stl and .step: the unit of the linkage's lengths, instead of --size.",
    ),
    "offsets": click.option(
        "--offsets",
        metavar="MM,MM,...",
        help=(
            "For .stl and .step: where each hinge sits along its axis, from the foot "
            "of the common normal before it.  [default: so that no parts meet]"
        ),
    ),
}
print_options = record_options("printing", PrintOptions, PRINT_OPTIONS)


class Words(click.ParamType[tuple[str, ...]]):
    """Some of the words of a list, separated by commas, as a tuple."""

    name = "words"

    def __init__(self, allowed: Sequence[str]):
        self.allowed = tuple(allowed)

    def convert(
        self,
        value: str | tuple[str, ...],
        param: click.Parameter | None,
        ctx: click.Context | None,
    ) -> tuple[str, ...]:
        """The words that a text lists, each once; raises `click.BadParameter`."""
        if isinstance(value, tuple):
            return value
        words = tuple(dict.fromkeys(word.strip() for word in value.split(",")))
        if not set(words) <= set(self.allowed):
            allowed = ", ".join(self.allowed)
            self.fail(f"{value!r} must be some of {allowed}.", param, ctx)
        return words


class Pair(click.ParamType[tuple[float, float]]):
    """Two finite numbers with a mark between them."""

    name = "pair"

    def __init__(self, mark: str, example: str):
        self.mark = mark
        self.example = example

    def convert(
        self,
        value: str | tuple[float, float],
        param: click.Parameter | None,
        ctx: click.Context | None,
    ) -> tuple[float, float]:
        """The two numbers of a text; raises `click.BadParameter`."""
        if isinstance(value, tuple):
            return value
        try:
            first, second = map(float, value.split(self.mark))
        except ValueError:
            self.fail(f"{value!r} is not like {self.example}.", param, ctx)
        if not (math.isfinite(first) and math.isfinite(second)):
            self.fail(f"{value!r} is not like {self.example}.", param, ctx)
        return first, second


FIGURE_FORMATS = ("png", "svg", "pdf")
SMALLEST_FIGURE, LARGEST_FIGURE = 1.5, 100.0  # inches


@dataclass(frozen=True)
class FigureOptions:
    """How figures look that are written to files: what stands on the command line.

    ``formats`` of files, ``size`` in inches, None for the usual one; ``forms`` that are
    drawn, all where there are none.
    """

    formats: tuple[str, ...] = ("png", "svg")
    size: tuple[float, float] | None = None
    forms: tuple[str, ...] = ()


def check_size(
    ctx: click.Context, param: click.Parameter, size: tuple[float, float] | None
) -> tuple[float, float] | None:
    """The size of a figure, inches; raises `click.BadParameter`."""
    if size is not None and not all(
        SMALLEST_FIGURE <= side <= LARGEST_FIGURE for side in size
    ):
        raise click.BadParameter(
            f"{size[0]:g}x{size[1]:g}: both must be between {SMALLEST_FIGURE:g} and "
            f"{LARGEST_FIGURE:g} inches."
        )
    return size


FIGURE_OPTIONS: dict[str, Option] = {
    "formats": click.option(
        "--format",
        "formats",
        type=Words(FIGURE_FORMATS),
        default="png,svg",
        show_default=True,
        metavar="FORMAT,...",
        help=f"Formats of the figures: {', '.join(FIGURE_FORMATS)}.",
    ),
    "size": click.option(
        "--size",
        type=Pair("x", "3.4x2.6"),
        callback=check_size,
        metavar="WxH",
        help=(
            "Width and height of the figures, inches; they are higher where panels "
            "would be flat.  [default: as large as they need]"
        ),
    ),
    "forms": click.option(
        "--form",
        "forms",
        multiple=True,
        metavar="FORM",
        help=(
            "Draw this form, by its name or its number in the summary; may be given "
            "several times.  [default: every form]"
        ),
    ),
}


figure_options = record_options("figures", FigureOptions, FIGURE_OPTIONS)
