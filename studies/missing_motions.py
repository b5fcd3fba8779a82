"""Proofs that no motion is missing, put to the test: random members of the catalogue,
searched a second time.

    python -m studies.missing_motions [--count 500] [--seed 0]

The first search has a single random start and the proof
(`linkages.slices.completeness`). The second has other slices and 1500 random starts. A
proof is refuted where the second finds other motions. So that small motions are among
them, every second linkage is a plane-symmetric Bricard linkage close to the birth of a
second motion.
"""

from __future__ import annotations

import time
from collections.abc import Iterator

import click
import numpy as np

from bifurc.atlas import Atlas
from bifurc.search.explore import explore
from bifurc.search.settings import SearchSettings
from linkages.app.texts import table
from linkages.catalogue import catalogue, entry
from linkages.closure.loop_closure import LoopClosure
from linkages.loop import Loop

__all__ = ["linkages", "same_motions"]

STARTS = 1500
# at this twist, with these parameters, a second motion is born in a point; it grows as
# the root of the distance
BIRTH = 2.26432709527
BESIDE = {
    "a12": 0.483,
    "a23": 1.966,
    "a34": 0.890,
    "alpha23": 1.213,
    "alpha34": 1.023,
    "R2": 0.043,
    "R3": -0.267,
}


def linkages(rng: np.random.Generator) -> Iterator[tuple[str, Loop]]:
    """Random members of the families of four to six joints, and in turn with them
    linkages beside a birth."""
    names = [name for name, found in catalogue().items() if found.build().n <= 6]
    while True:
        name = str(rng.choice(names))
        try:
            yield name, entry(name).build(**entry(name).draw(rng))
        except ValueError:  # the constructor refuses these parameters
            continue
        twist = BIRTH - 10.0 ** rng.uniform(-7, -3)
        yield (
            "beside a birth",
            entry("bricard-plane-symmetric").build(alpha12=twist, **BESIDE),
        )


def same_motions(one: Atlas, other: Atlas) -> bool:
    """Whether two atlases list motions of the same lengths."""
    a, b = (
        sorted(form.branch.length for form in atlas.forms) for atlas in (one, other)
    )
    return len(a) == len(b) and bool(np.allclose(a, b, rtol=1e-6))


@click.command()
@click.option(
    "--count",
    default=500,
    show_default=True,
    type=click.IntRange(1),
    help="Linkages to look at.",
)
@click.option("--seed", default=0, show_default=True, help="Of the random linkages.")
def main(count: int, seed: int) -> None:
    """Search random linkages twice, and count the proofs that the second search
    refutes."""
    drawn = linkages(np.random.default_rng(seed))
    levels: dict[str, dict[str, int]] = {}
    refuted: list[str] = []
    seconds = []
    for _ in range(count):
        name, loop = next(drawn)
        kind = name if name == "beside a birth" else "catalogue"
        problem, began = LoopClosure(loop), time.process_time()
        first = explore(problem, settings=SearchSettings(starts=1, prove=True), seed=1)
        seconds.append(time.process_time() - began)
        level = first.completeness.level
        levels.setdefault(kind, {}).setdefault(level, 0)
        levels[kind][level] += 1
        if level == "proved" and not same_motions(
            first, explore(problem, settings=SearchSettings(starts=STARTS), seed=2)
        ):
            refuted.append(f"{name}: {loop}")
            click.echo(f"refuted: {refuted[-1]}")
    rows = [
        (
            kind,
            *(
                str(found.get(level, 0))
                for level in ("proved", "certified", "estimated")
            ),
        )
        for kind, found in levels.items()
    ]
    click.echo(table(("linkages", "proved", "certified", "estimated"), rows))
    click.echo(
        f"{len(refuted)} proofs refuted; search and proof took {1e3 * np.median(seconds):.0f} ms (median)"
    )


if __name__ == "__main__":
    main()
