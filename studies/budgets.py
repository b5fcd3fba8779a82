"""How long after its budget, and after Ctrl-C, a search ends: twenty hard cases.

Each is explored in a process of its own. Counted is the time from the begin of the search to
the end of the process; what Python needs to start, and to make the problem, is not. Ctrl-C
comes so many seconds after the begin. On a machine with other work the processor time after
that moment tells more.

    python -m studies.budgets [--budget 2] [--interrupt 2] [--only TEXT]
"""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from math import inf
from threading import Timer
from typing import NamedTuple

import click
import numpy as np

from bifurc import (
    Atlas,
    FunctionProblem,
    Problem,
    SearchSettings,
    explore,
)
from linkages import Closure
from linkages.catalogue import entry

Equations = Callable[[np.ndarray], np.ndarray]
BEGUN = "begun"
LONGEST = 120.0  # s after which a process is ended


Search = Callable[[float], Atlas]


class Case(NamedTuple):
    """What makes a search that takes long, to which a budget (s) is given."""

    name: str
    prepared: Callable[[], Search]


def case(
    name: str,
    make: Callable[[], Problem],
    starts: int = 200,
    boxes: int = 20_000,
    parameter: str | None = None,
) -> Case:
    """The search of what a problem is made of."""

    def prepared() -> Search:
        problem = make()
        settings = SearchSettings(starts=starts, boxes=boxes)
        return lambda budget: explore(
            problem, settings=replace(settings, budget=budget), parameter=parameter
        )

    return Case(name, prepared)


def of_function(
    function: Equations, n: int, size: float = 2.0, *, is_recorded: bool = True
) -> Callable[[], Problem]:
    """The problem of a function of n unknowns between -size and size."""
    return lambda: FunctionProblem(
        function, [(-size, size)] * n, is_recorded=is_recorded
    )


# --- equations ------------------------------------------------------------------------


def linear_factors(count: int) -> Equations:
    """A product of lines."""
    rng = np.random.default_rng(1)
    angles, offsets = rng.uniform(0, np.pi, count), rng.uniform(-1, 1, count)

    def function(u: np.ndarray) -> np.ndarray:
        product = 1.0
        for angle, offset in zip(angles, offsets, strict=True):
            product = product * (np.cos(angle) * u[0] + np.sin(angle) * u[1] - offset)
        return np.array([product])

    return function


def lines_through_one_point(count: int) -> Equations:
    """A product of lines through 0."""

    def function(u: np.ndarray) -> np.ndarray:
        product = 1.0
        for angle in np.linspace(0, np.pi, count, endpoint=False):
            product = product * (np.cos(angle) * u[0] + np.sin(angle) * u[1])
        return np.array([product])

    return function


def quadrics(n: int) -> Equations:
    """Random quadrics, one less than there are unknowns."""
    rng = np.random.default_rng(2)
    forms = rng.normal(size=(n - 1, n, n)) / n
    rows = rng.normal(size=(n - 1, n))

    def function(u: np.ndarray) -> np.ndarray:
        return np.array(
            [
                u @ form @ u + row @ u - 0.3
                for form, row in zip(forms, rows, strict=True)
            ]
        )

    return function


def bratu(n: int) -> Equations:
    """Bratu's problem in one dimension, by differences; the last unknown is the
    parameter."""

    def function(u: np.ndarray) -> np.ndarray:
        inner, p = u[:-1], u[-1]
        zero = np.zeros(1) * p
        left = np.concatenate([zero, inner[:-1]])
        right = np.concatenate([inner[1:], zero])
        residual: np.ndarray = n * n * (left - 2 * inner + right) + p * np.exp(inner)
        return residual

    return function


def gyroid(u: np.ndarray) -> np.ndarray:
    """Schoen's surface."""
    x, y, z = u
    return np.array(
        [np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)]
    )


def cayley(u: np.ndarray) -> np.ndarray:
    """The cubic surface with four nodes."""
    x, y, z = u
    return np.array([x * x + y * y + z * z - 2 * x * y * z - 1])


def product_of_circles(u: np.ndarray) -> np.ndarray:
    """A torus in four dimensions that touches another."""
    x, y, z, w = u
    return np.array([(x * x + y * y - 1) * (x + z), (z * z + w * w - 1) * (y - w)])


