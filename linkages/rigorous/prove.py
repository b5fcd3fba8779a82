"""From an atlas of a loop to a certificate: centres, boxes and radii for which what
`linkages.rigorous.check` checks does hold.

Nothing is proved here. Every box and every sphere is tried with the functions of the
check, made smaller where it does not hold, and left open where none does.
"""

from __future__ import annotations

import json
from bisect import bisect
from typing import Any

import mpmath
from flint import ctx

from bifurc.atlas import Atlas
from bifurc.singular.point import Kind
from linkages.loop import Loop
from linkages.rigorous import check
from linkages.rigorous.check import DoesNotHold
from linkages.rigorous.courses import Pass, course_of
from linkages.rigorous.motions import NOT_LOOKED_FOR, proved_motions
from linkages.rigorous.spheres import claim, counted_half_branches, enclosed_point
from linkages.rigorous.tubes import Cover, cover

PRECISION = 128  # bits
DIGITS = 42  # of the numbers of a table
GEOMETRY = 1e-38  # how far off they may be, relative
WITHIN_SPHERE = 0.7  # of its radius: there tubes begin and end
OPEN_GAP = 1e-2  # arclength: so near a singular point that is not proved they end


def exact_text(value: Any) -> str:
    """A number of a table as the ball that holds it: whole numbers and doubles are
    exact, those in mpmath are known to more than `DIGITS` digits."""
    if value == int(value):
        return str(int(value))
    if isinstance(value, mpmath.mpf):
        error = GEOMETRY * abs(float(value))
        return f"[{mpmath.nstr(value, DIGITS)} +/- {error:.1e}]"
    return float(value).hex()


def make_certificate(loop: Loop, atlas: Atlas, with_motions: bool = True) -> check.Json:
    """The certificate of the map of a loop, in which "open" says what is not proved;
    ``with_motions``, also that these are all motions, if that is so.

    ``loop`` is the table in numbers of any kind, of which ``atlas`` is the map. What is
    left when the time is over counts as open.
    """
    columns = ("lengths", "twists", "offsets")
    geometry: check.Json = {
        key: [exact_text(one) for one in getattr(loop, key)] for key in columns
    }
    geometry["scale"] = float(loop.characteristic_length).hex()
    with ctx.workprec(PRECISION):
        prover = _Prover(check.Loop(geometry), atlas)
        prover.run()
        return {
            "format": check.FORMAT,
            "name": loop.name,
            "precision": PRECISION,
            "geometry": geometry,
            "claims": prover.claims,
            "curves": prover.curves,
            "tubes": prover.tubes,
            "points": prover.points,
            "motions": prover.motions if with_motions else NOT_LOOKED_FOR,
            "open": prover.open,
        }


def certificate_bytes(content: check.Json) -> bytes:
    """What stands in the file of a certificate, before it is compressed."""
    return json.dumps(content, separators=(",", ":")).encode("utf-8")


