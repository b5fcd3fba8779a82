"""The forms that a command line names."""

from __future__ import annotations

from collections.abc import Sequence

from bifurc.atlas import Atlas, Form
from bifurc.errors import RouteError
from bifurc.form_order import listed_numbers
from linkages.app.answer.verdict import judge
from linkages.app.exit_codes import CommandError, ExitCode


def listed_forms(atlas: Atlas) -> list[Form]:
    """The forms in the order in which the summary lists them."""
    return [atlas.forms[number] for number in listed_numbers(atlas)]


def choose_forms(atlas: Atlas, texts: Sequence[str]) -> list[Form]:
    """The forms that ``texts`` name, each as in `choose_form`; all where there are no
    texts. Raises `CommandError` for one that is named twice."""
    chosen: list[Form] = []
    for text in texts:
        form = choose_form(atlas, text)
        if form in chosen:
            raise CommandError(
                f"--form {text}: {form.name!r} is named already, and may be only once"
            )
        chosen.append(form)
    return chosen if texts else listed_forms(atlas)


def choose_form(atlas: Atlas, text: str) -> Form:
    """The form called ``text``, in full or by an unambiguous part, or of that number
    from 1 in the summary. Raises `CommandError` for another name or number."""
    forms = listed_forms(atlas)
    if not text.isdecimal():
        try:
            return atlas.forms[atlas.form(text)]
        except RouteError as error:
            raise CommandError(f"--form: {error}") from None
    numbered = {str(k): form for k, form in enumerate(forms, 1)}
    if text not in numbered:
        raise CommandError(
            f"--form {text}: it must be a name, or a number from 1 to {len(forms)}"
        )
    return numbered[text]


def require_forms(
    atlas: Atlas, use: str = "; joints of a mechanism are held with --lock."
) -> None:
    """Raise `CommandError` unless there are forms for the ``use`` that it says."""
    if atlas.forms:
        return
    verdict = judge(atlas)
    if verdict.code is not ExitCode.DONE:
        raise CommandError(verdict.sentence, verdict.code)
    raise CommandError(f"{verdict.sentence} It has no form of mobility 1{use}")