def sphere_in_five(u: np.ndarray) -> np.ndarray:
    """A set of dimension four."""
    return np.array([u @ u - 1])


def lines_on_a_rim(u: np.ndarray) -> np.ndarray:
    """Lines along which an inverse function has no derivative."""
    return np.array([np.arcsin(np.cos(u[0])) - np.pi / 2 + 0 * u[1]])


def band(u: np.ndarray) -> np.ndarray:
    """Zero on a band of full dimension."""
    return np.array([np.arcsin(np.sin(u[0])) - u[0] + 0 * u[1]])


def in_single_precision(u: np.ndarray) -> np.ndarray:
    """A circle in float32."""
    x, y = np.asarray(u, dtype=np.float32)
    return np.array([x * x + y * y - np.float32(1)], dtype=float)


def noisy(share: float) -> Equations:
    """A cubic with noise that is drawn by the point."""

    def function(u: np.ndarray) -> np.ndarray:
        rng = np.random.default_rng(abs(hash(u.tobytes())) % 2**32)
        return np.array([u[1] ** 2 - u[0] ** 3 + u[0] + share * rng.normal()])

    return function


def slow(u: np.ndarray) -> np.ndarray:
    """A circle that takes 20 ms."""
    time.sleep(0.02)
    return np.array([float(u[0]) ** 2 + float(u[1]) ** 2 - 1.0])


def contact(u: np.ndarray) -> np.ndarray:
    """Branches that touch to a high order."""
    x, y = u
    return np.array([(y - x**2) * (y - x**2 - x**7) * (y**5 - x**11)])


def repeated_polynomial(u: np.ndarray) -> np.ndarray:
    """An expanded square in four unknowns, and two equations besides."""
    x, y, z, w = u
    form = x**3 + y**3 + z**3 + w**3 + 3 * x * y * z - 2 * w * y * x + z - 1
    return np.array([form * form * (1 + 0 * x), x * z - w * y, (x + y - z * w) ** 3])


def twelve_degree_boxes(u: np.ndarray) -> np.ndarray:
    """Many small ovals."""
    x, y, z, w = u
    ovals = np.cos(9 * x) * np.cos(9 * y) + np.sin(7 * z)
    return np.array([ovals, np.cos(8 * w) - z * x, y * w - np.sin(5 * x * z)])


