"""The command line `bifurc`: its commands, and what becomes of their errors.

A command is imported when it is called, with the modules that it needs: ``bifurc
--help`` imports click and little else.
"""

from __future__ import annotations

import ast
import difflib
import inspect
import sys
from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType
from typing import Any

import click
from click.exceptions import Exit

from bifurc.errors import BifurcError, OutOfTimeError
from linkages.app import commands
from linkages.app.exit_codes import CommandError, ExitCode, exit_code_table
from linkages.app.output import library_messages, saying_progress

# each in a module of its own
COMMANDS = [
    module.name.removesuffix("_command") for module in iter_modules(commands.__path__)
]
LONGEST = 500  # characters of an error


class Failure(click.ClickException):
    """The end of a command: one line on standard error, and an exit code."""

    def __init__(self, message: str, code: ExitCode):
        super().__init__(in_one_line(message))
        self.code = code

    @property
    def exit_code(self) -> int:  # type: ignore[override]
        """What click ends the program with."""
        return int(self.code)


class Commands(click.Group):
    """The commands, and their errors as one line and an exit code."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """The names of the commands."""
        return COMMANDS

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command of a name, just imported; None where there is none."""
        if cmd_name not in COMMANDS:
            return None
        module = import_module(f"linkages.app.commands.{cmd_name}_command")
        command: click.Command = getattr(module, f"{cmd_name}_command")
        if command.help is None:
            command.help = _help_in_source(module, f"{cmd_name}_command")
        return command

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """What is left of the arguments after the options of the group itself."""
        try:
            return super().parse_args(ctx, args)
        except click.UsageError as error:
            raise _failure_of(error) from None

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """The command that the arguments name; an unknown name is refused with the
        nearest one."""
        name = args[0]
        if self.get_command(ctx, name) is None and not name.startswith("-"):
            raise CommandError(self._unknown(ctx, name))
        return super().resolve_command(ctx, args)

    def make_context(self, *args: Any, **extra: Any) -> click.Context:
        """What the arguments say, of which click would make an abort at Ctrl-C."""
        try:
            return super().make_context(*args, **extra)
        except KeyboardInterrupt:
            click.echo("interrupted", err=True)
            raise Exit(ExitCode.INTERRUPTED) from None

    def invoke(self, ctx: click.Context) -> object:
        """Run the command."""
        try:
            with library_messages(), saying_progress():
                return super().invoke(ctx)
        except BrokenPipeError:  # nobody reads on: click ends without a word
            raise
        except (BifurcError, click.UsageError, OSError) as error:
            raise _failure_of(error) from None
        except KeyboardInterrupt:
            click.echo("interrupted", err=True)
            ctx.exit(ExitCode.INTERRUPTED)

    def _unknown(self, ctx: click.Context, name: str) -> str:
        names = self.list_commands(ctx)
        nearest = difflib.get_close_matches(name, names, n=1)
        hint = f"the nearest is {nearest[0]}" if nearest else "see bifurc --help"
        return f"there is no command {name!r}; {hint}"


def _help_in_source(module: ModuleType, name: str) -> str:
    """The text of the help of the command that a function of a module is, as it stands in
    its source: Python drops texts where it is told to optimize twice."""
    for node in ast.parse(inspect.getsource(module)).body:
        if isinstance(node, ast.FunctionDef) and node.name == name:
            return ast.get_docstring(node) or ""
    return ""


def in_one_line(message: str) -> str:
    """A message in one line of `LONGEST` characters at most, what cannot be printed by
    its number; of a long one the middle is left out, as the beginning says where
    something is wrong and the end what."""
    words = " ".join(message.splitlines())
    shown = "".join(one if one.isprintable() else ascii(one)[1:-1] for one in words)
    if len(shown) <= LONGEST:
        return shown
    half = LONGEST // 2 - 3
    beginning, end = shown[:half], shown[-half:]
    # between words, where there are any
    beginning = beginning.rpartition(" ")[0] or beginning
    end = end.partition(" ")[2] or end
    return f"{beginning} ... {end}"


def _failure_of(error: BifurcError | click.UsageError | OSError) -> Failure:
    """An error as a message and an exit code."""
    if isinstance(error, CommandError):
        return Failure(str(error), error.code)
    if isinstance(error, OutOfTimeError):
        is_interrupted = error.is_interrupted
        code = ExitCode.INTERRUPTED if is_interrupted else ExitCode.NOTHING_KNOWN
        return Failure(str(error), code)
    if isinstance(error, click.UsageError):
        return Failure(_usage(error), ExitCode.BAD_INPUT)
    if isinstance(error, OSError) and error.filename is not None:
        return Failure(f"{error.filename}: {error.strerror}", ExitCode.BAD_INPUT)
    return Failure(str(error), ExitCode.BAD_INPUT)


def _usage(error: click.UsageError) -> str:
    """What is wrong with a command line, and where to read what is right."""
    if error.ctx is None:
        return error.format_message()
    return f"{error.format_message()} (see {error.ctx.command_path} --help)"


@click.group(
    "bifurc",
    cls=Commands,
    invoke_without_command=True,
    epilog=exit_code_table(),
)
@click.version_option(package_name="bifurc")
@click.pass_context
def main(ctx: click.Context) -> None:
    """Transition maps of spatial linkages, and solution curves of any equations.

    \b
    Examples:
      bifurc map special-double-subtractive-goldberg --out out
      bifurc map my_linkage.toml --json
      bifurc solve my_equations.toml --out out
      bifurc route special-double-subtractive-goldberg "Form I" "Bennett 4R"
    """
    if ctx.invoked_subcommand is None:
        click.echo(ctx.get_help())


if main.help is None:
    main.help = _help_in_source(sys.modules[__name__], "main")
