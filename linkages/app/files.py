"""Writing the results of `bifurc map --out DIR`, each file whole or not at all; and what
figures are drawn over: unknowns by the names of their joints, or by their numbers."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from bifurc.atlas import Atlas
from bifurc.files.atomic import replace_files
from linkages.app.exit_codes import CommandError
from linkages.app.options import FigureOptions
from linkages.app.texts.form_names import choose_forms

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bifurc.figures.selection import Selection
    from bifurc.files.table import Variable
    from linkages.entry import Linkage
    from linkages.mechanisms.mechanism import Mechanism


@dataclass(frozen=True)
class FigureAxes:
    """What figures are drawn over: two or three unknowns for the transition map, one
    for the singular values, each numbered from 1, two quantities for the diagram, each as
    `bifurc.plot_diagram` takes it; the usual ones where nothing is said.

    ``window`` are the first and the last angle, degrees, ``overlay`` points of the
    user's, as in `bifurc.figures.selection.Selection`, ``trace`` points of bodies whose
    paths are drawn with the linkage.
    """

    transition_map: tuple[int, ...] = ()
    singular_values: int | None = None
    window: tuple[float, float] | None = None
    overlay: Mapping[str, Sequence[float]] = field(default_factory=dict)
    diagram: tuple[str, ...] = ()
    trace: tuple[str, ...] = ()


def figure_axes(
    linkage: Linkage | Mechanism,
    axes: Sequence[str] | None,
    against: Sequence[str] | None,
    window: tuple[float, float] | None,
    overlay: Path | None,
    trace: tuple[str, ...] = (),
) -> FigureAxes:
    """What the figures of a linkage are drawn over, for the names or numbers of its
    joints; raises `CommandError` for one that it does not have, or that is named
    twice, and for a file that holds no points, and `GeometryError` for a point of a
    ``trace`` that is of no body."""
    if window is not None and not 0 < window[1] - window[0] <= 360:
        raise CommandError(
            f"--range {window[0]:g}:{window[1]:g}: it must be a first and a larger last "
            "angle, degrees, at most a turn"
        )
    require_points(linkage, trace)
    if axes is None and against is None and overlay is None:
        return FigureAxes(window=window, trace=trace)
    from linkages.subject import as_subject  # equations have no need of it

    names = as_subject(linkage).unknowns
    numbers = read_numbers("--against", against or (), names)
    return FigureAxes(
        read_numbers("--axes", axes or (), names),
        numbers[0] if numbers else None,
        window,
        read_points(overlay, names) if overlay else {},
        trace=trace,
    )


def require_points(linkage: Linkage | Mechanism, trace: Sequence[str]) -> None:
    """Raise `GeometryError` for a point of a ``trace`` that no body has."""
    if not trace:
        return
    from linkages.links.traced_points import traced_point
    from linkages.subject import as_subject

    parts = as_subject(linkage).parts_for(trace)
    for text in trace:
        traced_point(parts, text)


def read_points(path: Path, names: Sequence[str]) -> dict[str, list[float]]:
    """Points in a CSV file: the values of some unknowns, one column each, with their
    names in the first line; raises `CommandError`."""
    option = f"--overlay {path}"
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except OSError as error:
        raise CommandError(f"{option}: it cannot be read ({error.strerror})") from None
    except UnicodeDecodeError:
        raise CommandError(f"{option}: it is no text in UTF-8") from None
    rows = [row for row in csv.reader(lines) if row]
    heads = [head.strip() for head in rows[0]] if rows else []
    if len(heads) < 2 or len(set(heads)) < len(heads) or not set(heads) <= set(names):
        raise CommandError(
            f"{option}: its first line must name two or more of {', '.join(names)}, "
            "with commas between them"
        )
    columns: dict[str, list[float]] = {head: [] for head in heads}
    for number, row in enumerate(rows[1:], 2):
        try:
            values = [float(cell) for cell in row]
        except ValueError:
            values = []
        if len(values) != len(heads) or not all(map(math.isfinite, values)):
            raise CommandError(f"{option}: row {number} is not {len(heads)} numbers")
        for head, value in zip(heads, values, strict=True):
            columns[head].append(value)
    return columns


def read_numbers(
    option: str, words: Sequence[str], names: Sequence[str]
) -> tuple[int, ...]:
    """The numbers, from 1, of the unknowns that ``words`` name, or else number."""
    numbers: list[int] = []
    for word in words:
        number = number_of(word, names)
        if number is None:
            raise CommandError(
                f"{option}: there is no joint {word} to draw over; the names are "
                f"{', '.join(names)}, the numbers 1 to {len(names)}"
            )
        if number in numbers:
            raise CommandError(f"{option} {word}: {names[number - 1]} is named twice")
        numbers.append(number)
    return tuple(numbers)


def number_of(word: str, names: Sequence[str]) -> int | None:
    """The number, from 1, of the unknown that has this name or else this number; None
    where there is none. Joints may be called by numbers of their own."""
    if word in names:
        return names.index(word) + 1
    if word.isdecimal() and 1 <= int(word) <= len(names):
        return int(word)
    return None


def write_data(
    atlas: Atlas,
    folder: Path,
    summary: str,
    more: Mapping[str, Variable] = MappingProxyType({}),
    others: Mapping[str, Callable[[Path], object]] = MappingProxyType({}),
) -> list[Path]:
    """The paths of atlas.nc, with ``more`` variables, graph.graphml, summary.txt and
    ``others``, by what writes them, just written to ``folder``, all or none; raises
    `OSError`."""
    from bifurc.files.dataset import save_atlas
    from bifurc.files.graphml import write_graphml

    def write(stage: Path) -> None:
        save_atlas(atlas, stage / "atlas.nc", more)
        write_graphml(atlas, stage / "graph.graphml")
        for name, write_other in others.items():
            write_other(stage / name)
        (stage / "summary.txt").write_text(summary + "\n", encoding="utf-8")

    return replace_files(folder, write)


USUAL_AXES = FigureAxes()
USUAL_LOOK = FigureOptions()


def write_figures(
    atlas: Atlas,
    folder: Path,
    over: FigureAxes = USUAL_AXES,
    options: FigureOptions = USUAL_LOOK,
) -> list[Path]:
    """The paths of the figures, just written to ``folder``, all or none; raises
    `OSError`, and `CommandError` for a form that is not there."""
    from matplotlib import rc_context

    from bifurc.figures import plotting
    from bifurc.figures.rc import SIZE
    from bifurc.figures.selection import Selection

    forms = [form.name for form in choose_forms(atlas, options.forms)]
    selection = Selection(forms if options.forms else (), over.window, over.overlay)
    others = _figures_over(over, selection)
    if atlas.subject.get("kind") != "system":
        from linkages.pictures.plot_linkage import plot_linkage

        form = selection.forms[0] if selection.forms else None
        others["linkage"] = partial(plot_linkage, form=form, trace=over.trace)
    size: dict[Any, Any] = {SIZE: options.size} if options.size else {}
    with rc_context(size):
        return replace_files(
            folder,
            lambda stage: plotting.save_figures(
                atlas, stage, others, options.formats, selection
            ),
        )


def _figures_over(
    over: FigureAxes, selection: Selection
) -> dict[str, Callable[[Atlas], Figure]]:
    """The figures that are drawn over other unknowns than usual."""
    others: dict[str, Callable[[Atlas], Figure]] = {}
    if len(over.transition_map) == 2:
        from bifurc.figures.plotting import plot_transition_map

        others["transition_map"] = partial(
            plot_transition_map, joints=over.transition_map, selection=selection
        )
    if len(over.transition_map) == 3:
        from bifurc.figures.space import plot_map_in_space

        others["transition_map"] = partial(
            plot_map_in_space, unknowns=over.transition_map, selection=selection
        )
    if over.singular_values is not None:
        from bifurc.figures.singular_values import plot_singular_values_against

        others["singular_values"] = partial(
            plot_singular_values_against,
            unknown=over.singular_values,
            selection=selection,
        )
    if over.diagram:
        from bifurc.figures.diagram_plot import plot_diagram

        horizontal, vertical = over.diagram
        others["diagram"] = partial(
            plot_diagram, horizontal=horizontal, vertical=vertical
        )
    return others
