"""The command `bifurc limits`: how far joints reach."""

from __future__ import annotations

import math

import click

from linkages.app import options
from linkages.app.exit_codes import CommandError, exit_code_table


@click.command("limits", epilog=exit_code_table())
@click.argument("source", metavar="NAME|FILE.toml|ATLAS.nc")
@options.form_option
@click.option(
    "--within",
    multiple=True,
    metavar="JOINT=LOW:HIGH",
    help="Keep a joint within limits, in degrees or lengths; forms fall into the parts "
    "that do.",
)
@options.json_option("; angles in radians")
@options.atlas_options
def limits_command(
    source: str,
    forms: tuple[str, ...],
    within: tuple[str, ...],
    as_json: bool,
    choice: options.AtlasOptions,
) -> None:
    """Show from where to where each joint goes along each form, and what ends that: a dead
    point, a singular point, the limit of a joint.

    Ends are zeros of rates on the curve itself, to nearly all digits. Angles are known up
    to whole turns: the middle of a range is above -180 and up to 180 degrees.

    \b
    Examples:
      bifurc limits four-bar
      bifurc limits out/atlas.nc --form "Form I" --json
      bifurc limits four-bar --within 2=-90:90
    """
    from linkages.app.answer.verdict import exit_by, judge
    from linkages.app.atlas_source import atlas_of
    from linkages.app.output import say, say_json
    from linkages.app.reports.reach import reach_along, variable_labels
    from linkages.app.texts.form_names import choose_forms, require_forms
    from linkages.app.texts.reach_text import describe_reach, reach_document

    atlas = atlas_of(source, choice)
    require_forms(atlas)
    limits = _limits(within, variable_labels(atlas))
    numbers = [atlas.forms.index(form) for form in choose_forms(atlas, forms)]
    stretches = [
        stretch for number in numbers for stretch in reach_along(atlas, number, limits)
    ]
    if as_json:
        say_json(reach_document(atlas, stretches))
    else:
        say(describe_reach(atlas, stretches))
    exit_by(judge(atlas))


def _limits(
    texts: tuple[str, ...], is_angle: dict[str, bool]
) -> dict[str, tuple[float, float]]:
    """The limits in "joint=low:high", by label, angles turned into rad; raises
    `CommandError`."""
    from linkages.app.choice import split_parameter
    from linkages.app.parameter_ranges import read_span

    limits: dict[str, tuple[float, float]] = {}
    for text in texts:
        label, span = split_parameter(text, "--within")
        if label not in is_angle:
            known = ", ".join(is_angle)
            raise CommandError(f"--within {label}: it must be one of {known}")
        if label in limits:
            raise CommandError(f"--within {label}: it is given twice")
        low, high = read_span(label, span, "--within")
        if is_angle[label]:
            if high - low >= 360.0:
                allowed = "less than 360 degrees apart"
                raise CommandError(f"--within {label}: {span!r} must be {allowed}")
            low, high = math.radians(low), math.radians(high)
        limits[label] = (low, high)
    return limits
