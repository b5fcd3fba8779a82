"""The page of a linkage, made of its entry and of what was found of it."""

from __future__ import annotations

import math
from collections.abc import Iterable

from docs.generator.linkage_record import ClosedFormText, LinkageRecord
from docs.generator.markdown import bullets, plain, section, table
from linkages.app.texts.numbers import in_degrees
from linkages.entry import Entry, Parameter, ParameterKind, RelationKind
from linkages.geometry_table import link_name
from linkages.relations import relations_of

CONSTANTS = (
    r"In these equations $u_x$ stands for $\tan(x/2)$ and $t_i$ for "
    r"$\tan(\theta_i/2)$."
)


def linkage_page(entry: Entry, record: LinkageRecord) -> str:
    """The page in Markdown."""
    parts = [
        f"# {plain(entry.title)}",
        f"`{entry.name}`, {record.joints} joints. {plain(entry.source)}.",
        f"```{{linkage}} {entry.name}\n```",
        section("Geometry", _geometry(entry)),
        section("Parameters", _parameters(entry)),
        section("Conditions", bullets(plain(c.text) for c in entry.conditions)),
        section("The map", _map(record)),
        section("Closed forms", _closed_forms(record.closed_forms)),
        section("Published facts", bullets(_facts(entry))),
        section("Related linkages", bullets(_relations(entry.name))),
        section("Misprints in the source", bullets(map(plain, entry.errata))),
        section("On the command line", _commands(entry)),
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def _geometry(entry: Entry) -> str:
    """The Denavit-Hartenberg table at the default parameters."""
    loop = entry.build()
    lengths, twists, offsets = loop.arrays
    rows = []
    for i in range(loop.n):
        rows.append(
            (
                str(i + 1),
                link_name(i, loop.n),
                f"{lengths[i]:.10g}",
                in_degrees(twists[i]),
                f"{offsets[i]:.10g}",
            )
        )
    heads = ("joint", "link", "length", "twist (deg)", "offset")
    words = "At the default parameters; link *ij* joins the axes of joints *i* and *j*."
    return f"{words}\n\n{table(heads, rows)}"


def _parameters(entry: Entry) -> str:
    rows = [
        (f"`{p.name}`", _default(p), plain(p.meaning), p.kind.value)
        for p in entry.parameters
    ]
    return table(("name", "default", "meaning", "kind"), rows) if rows else ""


def _default(parameter: Parameter) -> str:
    if parameter.kind is ParameterKind.ANGLE:
        return f"{math.degrees(parameter.default):.6g} deg"
    return f"{parameter.default:.6g}"


def _map(record: LinkageRecord) -> str:
    """What was found: the sentence, both tables, and how sure that is."""
    parts = [f"{plain(record.verdict)}{_counts(record)}", _forms(record)]
    parts += [_points(record), f"Completeness, {plain(record.completeness)}"]
    words = "[What these words mean](../how_sure.md)."
    return "\n\n".join(part for part in parts if part) + f" {words}"


def _counts(record: LinkageRecord) -> str:
    """The counts as a sentence, where the verdict leaves one of them out."""
    is_said = all(f" {count}" in record.verdict for count in record.counts.split(", "))
    return "" if is_said else f" In all: {record.counts}."


def _forms(record: LinkageRecord) -> str:
    rows = []
    for form in record.forms:
        rows.append(
            (
                plain(form.name),
                f"{form.length:.6g}",
                in_one_line(form.turns),
                form.joints_at_rest or "none",
                _formula(form.symmetry) or "none",
            )
        )
    heads = ("form", "length (deg)", "turns", "joints at rest (deg)", "symmetry")
    return table(heads, rows) if rows else ""


def in_one_line(numbers: str) -> str:
    """Numbers with signs, which no line break may part."""
    return numbers.replace("-", "\N{MINUS SIGN}").replace(" ", "\N{NO-BREAK SPACE}")


def _formula(equation: str) -> str:
    """An equation between angles in LaTeX."""
    return f"${equation}$".replace("theta", r"\theta") if equation else ""


def _points(record: LinkageRecord) -> str:
    rows = [
        (point.name, point.kind, point.angles, plain(point.meeting))
        for point in record.points
    ]
    heads = ("point", "kind", "joint angles (deg)", "what meets")
    return table(heads, rows) if rows else ""


def _closed_forms(forms: Iterable[ClosedFormText]) -> str:
    parts = []
    for form in forms:
        equations = "\n\n".join(f"$$\n{equation}\n$$" for equation in form.equations)
        parts.append(f"**{plain(form.form)}** ({plain(form.source)}):\n\n{equations}")
    return "\n\n".join([CONSTANTS, *parts]) if parts else ""


def _facts(entry: Entry) -> list[str]:
    return [f"{plain(key)}: {plain(str(fact))}" for key, fact in entry.facts.items()]


def _relations(name: str) -> list[str]:
    lines = []
    for relation in relations_of(name):
        words = relation.kind.value
        if relation.kind is RelationKind.SAME:
            words = "the same linkage as"
        link = f"[{relation.other}]({relation.other}.md)"
        detail = f", {plain(relation.detail)}" if relation.detail else ""
        lines.append(f"{words} {link}{detail} ({plain(relation.source)})")
    return lines


def _commands(entry: Entry) -> str:
    lines = [f"$ bifurc map {entry.name}", f"$ bifurc view {entry.name}"]
    if entry.parameters:
        first = entry.parameters[0]
        value = first.default
        if first.kind is ParameterKind.ANGLE:
            value = math.degrees(value)
        lines[0] += f" --param {first.name}={value:.6g}"
    return "```console\n" + "\n".join(lines) + "\n```"
