"""Numbers and nouns agree: "1 form", never "1 forms"."""

import re
from pathlib import Path

SOURCES = Path(__file__).parents[1] / "linkages"
NOUNS = (
    "assemblies|bifurcations|bodies|components|copies|curves|forms|legs|members|points|"
    "solutions|surfaces"
)
# a field of an f-string, no constant, before a noun in the plural
FIELD = re.compile(rf'f["\'].*\{{[^{{}}A-Z"\']*\}} (?:[a-z]+ )?(?:{NOUNS})\b')


def test_what_is_counted_is_printed_by_one_function():
    lines = [
        f"{path.relative_to(SOURCES)}:{number}: {line.strip()}"
        for path in sorted(SOURCES.rglob("*.py"))
        for number, line in enumerate(path.read_text("utf-8").splitlines(), start=1)
        if "} " in line and FIELD.search(line)  # most lines have no field
    ]
    assert lines == []
