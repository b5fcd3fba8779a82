"""Maps that several tests look at: each is made once a process, and no test changes
one."""

from dataclasses import fields
from functools import cache

from bifurc.atlas import Atlas
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from linkages.closure.loop_closure import LoopClosure
from linkages.entry import Linkage
from linkages.linkage import load
from linkages.loop import Loop
from linkages.mapping import map_linkage
from linkages.mechanisms.mechanism import Mechanism

DEFAULT = SearchSettings()


def map_of(
    subject: str | Linkage | Loop | Mechanism,
    *,
    settings: SearchSettings = DEFAULT,
    seed: int = 0,
) -> Atlas:
    """The map, with names of forms, of a subject or of what has this name."""
    if isinstance(subject, str):
        subject = _named(subject)
    return _map(subject, _besides(subject), settings, seed)


def curves_of(
    loop: Loop, *, settings: SearchSettings = DEFAULT, seed: int = 0
) -> Atlas:
    """What `explore` finds of a loop, without names of forms."""
    return _curves(loop, _besides(loop), settings, seed)


def _besides(subject: Linkage | Loop | Mechanism) -> tuple[str, ...]:
    """What tells equal subjects apart: how they are called, and how exactly they are
    given."""
    others = [field.name for field in fields(subject) if not field.compare]
    return tuple(repr(getattr(subject, name)) for name in others)


@cache
def _named(name: str) -> Linkage | Mechanism:
    return load(name)


@cache
def _map(
    subject: Linkage | Loop | Mechanism,
    besides: tuple[str, ...],
    settings: SearchSettings,
    seed: int,
) -> Atlas:
    return map_linkage(subject, settings=settings, seed=seed)


@cache
def _curves(
    loop: Loop, besides: tuple[str, ...], settings: SearchSettings, seed: int
) -> Atlas:
    return explore(LoopClosure(loop), settings=settings, seed=seed)
