"""What a component that is a product is made of."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

from bifurc.tables import count_of


class Factor(NamedTuple):
    """What some unknowns of a component do, whatever its others do.

    Those of these numbers, ``unknowns``, run over a curve, a surface, or more, of this
    ``dimension``, which comes back to its start or has no rim where it ``is_closed``.
    The ``size`` is the length of a curve and the area of a surface, None where it is not
    known.
    """

    unknowns: tuple[int, ...]
    dimension: int
    is_closed: bool
    size: float | None

    @property
    def kind(self) -> str:
        """What it is, without its size."""
        course = "closed" if self.is_closed else "open"
        if self.dimension > 2:
            return f"{course} part of dimension {self.dimension}"
        return f"{course} {'curve' if self.dimension == 1 else 'surface'}"


def values_of(
    factors: Sequence[Factor], names: Sequence[str]
) -> list[dict[str, object]]:
    """The factors as values of JSON, with the unknowns by their ``names``."""
    return [
        {
            "unknowns": [names[number] for number in factor.unknowns],
            "dimension": factor.dimension,
            "closed": factor.is_closed,
            "size": factor.size,
        }
        for factor in factors
    ]


def product_of(factors: Sequence[Factor]) -> str:
    """What the product is one of; empty where there are no factors."""
    if not factors:
        return ""
    kinds = Counter(factor.kind for factor in factors)
    counts = []
    for kind, count in sorted(kinds.items()):
        noun, *rest = kind.partition(" of ")
        counts.append(count_of(count, noun) + "".join(rest))
    return f"the product of {' and '.join(counts)}"


def describe_product(factors: Sequence[Factor], names: Sequence[str]) -> str:
    """The factors with the unknowns, which have these ``names``; empty where there are
    none."""
    if not factors:
        return ""
    words = []
    for factor in factors:
        unknowns = ", ".join(names[number] for number in factor.unknowns)
        words.append(f"{factor.kind} of {unknowns}")
    return f"the product of a {'; and of a '.join(words)}"


def words_of_products(components: Sequence[Sequence[Factor]]) -> str:
    """What each of the components, given by its factors, is the product of; empty where
    one of them has none."""
    products = {product_of(factors) for factors in components}
    if not components or "" in products:
        return ""
    each = "each " if len(components) > 1 else ""
    return each + " or ".join(sorted(products))
