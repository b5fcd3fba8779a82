"""Counts that leave no motion out, put to the test: random members of the catalogue,
searched a second time.

    python -m studies.missing_motions [--count 500] [--seed 0]

The first search has a single random start and the count
(`linkages.slices.completeness`). The second has other slices and 1500 random starts. A
count is refuted where the second finds other motions. So that small motions are among
them, every second linkage is a plane-symmetric Bricard linkage close to the birth of a
second motion.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterator
from itertools import islice

import click
import numpy as np

from bifurc import Atlas, Level, SearchSettings, explore
from bifurc.tables import table
from linkages import Closure, GeometryError, Loop
from linkages.catalogue import catalogue, entry
from studies.study import Study

FIRST = SearchSettings(starts=1, count=True)
SECOND = SearchSettings(starts=1500)
LEVELS = (Level.COUNTED, Level.CERTIFIED, Level.ESTIMATED)
AT_BIRTH = "beside a birth"
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
    names = [name for name, family in catalogue().items() if family.build().n <= 6]
    while True:
        name = str(rng.choice(names))
        family = entry(name)
        try:
            loop = family.build(**family.draw(rng))
        except GeometryError:  # the constructor refuses these parameters
            continue
        yield name, loop
        twist = BIRTH - 10.0 ** rng.uniform(-7, -3)
        newborn = entry("bricard-plane-symmetric").build(alpha12=twist, **BESIDE)
        yield AT_BIRTH, newborn


def same_motions(one: Atlas, other: Atlas) -> bool:
    """Whether two atlases list motions of the same lengths."""
    lengths = _lengths(one)
    others = _lengths(other)
    if len(lengths) != len(others):
        return False
    return bool(np.allclose(lengths, others, rtol=1e-6))


def _lengths(atlas: Atlas) -> list[float]:
    return sorted(form.branch.length for form in atlas.forms)


@click.command(cls=Study)
@click.option(
    "--count",
    default=500,
    show_default=True,
    type=click.IntRange(1),
    help="Linkages to look at.",
)
@click.option("--seed", default=0, show_default=True, help="Of the random linkages.")
def main(count: int, seed: int) -> None:
    """Search random linkages twice, and count what the second search
    refutes."""
    levels: dict[str, Counter[str]] = {}
    refuted = 0
    seconds = []
    for name, loop in islice(linkages(np.random.default_rng(seed)), count):
        kind = name if name == AT_BIRTH else "catalogue"
        problem = Closure(loop)
        start = time.process_time()
        atlas = explore(problem, settings=FIRST, seed=1)
        seconds.append(time.process_time() - start)
        level = atlas.completeness.level
        levels.setdefault(kind, Counter())[level] += 1
        if level is not Level.COUNTED:
            continue
        if not same_motions(atlas, explore(problem, settings=SECOND, seed=2)):
            refuted += 1
            click.echo(f"refuted: {name}: {loop}")
    rows = []
    for kind, counts in levels.items():
        rows.append((kind, *(str(counts[level]) for level in LEVELS)))
    click.echo(table(("linkages", *LEVELS), rows))
    milliseconds = 1e3 * np.median(seconds)
    click.echo(
        f"{refuted} counts refuted; search and count took {milliseconds:.0f} ms "
        "(median)"
    )


if __name__ == "__main__":
    main()
