"""The parts that are printed: closed, apart from each other, on the axes of the loop.

Solids are compared by the kernel that made them, files by another program.
"""

from itertools import combinations, pairwise

import numpy as np
import pytest

from linkages.linkage import load
from linkages.printing.assembly import Assembly, Dimensions, Kind, Part, Seats
from linkages.printing.seating import choose_seats

build123d = pytest.importorskip("build123d", reason="solids need the extra 'cad'")
trimesh = pytest.importorskip("trimesh", reason="it opens the parts again")

from linkages.printing.solids import (  # noqa: E402  # noqa: E402
    link_poses_at,
    make_parts,
    place_solid,
    write_step,
    write_stl,
)
from tests.maps import map_of  # noqa: E402

DSG = "special-double-subtractive-goldberg"
FORMS = {"bennett": "Bennett form", DSG: "Form I (constructive 6R)"}
NOTHING = 1e-9  # mm^3


class Printed:
    """A linkage, the form along which its parts keep apart, and the parts."""

    def __init__(self, name):
        atlas = map_of(load(name))
        self.form = atlas.forms[atlas.form(FORMS[name])]
        loop = load(name).loop
        self.loop = loop.scaled(100 / loop.characteristic_length)
        dimensions = Dimensions(6.0, 0.3, 1.2)
        random = np.random.default_rng(0)
        self.seating = choose_seats(self.loop, dimensions, [self.form], random)
        self.assembly = self.seating.assembly
        self.parts = make_parts(self.assembly)


@pytest.fixture(scope="module", params=FORMS)
def printed(request):
    return Printed(request.param)


def placed_parts(assembly, parts, theta):
    """All solids in a configuration, by their names."""
    links, hinges = link_poses_at(assembly, theta)
    solids = {}
    for i in range(assembly.loop.n):
        solids[f"link {i}"] = place_solid(parts.links[i], links[i])
        solids[f"pin {i}"] = place_solid(parts.pin, hinges[i])
        solids[f"cap {i}"] = place_solid(parts.cap, hinges[i])
    return solids


def interferences(solids):
    """Pairs of solids that share more than nothing, with the volume, mm^3."""
    shared = {}
    boxes = {name: solid.bounding_box(optimal=False) for name, solid in solids.items()}
    for first, second in combinations(solids, 2):
        if are_apart(boxes[first], boxes[second]):
            continue
        common = solids[first].intersect(solids[second])
        volume = sum(solid.volume for solid in common or [])
        if volume > NOTHING:
            shared[first, second] = volume
    return shared


def are_apart(first, second):
    low = [np.array(tuple(box.min)) for box in (first, second)]
    high = [np.array(tuple(box.max)) for box in (first, second)]
    return np.any(low[0] > high[1]) or np.any(low[1] > high[0])


def test_no_parts_meet_where_the_form_begins_on_the_way_and_where_they_are_nearest(
    printed,
):
    assert printed.seating.is_apart
    nearest = printed.seating.nearest.s
    for s in (0.0, 0.37 * printed.form.branch.length, nearest):
        theta = printed.form.branch(s)
        solids = placed_parts(printed.assembly, printed.parts, theta)
        assert interferences(solids) == {}


def test_segments_with_their_radii_enclose_the_solids_and_not_much_more(printed):
    """Links that share no joint: rods are 0.15 mm thinner than the balls at corners, on
    either side."""
    theta = printed.seating.nearest.theta
    assembly, n = printed.assembly, printed.loop.n
    solids = placed_parts(assembly, printed.parts, theta)
    placed = assembly.placed(theta[None])
    clearances = assembly.clearances(placed, assembly.pairs)[0]
    parts = [[assembly.part(m) for m in pair] for pair in assembly.pairs]
    first, second = 0, 2
    enclosed = least_between(parts, clearances, bodies(first, n), bodies(second, n))
    rods = least_between(parts, clearances, bodies(first, n)[:1], bodies(second, n)[:1])
    distance = solids[f"link {first}"].distance_to(solids[f"link {second}"])
    assert enclosed - 1e-6 <= distance <= rods + 0.301


def bodies(link, n):
    """A link, and the hinges that its eyes are in."""
    ends = [Part(Kind.HINGE, link), Part(Kind.HINGE, (link + 1) % n)]
    return [Part(Kind.LINK, link), *ends]


def least_between(parts, clearances, some, others):
    """The least clearance between any of some parts and any of others."""
    seen = []
    for (first, second), clearance in zip(parts, clearances, strict=True):
        if (first in some and second in others) or (first in others and second in some):
            seen.append(clearance)
    return min(seen)


