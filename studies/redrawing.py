"""What the studies share: draw a published transition map anew and check what the
source says of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import click
import numpy as np

from bifurc import Atlas, plot_transition_map
from bifurc.files.atomic import replace_files
from linkages.app.files import write_data, write_figures
from linkages.app.options import FOLDER
from linkages.app.texts.summary import make_summary
from studies.study import Study

HOLDS = 1e-9  # rad


@dataclass(frozen=True)
class Claim:
    """A sentence of the source, and by how much the computed map deviates from it (rad,
    or a count)."""

    sentence: str
    deviation: float


@dataclass(frozen=True)
class Redrawing:
    """A published figure: its name for the files, its axes (joints from 1; None where
    the source does not name them), how to compute the map, and what the source says of
    it."""

    figure: str
    joints: tuple[int, int] | None
    compute: Callable[[], Atlas]
    claims: Callable[[Atlas], Sequence[Claim]]

    def command(self) -> click.Command:
        """The study as a command with the option ``--out``."""

        @click.command(
            cls=Study,
            help=f"Draw {self.figure} anew, with all tables and files of `bifurc map`.",
        )
        @click.option(
            "--out",
            type=FOLDER,
            default=Path("out") / self.figure,
        )
        def study(out: Path) -> None:
            self.run(out)

        return study

    def run(self, out: Path) -> None:
        """Print the tables and the claims; write the figure and the results of the map
        to a folder."""
        out.mkdir(parents=True, exist_ok=True)
        atlas = self.compute()
        sentences = "\n".join(judge(claim) for claim in self.claims(atlas))
        summary = f"{make_summary(atlas)}\n\nWhat the source says\n{sentences}"
        click.echo(summary)
        paths = write_data(atlas, out, summary)
        paths += write_figures(atlas, out)
        figure = plot_transition_map(atlas, joints=self.joints)

        def write(stage: Path) -> None:
            for ending in ("png", "svg"):
                figure.savefig(stage / f"{self.figure}.{ending}", dpi=150)

        paths += replace_files(out, write)
        others = len(paths) - 1
        click.echo(
            f"wrote {self.figure}.png and {others} more files to {out}", err=True
        )


def angles_along(atlas: Atlas, form: str, *joints: int) -> tuple[np.ndarray, ...]:
    """Angles (500,), rad, of the given joints (from 1) along a form."""
    samples = atlas.forms[atlas.form(form)].branch.sample(500)
    return tuple(samples[:, joint - 1] for joint in joints)


def largest(deviations: np.ndarray) -> float:
    """The largest absolute value."""
    return float(np.abs(deviations).max())


def judge(claim: Claim) -> str:
    """A line that says whether a claim holds, and how well."""
    if claim.deviation == 0:
        verdict = "holds"
    elif claim.deviation < HOLDS:
        verdict = f"holds to {claim.deviation:.0e}"
    else:
        verdict = f"is off by {claim.deviation:.2g}"
    return f"  {verdict:<16}  {claim.sentence}"