class _Prover:
    """Fills ``tubes``, ``points`` and what is ``open`` of a certificate."""

    def __init__(self, loop: check.Loop, atlas: Atlas):
        self.loop = loop
        self.courses = [course_of(atlas, number) for number in range(len(atlas.forms))]
        self.tubes: list[check.Json] = []
        self.covers: list[Cover] = []
        self.points: list[check.Json] = []
        self.open: list[str] = []
        self.atlas = atlas
        self.places: dict[int, int] = {}  # of points of the atlas among the ``points``

    def run(self) -> None:
        """Enclose the singular points, cover the forms from one to the next, and join
        both."""
        for number in range(len(self.atlas.points)):
            self._prove_point(number)
        for number in range(len(self.courses)):
            self._cover_course(number)
        for point in self.points:
            self._attach(point)
        if self.atlas.surfaces:
            self.open.append("components of more than one dimension")

    @property
    def curves(self) -> list[check.Json]:
        """The curves with the pieces that are used."""
        used: list[set[int]] = [set() for _ in self.courses]
        for tube in self.tubes:
            used[tube["curve"]] |= {box[0] for box in tube["boxes"]}
        for point in self.points:
            for one in point["half_branches"]:
                used[one["curve"]].add(one["piece"])
        pairs = zip(self.courses, used, strict=True)
        return [course.values(pieces) for course, pieces in pairs]

    @property
    def claims(self) -> check.Json:
        """How far closed configurations are from the curves, and by how much equations
        that are not solved miss, at most."""
        boxes = [box for made in self.covers for box in made.boxes]
        radius = check.largest([box.distance for box in boxes])
        misses = check.largest([box.misses for box in boxes])
        return {"radius": claim(radius), "misses": claim(misses)}

    @property
    def motions(self) -> check.Json:
        """What is proved of all motions, or why nothing is."""
        if self.open:
            return "it rests on what is open"
        boxes = [box for made in self.covers for box in made.boxes]
        spheres = [
            (check.numbers(point["centre"]), check.number(point["sphere"]))
            for point in self.points
        ]
        return proved_motions(self.loop, boxes, spheres)

    def _prove_point(self, number: int) -> None:
        """Put a singular point of the atlas into the certificate, with its sphere, if both
        hold."""
        meeting = self.atlas.points[number]
        passes = [
            (index, course, one)
            for index, course in enumerate(self.courses)
            for one in course.passes
            if one.point == number
        ]
        if meeting.kind not in (Kind.BIFURCATION, Kind.RANK_DROP):
            self.open.append(f"{meeting.name}, {meeting.kind.value}")
            return
        try:
            values = enclosed_point(self.loop, meeting)
            values |= counted_half_branches(self.loop, values, passes)
        except DoesNotHold as reason:
            self.open.append(f"{meeting.name}: {reason}")
            return
        self.places[number] = len(self.points)
        self.points.append(values)

    def _cover_course(self, number: int) -> None:
        """The tubes of a form, one for each of its arcs."""
        course = self.courses[number]
        if not course.passes:
            made = cover(self.loop, course, 0.0, course.branch.length)
            winding = course.branch.winding.tolist()
            turns = check.whole_turns(winding)
            closes = made.boxes and check.do_overlap(
                made.boxes[-1], made.boxes[0], turns
            )
            ends = {"winding": winding} if closes else {"ends": [None, None]}
            if made.reached == course.branch.length and not closes:
                self.open.append(f"{course.name}: its ends do not overlap")
            self._add(number, made, course.branch.length, ends)
            return
        for begin, end in zip(course.passes, course.passes[1:], strict=False):
            first = begin.s + self._gap(begin)
            last = end.s - self._gap(end)
            made = cover(self.loop, course, first, last)
            ends = {"ends": [self._end(begin), self._end(end)]}
            self._add(number, made, last, ends)

    def _gap(self, one: Pass) -> float:
        """How far from a pass tubes end, in arclength."""
        if one.point not in self.places:
            return OPEN_GAP
        sphere = self.points[self.places[one.point]]["sphere"]
        return WITHIN_SPHERE * float.fromhex(sphere)

    def _end(self, one: Pass) -> check.Json:
        """Inside which sphere a tube ends; None where there is none."""
        if one.point not in self.places:
            return None
        return {"point": self.places[one.point], "turns": one.turns.tolist()}

    def _add(self, number: int, made: Cover, end: float, joints: check.Json) -> None:
        """Add a tube of a form, and what is open of it."""
        course = self.courses[number]
        if made.reached < end:
            self.open.append(
                f"{course.name} from s = {made.reached:.6g} to {end:.6g}: {made.reason}"
            )
            begin = joints["ends"][0] if "ends" in joints else None
            joints = {"ends": [begin, None]}
        if made.boxes:
            self.tubes.append({"curve": number, "boxes": made.values, **joints})
            self.covers.append(made)

    def _attach(self, point: check.Json) -> None:
        """Say of every half-branch in which box of which tube it is."""
        for half_branch in point["half_branches"]:
            s, solution = half_branch.pop("s"), half_branch.pop("solution")
            for k, made in enumerate(self.covers):
                is_there = made.begin < s < made.reached
                if is_there and self.tubes[k]["curve"] == half_branch["curve"]:
                    box = bisect(made.ends, s)
                    if made.boxes[box].holds_inside(solution):
                        half_branch |= {"tube": k, "box": box}
            if "tube" not in half_branch:
                self.open.append(f"where a half-branch of {point['name']} goes on")
