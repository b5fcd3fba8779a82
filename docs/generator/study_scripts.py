"""The studies as sphinx-gallery reads them: scripts whose docstring begins with a
title."""

from __future__ import annotations

import ast
import re

from docs.generator.places import ROOT

# Studies that the build of the site runs, a few seconds each. The others take minutes,
# or measure times, which belong to a machine: their code and text are shown alone.
RUN = frozenset(
    {
        "first_reconfigurable_bricard",
        "relations_figure",
        "special_double_subtractive_goldberg",
        "special_wohlhart_double_goldberg",
        "wohlhart_double_goldberg",
        "zero_offset_line_symmetric_bricard",
    }
)
MAIN = 'if __name__ == "__main__":\n    main()\n'
NOT_RUN = ".. note:: The build of these pages does not run this study."
HEADER = """Studies
=======

A study is a script in ``studies/`` that reads like the section of the paper that it
reproduces, or that puts a claim of this project to the test. Those with a picture here
were run when these pages were built. Of the others text and code are shown: they take
minutes, or measure times.
"""


def study_names() -> list[str]:
    """The modules of ``studies`` that are commands, those that are run first."""
    names = [
        path.stem
        for path in sorted((ROOT / "studies").glob("*.py"))
        if '__name__ == "__main__"' in path.read_text(encoding="utf-8")
    ]
    return sorted(names, key=study_order)


def study_order(script: str) -> tuple[bool, str]:
    """The key by which the gallery sorts its scripts: those that are run first."""
    name = script.removesuffix(".py")
    return name not in RUN, name


def gallery_script(name: str) -> str:
    """The script of a study for the gallery."""
    text = (ROOT / "studies" / f"{name}.py").read_text(encoding="utf-8")
    module = ast.parse(text)
    docstring = ast.get_docstring(module)
    if docstring is None:
        raise ValueError(f"studies/{name}.py has no docstring")
    end = module.body[0].end_lineno or 0
    code = "".join(text.splitlines(keepends=True)[end:]).lstrip("\n")
    if name in RUN:
        code = _with_result(name, code)
    return f'r"""\n{_restructured(name, docstring)}\n"""\n\n{code}'


def _with_result(name: str, code: str) -> str:
    """The code with a call of the study that the gallery can make: in its process."""
    if MAIN not in code:
        raise ValueError(f"studies/{name}.py does not end as a study does")
    call = f'main(["--out", "out/{name}"], standalone_mode=False)\n'
    return code.replace(MAIN, f"# %%\n# What comes out\n# ^^^^^^^^^^^^^^\n{call}")


def _restructured(name: str, docstring: str) -> str:
    """The docstring in reStructuredText, with its first sentence as the title."""
    first, *rest = docstring.split("\n\n")
    title, colon, more = " ".join(first.split()).rstrip(".").partition(": ")
    subject = f"{more[0].upper()}{more[1:]}." if colon else ""
    command = f"Command: ``python -m studies.{name}``"
    paragraphs = [_escaped(subject), *(_paragraph(part) for part in rest), command]
    if name not in RUN:
        paragraphs.append(NOT_RUN)
    body = "\n\n".join(part for part in paragraphs if part)
    return f"{_escaped(title)}\n{'=' * len(_escaped(title))}\n\n{body}"


def _paragraph(text: str) -> str:
    """A paragraph; what is indented is shown as it stands."""
    if all(line.startswith("    ") for line in text.splitlines()):
        return f"::\n\n{text}"
    return _escaped(text)


def _escaped(text: str) -> str:
    """Text in which stars, bars and underlines mean nothing, but for what stands in
    backticks, which is code."""
    parts = re.split(r"(`+[^`]+`+)", text)
    for i, part in enumerate(parts):
        if i % 2:
            parts[i] = f"``{part.strip('`')}``"
        else:
            parts[i] = re.sub(r"([*|_])", r"\\\1", part)
    return "".join(parts)
