"""Plain values as JSON text, and back."""

from __future__ import annotations

import numpy as np
import pytest

from bifurc.files.json_values import from_text, mapping_from_text, to_text


def test_text_keeps_types_and_every_digit(difference) -> None:
    value = {
        "a": (1, 2.5, [True, None]),
        "b": np.array([[0.1, np.inf]]),
        3: np.int64(4),
        "nan": np.array(["x", "yz"]),
        "__kind__": {"deep": (np.float64(0.1),)},
        "empty": np.empty((0, 3)),
    }
    assert difference(from_text(to_text(value)), value) == ""


def test_text_refuses_what_it_cannot_give_back() -> None:
    with pytest.raises(TypeError, match="type set cannot be stored"):
        to_text({"a": {1, 2}})


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        '{"__kind__": "tuple"}',
        '{"__kind__": "tuple", "value": 3}',
        '{"__kind__": "set", "value": []}',
        '{"__kind__": "scalar", "dtype": "<x9", "value": 1}',
        '{"__kind__": "scalar", "dtype": 5, "value": 1}',
        '{"__kind__": "array", "dtype": "<f8", "shape": [3], "value": [1]}',
        '{"__kind__": "array", "dtype": "<f8", "shape": "x", "value": [1]}',
        '{"__kind__": "array", "dtype": "|i1", "shape": [1], "value": [1000]}',
        '{"__kind__": "mapping", "value": [1]}',
        '{"__kind__": "mapping", "value": [[[1], 1]]}',
        "[" * 100_000,
    ],
)
def test_text_that_was_not_written_by_it_is_refused(text: str) -> None:
    with pytest.raises(ValueError):
        from_text(text)


def test_a_mapping_is_expected_where_one_was_stored() -> None:
    assert mapping_from_text(to_text({"a": 1})) == {"a": 1}
    with pytest.raises(ValueError, match="no text of a stored mapping"):
        mapping_from_text(to_text([1]))
