"""Everything that is written of many maps, kept in a folder and compared later.

    python -m studies.frozen_documents write FOLDER [--kind loops] [--seeds 3] [--every 4]
    python -m studies.frozen_documents compare FOLDER OTHER_FOLDER

The maps are those of all linkages and networks of the catalogue, of the mechanisms of
`data/mechanisms.json`, of the curves of `data/curves.json` and of the textbook problems.
Of each the JSON document, the dataset, the graphs, the summary and the data of the page
are kept. A change of the program that is to change no answer is shown to change none:
numbers agree to 1e-9, near misses to 1e-6 (`studies.document_differences`), and texts to
the letter, but for what belongs to a run.
"""

from __future__ import annotations

import json
import re
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias

import click
import networkx as nx
import numpy as np

from bifurc import Atlas, BifurcError, SearchSettings, explore, to_dataset
from bifurc.files.graphml import plain_graph
from bifurc.systems.document import make_document as make_system_document
from bifurc.systems.summary import make_summary as make_system_summary
from linkages import Linkage, Mechanism, load, map_linkage
from linkages.app.answer.document import make_document
from linkages.app.answer.verdict import judge
from linkages.app.options import FOLDER
from linkages.app.texts.summary import make_summary
from linkages.catalogue import catalogue
from linkages.networks.entries import NETWORKS
from linkages.viewing.document import make_view_document
from studies.curve_bank import changes_of, load_curves
from studies.document_differences import values_differ
from studies.known_mechanisms import known_mechanisms
from studies.textbook.problems import load_problems

Json: TypeAlias = Any  # a value that JSON can hold

BUDGET = 600.0  # s of a search: none is to be ended by the time
KINDS = ("loops", "mechanisms", "curves", "textbook")
OF_THE_RUN = re.compile(r"[\d.e+-]+ s\b|random starts[^;.]*|[^;.]*random starts")


@dataclass(frozen=True)
class Case:
    """Something to map: its ``kind``, and the ``name`` by which it is found again."""

    kind: str
    name: str


def cases(kind: str) -> list[Case]:
    """All cases of a kind."""
    names: Mapping[str, Callable[[], list[str]]] = {
        "loops": lambda: [*catalogue(), *NETWORKS],
        "mechanisms": lambda: list(known_mechanisms()),
        "curves": lambda: [curve.name for curve in load_curves()],
        "textbook": lambda: [problem.name for problem in load_problems()],
    }
    return [Case(kind, name) for name in names[kind]()]


def documents_of(case: Case, seed: int) -> dict[str, Json]:
    """All that is written of the map of a case, in values that JSON can hold."""
    if case.kind in ("loops", "mechanisms"):
        return _documents_of_linkage(case, seed)
    return _documents_of_equations(case, seed)


def _documents_of_linkage(case: Case, seed: int) -> dict[str, Json]:
    settings = SearchSettings(budget=BUDGET)
    atlas = map_linkage(_linkage(case), settings=settings, seed=seed)
    verdict = judge(atlas)
    return {
        "document": make_document(atlas),
        "dataset": _dataset_values(atlas),
        "graph": _graph_values(atlas),
        "summary": make_summary(atlas),
        "verdict": [verdict.sentence, int(verdict.code)],
        "page": make_view_document(atlas, verdict.sentence),
    }


def _linkage(case: Case) -> Linkage | Mechanism:
    if case.kind == "loops":
        return load(case.name)
    return known_mechanisms()[case.name].mechanism


def _documents_of_equations(case: Case, seed: int) -> dict[str, Json]:
    if case.kind == "curves":
        curve = next(one for one in load_curves() if one.name == case.name)
        plain = next(changes_of(curve))
        settings = SearchSettings(budget=BUDGET)
        atlas = explore(plain.problem(curve), settings=settings, seed=seed)
        return {
            "dataset": _dataset_values(atlas),
            "graph": _graph_values(atlas),
            "atlas": repr(atlas),
        }
    problem = next(one for one in load_problems() if one.name == case.name)
    atlas = problem.explore(seed, BUDGET)
    documents = {"dataset": _dataset_values(atlas), "graph": _graph_values(atlas)}
    if problem.system is not None:
        subject = {"name": problem.name, "equations": {}, "parameters": {}}
        atlas = replace(atlas, subject=subject)
        documents["document"] = make_system_document(atlas)
        documents["summary"] = make_system_summary(atlas)
    return documents


def _dataset_values(atlas: Atlas) -> Json:
    """The variables and the attributes of the dataset of an atlas."""
    dataset = to_dataset(atlas)
    variables = {}
    for name, variable in dataset.variables.items():
        values = variable.values
        variables[str(name)] = {
            "dims": list(variable.dims),
            "values": np.ravel(values).tolist(),
        }
    attributes = {str(key): _parsed(value) for key, value in dataset.attrs.items()}
    return {"variables": variables, "attributes": attributes}


def _parsed(value: Json) -> Json:
    """An attribute of a dataset, taken apart where it holds JSON."""
    is_json = isinstance(value, str) and value.startswith(("{", "["))
    return json.loads(value) if is_json else value


def _graph_values(atlas: Atlas) -> Json:
    """Nodes and edges of the graphs of an atlas, with their attributes."""
    return nx.node_link_data(plain_graph(atlas), edges="edges")


