"""Where the program `bifurc` begins."""

import os
import sys


def main() -> None:
    """Run the command line; Ctrl-C ends it in one line also while it is imported."""
    # matrices of a hundred rows and fewer: threads of BLAS would only compete
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        from linkages.app.cli import main as command_line
    except KeyboardInterrupt:
        sys.stderr.write("interrupted\n")
        sys.exit(130)  # as `linkages.app.exit_codes.ExitCode.INTERRUPTED`
    command_line()
