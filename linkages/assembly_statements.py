"""What a statement of completeness says of isolated assemblies."""

from __future__ import annotations

from bifurc.search.completeness import IN_DOUBT

ALL_FOLLOWED = (
    "no isolated assembly of full rank is missing: the 16 paths that lead to all of "
    "them were followed"
)
ALL_BUILT = (
    "dyads build all configurations: there is no motion, and no assembly is missing"
)
MISSING_ASSEMBLIES = "isolated assemblies may be missing"
RANDOM_ASSEMBLIES = "isolated assemblies are those that random starts reached"


def has_all_assemblies(statement: str) -> bool:
    """Whether a statement of completeness says that no isolated assembly is missing."""
    is_said = ALL_FOLLOWED in statement or ALL_BUILT in statement
    return is_said and not statement.startswith(IN_DOUBT)
