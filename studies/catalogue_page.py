"""The catalogue as a page of the docs, and a drawing of every linkage.

    python -m studies.catalogue_page                            # docs/catalogue.md
    python -m studies.catalogue_page --out out/catalogue        # and the drawings

The counts of the maps take some minutes; with ``--keep-counts`` those of the page as it
stands are kept.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from pathlib import Path

import click
import numpy as np

from bifurc.atlas import Atlas
from linkages.catalogue import catalogue, families
from linkages.entry import Entry, Parameter
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
    rows = [
        f"| [{e.name}](#{e.name}) | {e.build().n} | {e.title} |"
        for e in catalogue().values()
    ]
    table = "\n".join(["| name | joints | title |", "|---|---|---|", *rows])
    parts = [HEAD, f"{len(families())} families, {len(rows)} linkages.\n\n{table}\n"]
    parts += [
        _section(found, counts.get(found.name, NOT_COUNTED))
        for found in catalogue().values()
    ]
    return "\n".join(parts)


def read_counts(page: str) -> dict[str, str]:
    """The sentences on the maps that a page holds, by the name of the linkage."""
    return dict(
        re.findall(r"^## (\S+)$.*?^Map: (.*?)\.$", page, re.MULTILINE | re.DOTALL)
    )


def count_map(atlas: Atlas) -> str:
    """How many forms, bifurcations and components an atlas has, and surfaces and rigid
    assemblies if any."""
    counted = [
        (len(atlas.forms), "form"),
        (len(atlas.bifurcations), "bifurcation"),
        (atlas.components, "component"),
        (len(atlas.rank_drops), "rank drop"),
        (len(atlas.surfaces), "surface"),
        (len(atlas.rigid), "rigid assembly"),
    ]
    words = [
        _plural(number, what)
        for i, (number, what) in enumerate(counted)
        if number or i < 3
    ]
    return ", ".join(words)


def _plural(number: int, what: str) -> str:
    many = what[:-1] + "ies" if what.endswith("y") else what + "s"
    return f"{number} {what if number == 1 else many}"


def _section(found: Entry, count: str) -> str:
    closed = _closed_forms(found)
    parts = [
        f"## {found.name}\n\n{found.title}. Source: {found.source}.",
        "Parameters: " + ", ".join(_parameter(p) for p in found.parameters) + ".",
        _listed("Conditions", [str(condition) for condition in found.conditions]),
        _listed("Relations", _relations(found.name)),
        _listed("Closed forms", closed),
        _listed("Misprints in the source", found.errata),
        f"Map: {count}.",
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def _parameter(p: Parameter) -> str:
    default = (
        f"{math.degrees(p.default):.6g} deg"
        if p.kind == "angle"
        else f"{p.default:.6g}"
    )
    return f"`{p.name}` = {default} ({p.meaning})"


def _relations(name: str) -> list[str]:
    lines = []
    for r in relations_of(name):
        words = (
            r.kind.value if r.kind is not RelationKind.SAME else "the same linkage as"
        )
        lines.append(
            f"{words} [{r.other}](#{r.other}){f', {r.detail}' if r.detail else ''} ({r.source})"
        )
    return lines


def _closed_forms(found: Entry) -> list[str]:
    """Name, source and LaTeX of every closed form of a linkage, u_x being tan(x/2) and
    t_i tan(theta_i/2)."""
    lines = []
    for form in found.closed_forms:
        shown = [f"  - ${left} = {right}$" for left, right in form.latex().items()]
        lines.append("\n".join([f"{form.form} ({form.source}):", *shown]))
    return lines


def _listed(title: str, lines: tuple[str, ...] | list[str]) -> str:
    return f"{title}:\n\n" + "\n".join(f"- {line}" for line in lines) if lines else ""


def clearest_configuration(atlas: Atlas, found: Entry) -> np.ndarray | None:
    """Of a hundred configurations of each form, that whose joints lie furthest from
    joints and links; None without."""
    loop = found.build()
    samples = [theta for form in atlas.forms for theta in form.branch.sample(100)]
    return (
        max(samples, key=lambda theta: _room(make_scene(loop, theta)))
        if samples
        else None
    )


def _room(scene: Scene) -> float:
    apart, away = clearance(scene.joints, scene.normals)
    return apart + 2 * away + breadth(scene.joints)


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
    counts = (
        read_counts(PAGE.read_text(encoding="utf-8"))
        if keep_counts and PAGE.exists()
        else {}
    )
    for found in catalogue().values():
        if found.name in counts and out is None:
            continue

        atlas = map_linkage(load(found.name))
        counts[found.name] = count_map(atlas)
        click.echo(f"{found.name}: {counts[found.name]}")
        theta = clearest_configuration(atlas, found)
        if out is not None and theta is not None:
            from linkages.app.scene_figure import draw_configuration

            out.mkdir(parents=True, exist_ok=True)
            figure = draw_configuration(found.build(), theta, found.title)
            figure.savefig(out / f"{found.name}.png", dpi=100)
    PAGE.write_text(make_page(counts), encoding="utf-8")
    click.echo(f"wrote {PAGE.relative_to(PAGE.parents[1])}")


if __name__ == "__main__":
    main()
