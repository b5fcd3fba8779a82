"""Which joints are limited, and by what, is what MuJoCo makes of `limited`, `range` and
`autolimits`."""

import itertools

import mujoco
import pytest

from linkages.formats.mjcf_reading import read_mjcf
from linkages.formats.xml_tree import parse_xml
from linkages.values import GeometryError
from tests.samples import one_in

REFUSED = "refused"
COMPILERS = [
    "",
    '<compiler angle="radian" autolimits="true"/>',
    '<compiler autolimits="false"/>',
    '<compiler autolimits="false"/><compiler angle="radian"/>',
    '<compiler autolimits="false"/><compiler autolimits="true"/>',
]
LIMITED = ["", 'limited="true"', 'limited="false"', 'limited="auto"']
RANGES = ["", 'range="-1 2"', 'range="2 -1"']
RANGES_OF_JOINT = ["", 'range="0 3"', 'range="0 0"']


def model_of(kind, compiler, default, class_default, joint):
    """A model of one joint, the class "c" of which has defaults."""
    return (
        f'<mujoco>{compiler}<default><joint {default}/><default class="c">'
        f"<joint {class_default}/></default></default><worldbody><body>"
        f'<joint type="{kind}" {joint}/><geom size="1"/></body></worldbody></mujoco>'
    )


def limits_in_mujoco(text):
    """The range of the joint, None without limits."""
    try:
        model = mujoco.MjModel.from_xml_string(text)
    except ValueError:
        return REFUSED
    return tuple(model.jnt_range[0]) if model.jnt_limited[0] else None


def limits_as_read(text):
    """The same, as the file is read; what is left out of a ball joint is a range."""
    try:
        assembly = read_mjcf(parse_xml(text.encode()), "model")
    except GeometryError:
        return REFUSED
    (joint,) = assembly.joints
    if any("range of the ball" in note for note in assembly.notes):
        return "left out"
    return next(iter(joint.limits), None)


@pytest.mark.parametrize(
    "case", one_in(4, itertools.product(["hinge", "slide", "ball"], COMPILERS))
)
def test_limits_are_those_of_mujoco(case):
    kind, compiler = case
    seen = set()
    own = itertools.product(LIMITED, RANGES_OF_JOINT)
    for inherited, (limited, wide) in itertools.product(
        itertools.product(LIMITED, RANGES), own
    ):
        given, joint = " ".join(inherited), f"{limited} {wide}"
        for text in (
            model_of(kind, compiler, given, "", joint),
            model_of(kind, compiler, "", given, f'class="c" {joint}'),
        ):
            expected = limits_in_mujoco(text)
            limits = limits_as_read(text)
            seen.add(type(expected))
            if kind == "ball" and isinstance(expected, tuple):
                assert limits == "left out", text
            elif isinstance(expected, tuple):
                assert limits == pytest.approx(expected, abs=1e-12), text
            else:
                assert limits == expected, text
    assert len(seen) == 3  # refused, without limits, and limited


def test_a_range_that_is_not_said_to_limit_is_refused_by_name():
    text = model_of("hinge", COMPILERS[2], "", "", 'name="J" range="-1 2"')
    with pytest.raises(GeometryError, match=r'range of <joint name="J"> .*autolimits'):
        read_mjcf(parse_xml(text.encode()), "model")


@pytest.mark.parametrize(("wide", "is_said"), [("-90 90", True), ("-7 7", False)])
def test_a_range_in_radians_of_more_than_two_turns_is_said(wide, is_said):
    text = model_of("hinge", COMPILERS[1], "", "", f'name="J" range="{wide}"')
    notes = read_mjcf(parse_xml(text.encode()), "model").notes
    assert (
        any("joint J is limited from -90 to 90 rad" in one for one in notes) is is_said
    )
