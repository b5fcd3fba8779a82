"""Where the program `bifurc` begins."""

import os
import sys
import warnings


def _in_one_line(message: Warning | str, *_: object, **__: object) -> str:
    """A warning without the place in the code that it comes from."""
    words = " ".join(str(message).split())
    return f"warning: {words}\n"


def main() -> None:
    """Run the command line; Ctrl-C ends it in one line also while it is imported."""
    # matrices of a hundred rows and fewer: threads of BLAS would only compete
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # figures go to files: no window is opened, whatever the user's other programs open
    os.environ["MPLBACKEND"] = "agg"
    warnings.formatwarning = _in_one_line
    try:
        from bifurc.limits import hear_interrupts

        hear_interrupts()
        from linkages.app.cli import main as command_line
    except KeyboardInterrupt:
        sys.stderr.write("interrupted\n")
        sys.exit(130)  # as `linkages.app.exit_codes.ExitCode.INTERRUPTED`
    command_line()