def test_the_bores_of_both_links_and_the_pin_are_on_the_axes_of_the_loop(printed):
    theta = printed.form.branch(0.41 * printed.form.branch.length)
    solids = placed_parts(printed.assembly, printed.parts, theta)
    screws = printed.loop.joint_screws(theta)
    n = printed.loop.n
    dimensions = printed.assembly.dimensions
    for joint in range(n):
        turning = [f"link {joint}", f"link {(joint - 1) % n}", f"cap {joint}"]
        wanted = [dimensions.bore_radius] * 2 + [dimensions.cap_bore_radius]
        turning.append(f"pin {joint}")
        wanted.append(dimensions.pin_radius)
        for name, radius in zip(turning, wanted, strict=True):
            distances = [
                axis_distance(axis, screws[:, joint])
                for axis in cylinder_axes(solids[name], radius)
            ]
            assert min(distances) < 1e-6, name


def cylinder_axes(solid, radius):
    """Axes of the cylindrical faces of a radius, as point and direction."""
    axes = []
    for face in solid.faces():
        is_cylinder = face.geom_type == build123d.GeomType.CYLINDER
        if is_cylinder and abs(face.radius - radius) < 1e-9:
            axis = face.axis_of_rotation
            axes.append(
                (np.array(tuple(axis.position)), np.array(tuple(axis.direction)))
            )
    return axes


def axis_distance(axis, screw):
    """The largest difference of direction, or of moment over 100 mm."""
    point, direction = axis
    direction = direction * np.sign(direction @ screw[:3])
    moment = np.cross(point, direction) - screw[3:]
    return max(np.abs(direction - screw[:3]).max(), np.abs(moment).max() / 100)


def test_the_laid_out_parts_are_closed_stand_on_the_plate_and_are_apart(
    printed, tmp_path
):
    path = tmp_path / "parts.stl"
    write_stl(printed.parts, path)
    bodies = trimesh.load(path).split(only_watertight=False)
    n = printed.loop.n
    assert len(bodies) == 3 * n
    assert all(body.is_watertight for body in bodies)
    assert all(body.is_winding_consistent for body in bodies)
    solids = [*printed.parts.links, *[printed.parts.pin] * n, *[printed.parts.cap] * n]
    volumes = sorted(solid.volume for solid in solids)
    assert min(volumes) > 0
    assert sorted(body.volume for body in bodies) == pytest.approx(volumes, rel=0.02)
    for body in bodies:
        assert body.bounds[0, 2] == pytest.approx(0, abs=0.02)  # facets
    boxes = sorted((body.bounds[:, :2] for body in bodies), key=lambda b: tuple(b[0]))
    for first, second in combinations(boxes, 2):
        assert np.any(first[0] > second[1] + 1) or np.any(second[0] > first[1] + 1)


def test_the_assembly_is_read_again_with_its_names_in_the_first_configuration(
    printed, tmp_path
):
    path = tmp_path / "assembly.step"
    n = printed.loop.n
    names = [f"link {i}" for i in range(n)]
    theta = printed.form.branch(0.0)
    write_step(printed.assembly, printed.parts, theta, names, "a linkage", path)
    again = build123d.import_step(path)
    expected = placed_parts(printed.assembly, printed.parts, theta)
    assert len(again.children) == 3 * n
    for part, (name, solid) in zip(again.children, expected.items(), strict=True):
        label = part.label.replace("_", " ")  # a habit of the reader
        assert label == (name if name.startswith("link") else name.split()[0])
        assert part.volume == pytest.approx(solid.volume, rel=1e-6)
        assert tuple(part.center()) == pytest.approx(tuple(solid.center()), abs=1e-3)
    assert "2000-01-01T00:00:00" in path.read_text()  # no time of day


def test_solids_of_parts_that_are_said_to_meet_do():
    linkage = load("bennett")
    form = map_of(linkage).forms[0]
    loop = linkage.loop.scaled(100 / linkage.loop.characteristic_length)
    seats = Seats(np.zeros(4), np.ones(4))
    assembly = Assembly(loop, Dimensions(6.0, 0.3, 1.2), seats)
    theta = form.branch(np.radians(593.043))
    solids = placed_parts(assembly, make_parts(assembly), theta)
    assert ("link 0", "link 2") in interferences(solids)


@pytest.mark.parametrize("sizes", [(2.4, 0.3, 1.2), (20.0, 1.5, 2.0)])
def test_solids_are_closed_with_thin_and_thick_rods(sizes):
    loop = load("bennett").loop
    scaled = loop.scaled(100 / loop.characteristic_length)
    seats = Seats(np.array([20.0, -12, 25, -23]), np.array([1.0, 1, -1, 1]))
    parts = make_parts(Assembly(scaled, Dimensions(*sizes), seats))
    for solid in (*parts.links, parts.pin, parts.cap):
        assert solid.is_valid
        assert solid.volume > 0
    for first, second in pairwise(parts.links):
        assert first.volume != second.volume
