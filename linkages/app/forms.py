"""The forms that a command line names."""

from __future__ import annotations

from bifurc.atlas import Atlas, Form
from linkages.app.exit_codes import CommandError, ExitCode
from linkages.app.verdict import judge

__all__ = ["choose_form", "listed_forms", "require_forms"]


def listed_forms(atlas: Atlas) -> list[Form]:
    """The forms in the order in which the summary lists them."""
    return sorted(atlas.forms, key=lambda form: form.name)


def choose_form(atlas: Atlas, text: str) -> Form:
    """The form called ``text``, in full or by an unambiguous part, or of that number
    from 1 in the summary. Raises `RouteError` for another name and `CommandError` for
    another number."""
    if not text.isdecimal():
        return atlas.forms[atlas.form(text)]
    forms = listed_forms(atlas)
    number = int(text)
    if not 1 <= number <= len(forms):
        raise CommandError(
            f"--form {text}: it must be a name, or a number from 1 to {len(forms)}"
        )
    return forms[number - 1]


def require_forms(atlas: Atlas) -> None:
    """Raise `CommandError` unless there are forms to move along."""
    if atlas.forms:
        return
    verdict = judge(atlas)
    if verdict.code is not ExitCode.DONE:
        raise CommandError(verdict.sentence, verdict.code)
    raise CommandError(f"{verdict.sentence} It has no form of mobility 1.")
