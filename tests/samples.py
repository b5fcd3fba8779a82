"""Samples of long lists of cases."""

from collections.abc import Callable, Iterable
from typing import Any

import pytest


def one_in(count: int, values: Iterable[Any], name: Callable[[Any], str] = str) -> list:
    """The ``values`` as parameters of a test, of which `make test` takes one in
    ``count``, from the first on, and `make test-exhaustive` the others."""
    parameters = []
    for number, value in enumerate(values):
        marks = [pytest.mark.exhaustive] if number % count else []
        parameters.append(pytest.param(value, id=name(value), marks=marks))
    return parameters
