"""What all studies have in common as commands: errors in one line, and a sign of life."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

import click

from bifurc import BifurcError
from linkages.app.output import saying_progress


class Study(click.Command):
    """A study: it says on standard error from time to time for how long it has been at
    work, as commands do; an error of the packages and a package that is not installed end it with one
    line."""

    def invoke(self, ctx: click.Context) -> object:
        """Run the study."""
        try:
            with saying_progress():
                return super().invoke(ctx)
        except BifurcError as error:
            raise click.ClickException(" ".join(str(error).split())) from None
        except ModuleNotFoundError as error:
            name = (error.name or "").partition(".")[0]
            message = f"{name} is not installed; pip install {name}"
            raise click.ClickException(message) from None


def require_known(option: str, names: Iterable[str], known: Iterable[str]) -> None:
    """Raise `click.BadParameter` for a name that is not one of those that are known."""
    allowed = list(dict.fromkeys(known))
    for name in names:
        if name in allowed:
            continue
        nearest = difflib.get_close_matches(name, allowed, 3, 0.4) or allowed[:8]
        raise click.BadParameter(
            f"there is no {name!r}; there is {', '.join(nearest)}",
            param_hint=option,
        )
