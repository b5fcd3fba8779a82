"""Printed parts of planar mechanisms, in layers, as `bifurc export` makes them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from bifurc.atlas import Atlas, Form
from linkages.app.exit_codes import CommandError, ExitCode
from linkages.app.options import PrintOptions
from linkages.app.reports.layers import describe_layers, layers_of, meeting_names
from linkages.app.reports.printing import dimensions_of, scale_of
from linkages.app.texts.configurations import arclength_unit
from linkages.mechanisms.joint import JointKind
from linkages.mechanisms.mechanism import Mechanism
from linkages.printing.stack import Stack, widths_of
from linkages.subject import Subject, subject_at
from linkages.values import GeometryError

PRINTED = (JointKind.REVOLUTE, JointKind.PRISMATIC)  # kinds of joints


def is_stacked(subject: Subject) -> bool:
    """Whether parts lie in layers: those of a mechanism that moves in a plane."""
    return subject.readout is not None and subject.flat_parts.normal is not None


def stack_of(atlas: Atlas, forms: Sequence[Form], options: PrintOptions) -> Stack:
    """The parts of a planar mechanism in layers in which none meet along forms, or in
    the best ones. Raises `GeometryError` for sizes that do not fit, and for joints that
    have no pins, `CommandError` for options without effect."""
    subject = subject_at(atlas)
    assert subject.readout is not None  # as parts are stacked
    _check_kinds(subject.readout.mechanism)
    if options.offsets is not None:
        raise CommandError(
            "--offsets: it has no effect on a planar mechanism; `layers` in its file say "
            "where bodies lie"
        )
    scale = scale_of(subject.size, options)
    dimensions = dimensions_of(scale * subject.size, options)
    layers = layers_of(atlas, forms, widths_of(dimensions, scale))
    return Stack(layers, dimensions, scale)


def _check_kinds(mechanism: Mechanism) -> None:
    for joint in mechanism.joints:
        if joint.kind not in PRINTED:
            allowed = f"{' or '.join(PRINTED)} where parts are printed"
            raise GeometryError(f"kind of joint {joint.name}", joint.kind, allowed)


def describe_stack(atlas: Atlas, stack: Stack) -> str:
    """The layers, and how far apart these and the parts are."""
    shown = describe_layers(atlas, stack.layers)
    if stack.layers.meetings:
        return shown
    play = stack.dimensions.play
    return (
        f"{shown}\nA layer is {stack.pitch:.3f} mm above the one below; parts that share "
        f"one keep {play:g} mm apart."
    )


def write_stack(atlas: Atlas, form: Form, stack: Stack, out: Path) -> None:
    """Write the file of that ending: the parts as they stand where ``form`` begins, or
    laid out; raises `OSError`."""
    from bifurc.files.atomic import replace_file
    from linkages.printing.solids import make_stack, write_stack_step, write_stl

    try:
        parts = make_stack(stack)
    except ArithmeticError as error:
        raise CommandError(f"--diameter: with these sizes {error}") from None
    if out.name.lower().endswith(".stl"):
        replace_file(out, lambda part: write_stl(parts, part))
        return
    title = subject_at(atlas).name or "mechanism"
    point = form.branch(0.0)
    replace_file(out, lambda part: write_stack_step(stack, parts, point, title, part))


def stack_error(atlas: Atlas, stack: Stack) -> CommandError:
    """The error that says, in a line, what meets in all layers."""
    worst = min(stack.layers.meetings, key=lambda meeting: meeting.left)
    names = meeting_names(stack.layers, worst)
    left = stack.scale * worst.left
    state = f"overlap by {-left:.3f} mm" if left < 0 else f"leave {left:.3f} mm"
    unit = arclength_unit(atlas)
    place = f"{unit.factor * worst.s:.3f} {unit.name} along {worst.form.name}"
    start = "no layers keep all parts apart"
    if subject_at(atlas).given_layers:
        start = "the given layers do not keep all parts apart"
    elif not stack.layers.is_proven:
        start = "no layers with all parts apart were found in time"
    message = (
        f"{start}: {names} {state} at {place}; try a smaller --diameter, a larger --size, "
        "or --form with one form"
    )
    return CommandError(message, ExitCode.PARTS_MEET)
