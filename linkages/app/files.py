"""Writing the results of `bifurc map --out DIR`, each file whole or not at all; and what
figures are drawn over: unknowns by the names of their joints, or by their numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

from bifurc.atlas import Atlas
from bifurc.files.atomic import replace_files
from linkages.app.exit_codes import CommandError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bifurc.files.table import Variable
    from linkages.entry import Linkage
    from linkages.mechanisms.mechanism import Mechanism


@dataclass(frozen=True)
class FigureAxes:
    """What figures are drawn over: two or three unknowns for the transition map, one
    for the singular values, each numbered from 1; the usual ones where nothing is
    said."""

    transition_map: tuple[int, ...] = ()
    singular_values: int | None = None


def figure_axes(
    linkage: Linkage | Mechanism,
    axes: Sequence[str] | None,
    against: Sequence[str] | None,
) -> FigureAxes:
    """What the figures of a linkage are drawn over, for the names or numbers of its
    joints; raises `CommandError` for one that it does not have, or that is named
    twice."""
    if axes is None and against is None:
        return FigureAxes()
    from linkages.subject import as_subject  # equations have no need of it

    names = as_subject(linkage).unknowns
    numbers = read_numbers("--against", against or (), names)
    return FigureAxes(
        read_numbers("--axes", axes or (), names), numbers[0] if numbers else None
    )


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


def write_figures(
    atlas: Atlas, folder: Path, over: FigureAxes = USUAL_AXES
) -> list[Path]:
    """The paths of the figures, just written to ``folder``, all or none; raises
    `OSError`."""
    from bifurc.figures import plotting

    others = _figures_over(over)
    return replace_files(
        folder, lambda stage: plotting.save_figures(atlas, stage, others)
    )


def _figures_over(over: FigureAxes) -> dict[str, Callable[[Atlas], Figure]]:
    """The figures that are drawn over other unknowns than usual."""
    others: dict[str, Callable[[Atlas], Figure]] = {}
    if len(over.transition_map) == 2:
        from bifurc.figures.plotting import plot_transition_map

        others["transition_map"] = partial(
            plot_transition_map, joints=over.transition_map
        )
    if len(over.transition_map) == 3:
        from bifurc.figures.space import plot_map_in_space

        others["transition_map"] = partial(
            plot_map_in_space, unknowns=over.transition_map
        )
    if over.singular_values is not None:
        from bifurc.figures.singular_values import plot_singular_values_against

        others["singular_values"] = partial(
            plot_singular_values_against, unknown=over.singular_values
        )
    return others
