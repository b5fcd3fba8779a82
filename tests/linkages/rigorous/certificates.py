"""Certificates of maps that several tests look at: each is made once a process."""

import json
from functools import cache

import mpmath

from linkages.app.choice import choose_precisely
from linkages.entry import Linkage
from linkages.rigorous.check import check_certificate
from linkages.rigorous.prove import certificate_bytes, make_certificate
from tests.maps import map_of

DIGITS = 60


def certificate_of(loop, atlas, with_motions=False):
    """The certificate as it is read from a file."""
    content = make_certificate(loop, atlas, with_motions)
    return json.loads(certificate_bytes(content))


@cache
def named_certificate(name, with_motions=False):
    """That of a linkage of the catalogue, as text: whoever changes it reads it anew."""
    with mpmath.workdps(DIGITS):
        loop = choose_precisely(name)
    return json.dumps(certificate_of(loop, map_of(name), with_motions))


def certificate_of_loop(loop, with_motions=False):
    """That of a table in doubles, which are exact."""
    return certificate_of(loop, map_of(Linkage(loop)), with_motions)


def failures(certificate):
    """The lines of what does not hold, or nothing."""
    lines = []
    holds = check_certificate(certificate, lines.append)
    said = [line for line in lines if "does not hold" in line]
    assert holds is not bool(said)
    return said
