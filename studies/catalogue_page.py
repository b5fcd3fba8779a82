"""The catalogue as a page of the docs, and a drawing of every linkage.

    python -m studies.catalogue_page                            # docs/catalogue.md
    python -m studies.catalogue_page --out out/catalogue        # and the drawings

The counts of the maps take some minutes; with ``--keep-counts`` those of the page as it
stands are kept.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import click
import numpy as np

from bifurc.atlas import Atlas
from linkages.app.scene_figure import draw_configuration
from linkages.app.texts import count_of
from linkages.catalogue import catalogue, families
from linkages.entry import Entry, Parameter, ParameterKind
from linkages.linkage import load
from linkages.mapping import map_linkage
from linkages.relations import RelationKind, relations_of
from linkages.scene import Scene, breadth, clearance, make_scene

__all__ = ["PAGE", "count_map", "make_page", "read_counts"]

PAGE = Path(__file__).parents[1] / "docs" / "catalogue.md"
NOT_COUNTED = "not mapped"
HEAD = """# Catalogue

Every named linkage, as `bifurc list` shows it. This page is made from the entries themselves by
`python -m studies.catalogue_page`, which also draws each linkage in a configuration with `--out DIR`.

Joint i turns about the z axis of its frame by theta_i; a_{i,i+1} and alpha_{i,i+1} are length and twist of the link
that follows it, R_i its offset. Angles of the defaults are in degrees. "Map" counts what `bifurc map NAME` finds at
the default parameters. Which linkages a table is a case of, `bifurc identify` tells; the cases named below hold up to
the choice of the first joint, direction, sense of axes and links, mirror image and scale.
"""


def make_page(counts: Mapping[str, str]) -> str:
    """The page in Markdown; ``counts`` are the sentences of `count_map` by the name of
    the linkage."""
    rows = []
    sections = []
    for entry in catalogue().values():
        joints = entry.build().n
        rows.append(f"| [{entry.name}](#{entry.name}) | {joints} | {entry.title} |")
        sections.append(_section(entry, counts.get(entry.name, NOT_COUNTED)))
    table = "\n".join(["| name | joints | title |", "|---|---|---|", *rows])
    size = f"{len(families())} families, {len(rows)} linkages."
    return "\n".join([HEAD, f"{size}\n\n{table}\n", *sections])


def read_counts(page: str) -> dict[str, str]:
    """The sentences on the maps that a page holds, by the name of the linkage."""
    pattern = r"^## (\S+)$.*?^Map: (.*?)\.$"
    return dict(re.findall(pattern, page, re.MULTILINE | re.DOTALL))


def count_map(atlas: Atlas) -> str:
    """How many forms, bifurcations and components an atlas has, and surfaces and rigid
    assemblies if any."""
    always = [
        count_of(len(atlas.forms), "form"),
        count_of(len(atlas.bifurcations), "bifurcation"),
        count_of(atlas.components, "component"),
    ]
    others = {
        "rank drop": len(atlas.rank_drops),
        "surface": len(atlas.surfaces),
        "rigid assembly": len(atlas.rigid),
    }
    present = [count_of(number, noun) for noun, number in others.items() if number]
    return ", ".join(always + present)


def _section(entry: Entry, count: str) -> str:
    parameters = ", ".join(_parameter(parameter) for parameter in entry.parameters)
    parts = [
        f"## {entry.name}\n\n{entry.title}. Source: {entry.source}.",
        f"Parameters: {parameters}.",
        _list("Conditions", [condition.text for condition in entry.conditions]),
        _list("Relations", _relations(entry.name)),
        _list("Closed forms", _closed_forms(entry)),
        _list("Misprints in the source", entry.errata),
        f"Map: {count}.",
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def _parameter(parameter: Parameter) -> str:
    default = f"{parameter.default:.6g}"
    if parameter.kind is ParameterKind.ANGLE:
        default = f"{math.degrees(parameter.default):.6g} deg"
    return f"`{parameter.name}` = {default} ({parameter.meaning})"


def _relations(name: str) -> list[str]:
    lines = []
    for relation in relations_of(name):
        other = relation.other
        words = relation.kind.value
        if relation.kind is RelationKind.SAME:
            words = "the same linkage as"
        detail = f", {relation.detail}" if relation.detail else ""
        lines.append(f"{words} [{other}](#{other}){detail} ({relation.source})")
    return lines


def _closed_forms(entry: Entry) -> list[str]:
    """Name, source and LaTeX of every closed form of a linkage, u_x being tan(x/2) and
    t_i tan(theta_i/2)."""
    lines = []
    for form in entry.closed_forms:
        equations = form.latex().items()
        shown = [f"  - ${left} = {right}$" for left, right in equations]
        lines.append("\n".join([f"{form.form} ({form.source}):", *shown]))
    return lines


def _list(title: str, lines: Sequence[str]) -> str:
    if not lines:
        return ""
    items = "\n".join(f"- {line}" for line in lines)
    return f"{title}:\n\n{items}"


def clearest_configuration(atlas: Atlas, entry: Entry) -> np.ndarray | None:
    """Of a hundred configurations of each form, that whose joints lie furthest from
    joints and links; None without."""
    loop = entry.build()

    def room(theta: np.ndarray) -> float:
        return _room(make_scene(loop, theta))

    samples = [theta for form in atlas.forms for theta in form.branch.sample(100)]
    return max(samples, key=room, default=None)


def _room(scene: Scene) -> float:
    """How much joints and links keep clear of each other."""
    between_joints, to_links = clearance(scene.joints, scene.normals)
    return between_joints + 2 * to_links + breadth(scene.joints)


def _draw(atlas: Atlas, entry: Entry, out: Path) -> None:
    """Write the drawing of a linkage, if it has a form to draw it in."""
    theta = clearest_configuration(atlas, entry)
    if theta is None:
        return
    out.mkdir(parents=True, exist_ok=True)
    figure = draw_configuration(entry.build(), theta, entry.title)
    figure.savefig(out / f"{entry.name}.png", dpi=100)


@click.command()
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    help="Folder for the drawings.",
)
@click.option(
    "--keep-counts", is_flag=True, help="Keep the counts of the page as it stands."
)
def main(out: Path | None, keep_counts: bool) -> None:
    """Write docs/catalogue.md, and a drawing of each linkage with --out."""
    counts: dict[str, str] = {}
    if keep_counts and PAGE.exists():
        counts = read_counts(PAGE.read_text(encoding="utf-8"))
    for entry in catalogue().values():
        if entry.name in counts and out is None:
            continue
        atlas = map_linkage(load(entry.name))
        counts[entry.name] = count_map(atlas)
        click.echo(f"{entry.name}: {counts[entry.name]}")
        if out is not None:
            _draw(atlas, entry, out)
    PAGE.write_text(make_page(counts), encoding="utf-8")
    click.echo(f"wrote {PAGE.relative_to(PAGE.parents[1])}")


if __name__ == "__main__":
    main()
