"""Wohlhart's symmetric mechanism as a translator: sections 3 and 4 of Racila and Dahan
2010, with their figures 3 to 12.

O1, O3, O5 and O2, O4, O6 stay in two parallel planes; the axes meet in O'' and O', and
the line O'O'' is perpendicular to both planes. Where O1, O3, O5 slide by b on three
lines, the other plane rises to the height H. The input-output equation is a square:
cos(theta/2) cos(phi/2) - cos(alpha) sin(theta/2) sin(phi/2) is 1/2 or -1/2, so that
both strokes have a closed form and H = 2 a |sin(theta/2) sin(phi/2) sin(alpha)| /
sqrt(3). Draws both strokes, since the paper does not say which.
"""

from __future__ import annotations

from pathlib import Path

import click
import numpy as np

from bifurc.figures.plotting import save_figure
from linkages.app.options import FOLDER
from linkages.closed_forms.translator import (
    Stroke,
    contact_angle,
    joint_centres,
    meeting_points,
    plane_distance,
    slide,
    stroke_angles,
)
from linkages.families.wohlhart import wohlhart_symmetric
from linkages.source_figures.draw import draw_source_figure
from linkages.source_figures.table import figure_named
from studies.redrawing import Claim, judge
from studies.study import Study

TWISTS = (75, 90, 105, 120, 150)
FIGURES = range(3, 13)
COUNT = 361
AWAY = 1e-3  # from where planes or axes are not defined: sine of theta and of phi


def stroke_table() -> str:
    """Where every stroke begins and ends, how high it lifts, and where thin links
    touch."""
    rows = [
        "  twist  stroke  theta, phi from   to            H max / a  contact at theta"
    ]
    for twist in TWISTS:
        alpha = float(np.radians(twist))
        for stroke in Stroke:
            theta, phi = stroke_angles(alpha, stroke, 2001)
            degrees = np.round(np.degrees([theta, phi]), 6) + 0.0
            highest = plane_distance(theta, phi, alpha).max()
            touch = contact_angle(alpha) if stroke is Stroke.LONG else None
            contact = "none" if touch is None else f"{np.degrees(touch):.6f}"
            start = f"{degrees[0, 0]:.0f}, {degrees[1, 0]:.0f}"
            end = f"{degrees[0, -1]:.0f}, {degrees[1, -1]:.0f}"
            rows.append(
                f"  {twist:5}  {stroke:6}  {start:15}   {end:12}  {highest:9.6f}  "
                f"{contact}"
            )
    return "\n".join(rows)


def claims() -> list[Claim]:
    """What sections 3 and 4 say, with (29) corrected, by how much it fails over both
    strokes of all twists."""
    worst = np.zeros(7)
    for twist in TWISTS:
        for stroke in Stroke:
            worst = np.maximum(worst, _deviations(float(np.radians(twist)), stroke))
    sentences = (
        "(15): the loop closes",
        "the planes O1 O3 O5 and O2 O4 O6 are parallel",
        "O1 O3 O5 is equilateral with the side 2 a cos(theta/2)",
        "the line O'O'' is perpendicular to both planes",
        "(28): the slide b",
        "(29), corrected: the distance H",
        "the root in (29) is sqrt(3)/2",
    )
    return [Claim(text, float(gap)) for text, gap in zip(sentences, worst, strict=True)]


def _deviations(alpha: float, stroke: Stroke) -> np.ndarray:
    """By how much each claim (7,) fails along one stroke."""
    theta, phi = stroke_angles(alpha, stroke, COUNT)
    is_plain = np.abs(np.sin(theta) * np.sin(phi)) > AWAY
    theta = theta[is_plain]
    phi = phi[is_plain]
    angles = np.stack([theta, phi] * 3, axis=-1)
    closure = wohlhart_symmetric(1.0, alpha).closure_error(angles)
    mixed = np.sin(theta / 2) * np.cos(phi / 2)
    mixed += np.cos(theta / 2) * np.sin(phi / 2) * np.cos(alpha)
    root = np.hypot(np.sin(phi / 2) * np.sin(alpha), mixed)
    gaps = (closure, *_gaps_of_planes(theta, phi, alpha), root - np.sqrt(3) / 2)
    return np.array([np.abs(gap).max() for gap in gaps])


def _gaps_of_planes(
    theta: np.ndarray, phi: np.ndarray, alpha: float
) -> tuple[np.ndarray, ...]:
    """By how much what is said of the planes, of O'O'', b and H fails, (k,) each."""
    centres = joint_centres(theta, phi, alpha)
    odd = centres[:, 0::2]
    even = centres[:, 1::2]
    odd_normal = _normal(odd)
    side = np.linalg.norm(odd[:, 1] - odd[:, 0], axis=1)
    ends = meeting_points(theta, phi, alpha)
    line = ends[0] - ends[1]
    line = line / np.linalg.norm(line, axis=1, keepdims=True)
    radius = np.linalg.norm(odd[:, 0] - odd.mean(axis=1), axis=1)
    height = np.abs(np.sum((even[:, 0] - odd[:, 0]) * odd_normal, axis=1))
    return (
        np.linalg.norm(np.cross(odd_normal, _normal(even)), axis=1),
        side - 2 * np.abs(np.cos(theta / 2)),
        np.linalg.norm(np.cross(odd_normal, line), axis=1),
        np.abs(2 / np.sqrt(3) - slide(theta)) - radius,
        plane_distance(theta, phi, alpha) - height,
    )


def _normal(triangle: np.ndarray) -> np.ndarray:
    """Unit normals (k, 3) of triangles (k, 3, 3)."""
    normal = np.cross(triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0])
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))


@click.command(
    cls=Study, help="Draw figures 3 to 12 of Racila and Dahan 2010 anew, with a table."
)
@click.option(
    "--out",
    type=FOLDER,
    default=Path("out") / "translator",
)
def main(out: Path) -> None:
    """Print the strokes and what the source says, and write the figures."""
    table = stroke_table()
    click.echo(table)
    click.echo("\nWhat the source says")
    for claim in claims():
        click.echo(judge(claim))
    out.mkdir(parents=True, exist_ok=True)
    (out / "strokes.txt").write_text(table + "\n", encoding="utf-8")
    for number in FIGURES:
        figure = draw_source_figure(figure_named(f"004-{number}"))
        save_figure(figure, out / f"figure_{number}")


if __name__ == "__main__":
    main()