# --- a folder of documents ------------------------------------------------------------


def write_case(folder: Path, case: Case, seed: int) -> float:
    """Write the documents of a case; the processor time (s) that they took."""
    began = time.process_time()
    try:
        documents = documents_of(case, seed)
    except (BifurcError, ArithmeticError, ValueError) as error:
        documents = {"error": f"{type(error).__name__}: {error}"}
    seconds = time.process_time() - began
    path = folder / case.kind / f"{_file_name(case.name)}.{seed}.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps({**documents, "seconds": seconds}, default=_plain)
    path.write_text(text, encoding="utf-8")
    return seconds


def _file_name(name: str) -> str:
    return re.sub(r"[^\w.=+-]+", "_", name)


def _plain(value: object) -> Json:
    """A value of NumPy as one that JSON can hold."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    return str(value)


def compare_folders(one: Path, other: Path) -> Iterator[tuple[str, list[str]]]:
    """The files that both folders have, and what differs in each."""
    for path in sorted(one.glob("*/*.json")):
        name = path.relative_to(one)
        if (other / name).exists():
            left = json.loads(path.read_text(encoding="utf-8"))
            right = json.loads((other / name).read_text(encoding="utf-8"))
            yield str(name), differences(left, right)


def differences(one: Mapping[str, Json], other: Mapping[str, Json]) -> list[str]:
    """Where all that was written of one map differs from that of another."""
    lines = []
    for key in sorted({*one, *other} - {"seconds"}):
        left, right = _without_run(one.get(key)), _without_run(other.get(key))
        lines += values_differ(key, left, right)
    return lines


def _without_run(value: Json) -> Json:
    """A value without what belongs to a run: its times, and counts of random starts."""
    if isinstance(value, str):
        # data in base 64 are long, and hold no space
        return OF_THE_RUN.sub("", value) if " " in value else value
    if isinstance(value, Mapping):
        return {key: _without_run(inner) for key, inner in value.items()}
    if isinstance(value, list) and value and not isinstance(value[0], float | int):
        return [_without_run(inner) for inner in value]
    return value


@click.group(help=__doc__)
def main() -> None:
    """Write or compare folders of documents."""


@main.command()
@click.argument("folder", type=FOLDER)
@click.option("--kind", "kinds", multiple=True, type=click.Choice(KINDS))
@click.option("--seeds", default=1, show_default=True)
@click.option("--first-seed", default=0, show_default=True)
@click.option("--every", default=1, show_default=True, help="One case in so many.")
@click.option("--name", "part", default="", help="Only cases whose name has this.")
@click.option("--processes", default=1, show_default=True)
@click.option("--like", type=FOLDER, help="Only cases faster there than --within s.")
@click.option("--within", default=5.0, show_default=True)
def write(
    folder: Path,
    kinds: tuple[str, ...],
    seeds: int,
    first_seed: int,
    every: int,
    part: str,
    processes: int,
    like: Path | None,
    within: float,
) -> None:
    """Map the cases and write their documents."""
    chosen = []
    for kind in kinds or KINDS:
        named = [case for case in cases(kind) if part in case.name]
        chosen += named[::every]
    runs = [(c, s) for s in range(first_seed, first_seed + seeds) for c in chosen]
    if like is not None:
        runs = [run for run in runs if _seconds_in(like, *run) < within]
    total = 0.0
    with ProcessPoolExecutor(processes) as pool:
        times = pool.map(partial(_write_run, folder), runs)
        for (case, seed), seconds in zip(runs, times, strict=True):
            total += seconds
            if seconds > 5.0:
                click.echo(f"{case.kind} {case.name}, seed {seed}: {seconds:.1f} s")
    click.echo(f"{len(runs)} maps, {total:.0f} s of processor time")


def _write_run(folder: Path, run: tuple[Case, int]) -> float:
    return write_case(folder, *run)


def _seconds_in(folder: Path, case: Case, seed: int) -> float:
    """How long a case took in a folder; forever where it is not there."""
    path = folder / case.kind / f"{_file_name(case.name)}.{seed}.json"
    if not path.exists():
        return np.inf
    match = re.search(r'"seconds": ([\d.e+-]+)}$', path.read_text(encoding="utf-8"))
    return float(match[1]) if match else np.inf


@main.command()
@click.argument("folder", type=FOLDER)
@click.argument("other", type=FOLDER)
@click.option("--lines", default=12, show_default=True, help="Shown of each map.")
@click.option("--only", default="", help="Only lines with this in them.")
@click.option("--without", multiple=True, help="No lines with this in them.")
def compare(
    folder: Path, other: Path, lines: int, only: str, without: tuple[str, ...]
) -> None:
    """Say what differs between two folders."""
    count = unlike = 0
    for name, differing in compare_folders(folder, other):
        count += 1
        shown = [
            line
            for line in differing
            if only in line and not any(part in line for part in without)
        ]
        if shown:
            unlike += 1
            click.echo("\n  ".join([name, *(line[:400] for line in shown[:lines])]))
    click.echo(f"{count} maps compared, {unlike} differ")
    sys.exit(6 if unlike else 0)


if __name__ == "__main__":
    main()
