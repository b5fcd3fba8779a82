"""Networks of four equal Bennett loops: which locks make them bifurcate? (the special
cases that Song 2013, section 6.3, leaves open)

    python -m studies.special_bennett_networks [--alpha 35] [--gamma 81] [KINK/KINK ...]

With alpha = beta and gamma = delta all four loops are the same. Joints 2 and 6 are locked, a
pair that can leave several forms. What the map says stands beside what the closed form of
the network says: with K = sin((alpha + gamma)/2) / sin((alpha - gamma)/2), g(v) = 2 atan(K / tan(v/2))
and s = 180 - kink, the motions are

    S(x; s2) + S(y; s6) = 0 (mod 360),    S(v; s) = g(v) + g(s - v),    v, s in degrees

S is extreme at v = s/2 and v = s/2 + 180 alone, so forms are read from two intervals. They
meet where both terms are extreme and of different curvature. That is so if and only if the
kinks are opposite, and then in two configurations. Where both kinks are 180, S vanishes
identically: a surface.
"""

from __future__ import annotations

import time
from typing import NamedTuple

import click
import numpy as np

from bifurc import Atlas, SearchSettings
from bifurc.tables import count_of, table
from linkages import GeometryError, map_linkage
from linkages.construction.link import half_angle_ratio
from linkages.networks.mechanism import lock_network
from linkages.networks.network import build_network, other_angle
from linkages.networks.plan import FOUR_BENNETT
from studies.study import Study

LOCKED = "2", "6"
KINKS = "0/0", "40/-40", "40/40", "0/60", "100/-30", "180/40", "180/180"
SAMPLES = 721  # of half a period of S, to follow it through full turns
SAME = 1e-9  # rad: ends of intervals that are the same
HEADS = "kinks (deg)", "the map", "by the closed form", "certainty", "time (s)"


class Counts(NamedTuple):
    """What there is under a pair of locks: ``forms``, ``bifurcations``, and surfaces of
    mobility 2."""

    forms: int
    bifurcations: int
    surfaces: int

    def __str__(self) -> str:
        forms = count_of(self.forms, "form")
        bifurcations = count_of(self.bifurcations, "bifurcation")
        text = f"{forms}, {bifurcations}"
        if self.surfaces:
            text += f", {count_of(self.surfaces, 'surface')}"
        return text


def map_network(
    alpha: float, gamma: float, kinks: tuple[float, float], budget: float
) -> Atlas:
    """The map of the network of equal loops, joints 2 and 6 locked; angles in rad.

    Raises `GeometryError` where it cannot be assembled.
    """
    network = build_network(FOUR_BENNETT, np.sin(alpha), alpha, alpha, gamma, gamma)
    mechanism = lock_network(network, dict(zip(LOCKED, kinks, strict=True)))
    return map_linkage(mechanism, settings=SearchSettings(budget=budget))


def mapped(atlas: Atlas) -> Counts:
    """What a map has."""
    return Counts(len(atlas.forms), len(atlas.bifurcations), len(atlas.surfaces))


def predicted(alpha: float, gamma: float, kinks: tuple[float, float]) -> Counts:
    """What there is by the closed form; angles in rad."""
    factor = float(half_angle_ratio(gamma, alpha))
    low, high = _interval(factor, kinks[0])
    other = _interval(factor, kinks[1])
    if max(high - low, other[1] - other[0]) < SAME:
        return Counts(0, 0, 1)
    forms = bifurcations = 0
    # the other term has the same values with the other sign, and full turns besides
    first = int(np.floor((low + other[0]) / (2 * np.pi)))
    last = int(np.ceil((high + other[1]) / (2 * np.pi)))
    for turns in range(first, last + 1):
        from_other = 2 * np.pi * turns - other[1], 2 * np.pi * turns - other[0]
        begins = low - from_other[0]
        ends = high - from_other[1]
        if min(high, from_other[1]) < max(low, from_other[0]):
            continue
        if abs(begins) < SAME and abs(ends) < SAME:
            forms, bifurcations = forms + 2, bifurcations + 2
        elif (
            begins * ends < 0
        ):  # one inside the other: that one is passed on both sides
            forms += 2
        else:
            forms += 1
    return Counts(forms, bifurcations, 0)


def _interval(factor: float, kink: float) -> tuple[float, float]:
    """The least and the greatest value (rad) of S under a lock."""
    s = np.pi - kink
    away = np.linspace(0.0, np.pi, SAMPLES)
    values = other_angle(factor, s / 2 + away) + other_angle(factor, s / 2 - away)
    ends = np.unwrap(values)[[0, -1]]
    return float(ends.min()), float(ends.max())


def _read_kinks(text: str) -> tuple[float, float]:
    first, slash, second = text.partition("/")
    try:
        kinks = float(first), float(second)
    except ValueError:
        kinks = np.nan, np.nan
    if not slash or not np.isfinite(kinks).all():
        raise click.BadParameter(f"{text!r} is not allowed; write two kinks as 40/-40")
    return np.radians(kinks[0]), np.radians(kinks[1])


@click.command(cls=Study, help=__doc__)
@click.argument("pairs", metavar="[KINK/KINK ...]", nargs=-1)
@click.option("--alpha", type=float, default=35.0, show_default=True, help="Degrees.")
@click.option("--gamma", type=float, default=81.0, show_default=True, help="Degrees.")
@click.option("--budget", type=float, default=60.0, show_default=True, help="Seconds.")
def main(pairs: tuple[str, ...], alpha: float, gamma: float, budget: float) -> None:
    """Map the network under every pair of locks, and print the table."""
    twists = np.radians(alpha), np.radians(gamma)
    all_kinks = {pair: _read_kinks(pair) for pair in pairs or KINKS}
    rows = []
    for pair, kinks in all_kinks.items():
        click.echo(f"mapping {pair}", err=True)
        began = time.process_time()
        by_form = str(predicted(*twists, kinks))
        try:
            atlas = map_network(*twists, kinks, budget)
        except GeometryError:
            rows.append((pair, "cannot be assembled", by_form, "-", "-"))
            continue
        spent = f"{time.process_time() - began:.1f}"
        level = str(atlas.completeness.level)
        rows.append((pair, str(mapped(atlas)), by_form, level, spent))
    click.echo(table(HEADS, rows))


if __name__ == "__main__":
    main()
