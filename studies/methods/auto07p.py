"""AUTO-07p (Doedel and others), where its object files and a Fortran compiler are
installed.

The equations stand in auto07p.f90, with derivatives; they are compiled once, linked
with AUTO's objects as its own makefile does, and run in a folder of their own.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from linkages import LoopClosure
from studies.methods.cases import Case
from studies.methods.curve import Curve, MethodFailure, through_points
from studies.methods.linear import mixtures
from studies.methods.point_by_point import LONGEST, turn_per_step

DEBIAN = "/usr/lib/auto-07p"
KINDS = {"loop": 1, "circle": 2, "pitchfork": 3, "bratu": 4, "other": 5}
NO_EQUATIONS = "subroutine other_equations\nend subroutine\n"
CONSTANTS = """\
NDIM={ndim}, IPS=0, IRS=0, ICP=[1], NPAR=1
ILP=0, ISP=0, ISW=1, IPLT=0
NTST=1, NCOL=4, IAD=0, NBC=0, NINT=0
NMX={most}, RL0=-1e300, RL1=1e300, A0=-1e300, A1=1e300, NPR=0, MXBF=0, IID=0
ITMX=8, ITNW=5, NWTN=3, JAC=1, EPSL={enough}, EPSU={enough}, EPSS=1e-4
DS={ds}, DSMIN=1e-9, DSMAX={longest}, IADS=1
"""


def has_auto() -> bool:
    """Whether AUTO's object files (below AUTO_DIR, or where Debian puts them) and
    gfortran are there."""
    return bool(_objects()) and shutil.which("gfortran") is not None


def _objects() -> list[Path]:
    return sorted((Path(os.environ.get("AUTO_DIR", DEBIAN)) / "lib").glob("*.o"))


@cache
def _program(equations: str) -> tuple[Path, TemporaryDirectory[str]]:
    """AUTO with the equations, further ``equations`` among them, and the folder it is
    in, which is removed with the process."""
    folder = TemporaryDirectory(prefix="auto07p-")
    program = Path(folder.name) / "follow"
    source = Path(__file__).with_suffix(".f90")
    further = Path(folder.name) / "equations.f90"
    further.write_text(equations, encoding="ascii")
    files = [str(path) for path in (source, further, *_objects())]
    options = ["-O2", "-fopenmp", "-ffree-line-length-none"]
    options += ["-J", folder.name, "-o", str(program)]
    command = ["gfortran", *options, *files]
    subprocess.run(command, check=True, capture_output=True)
    return program, folder


def auto_07p(case: Case, tolerance: float) -> Curve:
    """Continuation of an algebraic system (IPS = 0) by AUTO, without detection, and a
    cubic spline through its points.

    It takes square systems alone: redundant equations are mixed as for pycont-lite. Its
    parameter is the unknown that changes fastest at the start. AUTO adapts its step to
    the number of corrections alone: the longest step is that of the other methods, and
    it shortens steps that need more than two corrections. As a correction is about the
    square of the one before, a limit for the last one above the tolerance is enough.

    ``seconds`` is the processor time of AUTO as it takes it itself, from reading the
    problem to the last point: without compiling, starting the program and reading the
    points, which are written in full precision and not as decimals.
    """
    program, _ = _program(case.fortran or NO_EQUATIONS)
    problem, n = case.problem, case.problem.n
    parameter = int(np.argmax(np.abs(case.tangent)))
    h = LONGEST * turn_per_step(tolerance) * problem.domain.scale
    enough = max(0.1 * tolerance, 1e-13)
    constants = CONSTANTS.format(
        ndim=n - 1,
        most=int(50 * case.length / h) + 1000,
        longest=h,
        enough=max(enough, 1e-3 * np.sqrt(enough)),
        ds=0.1 * h * np.sign(case.tangent[parameter]),
    )
    with TemporaryDirectory(prefix="auto07p-") as folder:
        data = _problem_data(case, parameter)
        Path(folder, "problem.dat").write_text(data, encoding="ascii")
        run = subprocess.run(
            [program],
            cwd=folder,
            input=constants.encode(),
            capture_output=True,
            check=False,
            env={**os.environ, "OMP_NUM_THREADS": "1"},
        )
        if not Path(folder, "points.bin").exists():
            output = run.stdout.decode()[-500:]
            raise RuntimeError(f"AUTO-07p does not begin: {output}")
        numbers = np.fromfile(Path(folder, "points.bin"))
    if len(numbers) % n != 1:  # the time comes last
        raise MethodFailure("it stops before the end of the curve")
    points = numbers[:-1].reshape(-1, n)
    return through_points(list(points), case.length, float(numbers[-1]))


def _problem_data(case: Case, parameter: int) -> str:
    """What auto07p.f90 reads: numbers with 17 digits."""
    problem = case.problem
    n = problem.n
    rows = len(problem.residuals(case.start[None])[0])
    is_loop = isinstance(problem, LoopClosure)
    named = "other" if case.fortran else case.name.partition("-")[0]
    kind = KINDS["loop" if is_loop else named]
    mixed = mixtures(rows, n - 1) if rows != n - 1 else np.empty((0, rows))
    lines = [np.array([case.length]), case.start, *mixed]
    if isinstance(problem, LoopClosure):
        lines += list(problem._geometry)
    numbers = "\n".join(" ".join(f"{x:.17g}" for x in line) for line in lines)
    return f"{kind} {rows} {n} {parameter + 1} {len(mixed)}\n{numbers}\n"
