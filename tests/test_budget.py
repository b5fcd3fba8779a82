"""What fits in one head: the body of a function has `BUDGET` tokens at most, without its
docstring and comments."""

import ast
import re
import tokenize
from pathlib import Path

ROOT = Path(__file__).parents[1]
BUDGET = 250

# those with more, by the reason why
LONGER = {
    "a step of a method, whose parts share most of their numbers": [
        "bifurc.curves.kantorovich.on",
        "bifurc.curves.minima.singular_value_minima",
        "bifurc.curves.near_miss._precise_near_miss",
        "bifurc.curves.near_miss._station",
        "bifurc.curves.valley.unfold_crossing",
        "bifurc.curves.valley_problem.bridge",
        "bifurc.diagrams.cells._kinds_of",
        "bifurc.diagrams.cells.cells_along",
        "bifurc.diagrams.zeros.zeros_along",
        "bifurc.numerics.bordered.__init__",
        "bifurc.numerics.collocation._points_at_nodes",
        "bifurc.numerics.collocation.march_by_collocation",
        "bifurc.singular.classify.classify_singular_point",
        "bifurc.singular.dimension._dimensions_of_nullity",
        "bifurc.surfaces.crossing_sheets.sign_changes",
        "bifurc.surfaces.walk._step",
        "linkages.networks.lock_routes.run",
        "linkages.rigorous.check._is_on_map",
        "linkages.rigorous.check.augmented",
        "linkages.structure.rods._leg",
    ],
    "a list of steps or of cases, one after the other": [
        "bifurc.function_problem._check_periods",
        "bifurc.search.answer.doubts._doubts_of_form",
        "bifurc.search.answer.doubts.doubts_of_findings",
        "bifurc.search.branches.branch_examination.examine",
        "bifurc.search.branches.branch_parts.with_piece_between",
        "bifurc.search.branches.canonical_course.top",
        "bifurc.search.components.components_of_seeds",
        "bifurc.search.search.look_where_starts_stop",
        "bifurc.search.subdivision._are_known",
        "bifurc.search.tracing.trace",
        "linkages.app.commands.route_command._route_over_locks",
        "linkages.closure.cut_at_limits.cut_motions",
        "linkages.closure.driving.joints_to_hold",
        "linkages.forms._four_bar_kind",
        "linkages.identification.fitting.best_member",
        "linkages.turns.turn_lattice.shifts_between",
        "linkages.turns.turn_lattice.turn_lattice",
    ],
    "formulas, written out as their source has them": [
        "bifurc.singular.sphere._circle_section",
        "linkages.families.bricard_collapsible.doubly_collapsible_octahedral",
        "linkages.printing.assembly.link_corners",
        "linkages.readout.poses._displacement",
        "linkages.readout.poses._place_rod",
    ],
    "the fields of a record, one after the other": [
        "bifurc.files.dataset._attributes",
        "bifurc.search.answer.assemble.assemble_atlas",
        "bifurc.search.own_units.restated.restated_branch",
        "linkages.app.answer.document.make_document",
        "linkages.app.sweep.member.summarise",
        "linkages.app.texts.mechanism_text.describe_dead_points",
        "linkages.readout.dataset_variables.dataset_variables",
    ],
    "the keys of a file, one after the other, with what is refused": [
        "bifurc.systems.equation_file.system",
        "linkages.app.sweep.plan.read_plan",
        "linkages.files.fold._edges",
        "linkages.files.fold.mechanism_of_fold",
        "linkages.files.mechanism_file.limits",
        "linkages.formats.composites._joined",
        "linkages.formats.mechanism_of._coupled",
        "linkages.formats.mjcf_poses._orientation",
        "linkages.formats.mjcf_reading._add_chains",
        "linkages.formats.mjcf_reading._read_axis",
        "linkages.formats.mjcf_reading._read_couplings",
        "linkages.formats.names.with_names_for",
        "linkages.formats.sdf_reading._read_joint",
        "linkages.formats.sdf_reading.read_sdf",
        "linkages.formats.sdf_writing._pair",
        "linkages.mechanisms.subject.mechanism_from",
    ],
    "the parts of a figure, one after the other": [
        "bifurc.figures.diagram_plot._marked",
        "bifurc.figures.planes.choose_plane",
        "bifurc.figures.singular_values._draw_form_against",
        "linkages.source_figures.assembly_figure.draw",
        "linkages.source_figures.curves_figure._draw_form",
        "linkages.source_figures.curves_figure._draw_values",
        "linkages.source_figures.drawing._clarities",
        "linkages.source_figures.drawing.draw_assembly",
        "linkages.source_figures.drawing.write_names",
        "linkages.source_figures.graph_drawing.draw_graph",
        "linkages.source_figures.notation_figure._draw_chain",
    ],
}

NO_CODE = {
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENDMARKER,
}
WORD_OR_SIGN = re.compile(r"\w+|[^\w\s]")
MODULES = [
    path
    for name in ("bifurc", "linkages")
    for path in sorted((ROOT / name).rglob("*.py"))
]


def sizes_of_bodies(path: Path) -> dict[str, int]:
    """The number of tokens of the body of each function of a file, with those in it, as
    far as it may be over the budget."""
    text = path.read_text(encoding="utf-8")
    lines = text.splitlines(keepends=True)
    sizes: dict[str, int] = {}
    for node in ast.walk(ast.parse(text)):
        if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            continue
        body = node.body[1:] if ast.get_docstring(node) else node.body
        if not body:
            continue
        own = lines[body[0].lineno - 1 : node.end_lineno]
        # a token holds a word or a sign, so that these are no fewer, and quickly counted
        if len(WORD_OR_SIGN.findall("".join(own))) > BUDGET:
            sizes[node.name] = max(tokens_of(own), sizes.get(node.name, 0))
    return sizes


def tokens_of(lines: list[str]) -> int:
    """The number of tokens of some lines, without comments and ends of lines."""
    tokens = tokenize.generate_tokens(iter(lines).__next__)
    return sum(token.type not in NO_CODE for token in tokens)


def name_of(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts)


def test_no_body_is_longer_than_the_budget_but_those_that_are_listed() -> None:
    longer = {
        f"{name_of(path)}.{function}"
        for path in MODULES
        for function, size in sizes_of_bodies(path).items()
        if size > BUDGET
    }
    listed = {name for names in LONGER.values() for name in names}
    assert not longer - listed, "make it shorter"
    assert not listed - longer, "it fits by now: take it off the list"
