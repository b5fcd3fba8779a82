"""Prints what an extra of pyproject.toml needs, the program's own needs included, one
requirement a line: `python .ci/requirements.py test`."""

import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

PROJECT = tomllib.loads(Path("pyproject.toml").read_text())["project"]


def needs_of(extra: str) -> Iterator[str]:
    """The requirements of the extra and of those that it names."""
    for requirement in PROJECT["optional-dependencies"][extra]:
        others = re.fullmatch(rf"{PROJECT['name']}\[(.*)\]", requirement)
        if others is None:
            yield requirement
        else:
            for name in others[1].split(","):
                yield from needs_of(name.strip())


print(*PROJECT["dependencies"], *needs_of(sys.argv[1]), sep="\n")