def coupled_cells(n: int) -> Equations:
    """Brusselators in a row; the last unknown is the parameter."""

    def function(u: np.ndarray) -> np.ndarray:
        x, y, p = u[: n // 2], u[n // 2 : -1], u[-1]
        coupled_x = (
            np.concatenate([x[1:], x[-1:]]) - 2 * x + np.concatenate([x[:1], x[:-1]])
        )
        coupled_y = (
            np.concatenate([y[1:], y[-1:]]) - 2 * y + np.concatenate([y[:1], y[:-1]])
        )
        reaction = x * x * y
        return np.concatenate(
            [
                1 + reaction - (p + 1) * x + 0.1 * coupled_x,
                p * x - reaction + 2 * coupled_y,
            ]
        )

    return function


def linkage(name: str) -> Case:
    """The map of a linkage of the catalogue."""

    def prepared() -> Search:
        problem = Closure(entry(name).build())
        return lambda budget: explore(problem, settings=SearchSettings(budget=budget))

    return Case(name, prepared)


CASES = [
    case("500 linear factors", of_function(linear_factors(500), 2)),
    case("40 lines through a point", of_function(lines_through_one_point(40), 2)),
    case("50 unknowns", of_function(quadrics(50), 50)),
    case("1,000 unknowns", of_function(bratu(999), 1000, 5.0)),
    case("3,000 unknowns", of_function(bratu(2999), 3000, 5.0)),
    case(
        "3,000 unknowns, a callable",
        of_function(bratu(2999), 3000, 5.0, is_recorded=False),
    ),
    case(
        "300 unknowns, a callable", of_function(bratu(299), 300, 5.0, is_recorded=False)
    ),
    case("gyroid", of_function(gyroid, 3, 6.0)),
    case("Cayley cubic", of_function(cayley, 3, 1.5)),
    case("surfaces in four unknowns", of_function(product_of_circles, 4)),
    case("a set of dimension four", of_function(sphere_in_five, 5)),
    case("asin(cos x) = pi/2", of_function(lines_on_a_rim, 2, 10.0)),
    case("asin(sin x) = x", of_function(band, 2, 10.0)),
    case("900,000 starts", of_function(cayley, 3, 1.5), starts=900_000),
    case("900,000 starts of a callable", of_function(slow, 2), starts=900_000),
    case("float32", of_function(in_single_precision, 2, is_recorded=False)),
    case("noise of 1e-7", of_function(noisy(1e-7), 2, is_recorded=False)),
    case("noise of 1e-5", of_function(noisy(1e-5), 2, is_recorded=False)),
    case("contact of high order", of_function(contact, 2)),
    case("squares in four unknowns", of_function(repeated_polynomial, 4)),
    case("boxes", of_function(twelve_degree_boxes, 4, 3.0), boxes=10_000_000),
    case(
        "stability of 61 unknowns",
        of_function(coupled_cells(60), 61, 6.0),
        parameter="u61",
    ),
    linkage("wohlhart-double-goldberg"),
]


# --- measuring ------------------------------------------------------------------------


class Times(NamedTuple):
    """Seconds from the begin of a search, or from Ctrl-C, to the end of its process, and
    what its last line says, with the processor time; without end where it had to be
    killed."""

    seconds: float
    said: str


def measure(name: str, budget: float, interrupt_after: float) -> Times:
    """How long a process takes that explores a case."""
    words = [sys.executable, "-m", "studies.budgets", "--child", name]
    process = subprocess.Popen(
        [*words, "--budget", str(budget), "--interrupt", str(interrupt_after)],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    assert process.stdout is not None
    process.stdout.readline()
    begun = time.perf_counter()
    if interrupt_after < inf:
        time.sleep(interrupt_after)
        if process.poll() is not None:
            return Times(0.0, "ended before")
        process.send_signal(signal.SIGINT)
        begun = time.perf_counter()
    try:
        rest, _ = process.communicate(timeout=LONGEST)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return Times(inf, "killed")
    said = rest.strip().splitlines()
    return Times(time.perf_counter() - begun, said[-1] if said else "")


def _run(name: str, budget: float, moment: float) -> None:
    """Explore a case in this process, and say how much processor time it takes after a
    ``moment`` (s)."""
    (found,) = (one for one in CASES if one.name == name)
    search = found.prepared()
    before = [0.0]
    timer = Timer(moment, lambda: before.insert(0, time.process_time()))
    timer.daemon = True
    timer.start()
    print(BEGUN, flush=True)
    atlas = search(budget)
    after = time.process_time() - before[0] if before[0] else 0.0
    end = atlas.provenance
    state = (
        "interrupted"
        if end.interrupted
        else "out of time"
        if end.out_of_time
        else "whole"
    )
    counts = f"{len(atlas.forms)} forms, {len(atlas.surfaces)} surfaces"
    print(f"processor {after:.2f} s; {counts}, {state}")


@click.command()
@click.option("--budget", "budgets", multiple=True, type=float, help="Seconds.")
@click.option("--interrupt", "interrupts", multiple=True, type=float, help="Seconds.")
@click.option("--only", default="", help="Part of the names of cases.")
@click.option("--child", hidden=True, help="The case to explore in this process.")
def main(
    budgets: tuple[float, ...],
    interrupts: tuple[float, ...],
    only: str,
    child: str | None,
) -> None:
    """Print the seconds beyond each budget, and after each Ctrl-C."""
    if child is not None:
        _run(child, budgets[0], min(budgets[0], interrupts[0]))
        return
    for one in CASES:
        if only not in one.name:
            continue
        for budget in budgets:
            times = measure(one.name, budget, inf)
            over = times.seconds - budget
            print(
                f"{one.name:30} budget {budget:4g}: {over:+7.2f} s  {times.said}",
                flush=True,
            )
        for seconds in interrupts:
            times = measure(one.name, inf, seconds)
            print(
                f"{one.name:30} Ctrl-C {seconds:4g}: {times.seconds:7.2f} s  {times.said}",
                flush=True,
            )


if __name__ == "__main__":
    main()
