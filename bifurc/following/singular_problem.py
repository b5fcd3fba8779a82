"""The equations of a singular point whose place and parameters are unknown."""

from __future__ import annotations

import numpy as np

from bifurc.domain import Domain
from bifurc.equations.differentiation import with_null_vectors
from bifurc.equations.system import ScaledTape
from bifurc.errors import ProblemError
from bifurc.function_problem import EXACT_HESSIAN, NumericalProblem
from bifurc.parametrised import ParametrisedProblem
from bifurc.system import Accuracy


class SingularPointProblem(NumericalProblem):
    """The points at which F_u has a null space of dimension ``nullity``, while the
    parameters p move: F(u, p) = 0, F_u V = 0, in the unknowns u (n,), p (q,) and the
    columns of V (n, nullity).

    It starts from ``u`` (n,) and ``p`` (q,), where the singular values that belong to the
    null space are the smallest ones; `start` (n + q + n nullity,) is that. Works for
    overdetermined equations as long as these agree. Source of the idea: Seydel 1979
    for folds, Beyn 1991 for points of higher corank.
    """

    def __init__(
        self,
        parametrised: ParametrisedProblem,
        u: np.ndarray,
        p: np.ndarray,
        nullity: int,
    ):
        self.parametrised = parametrised
        self.nullity = nullity
        n = parametrised.n
        if not 1 <= nullity <= n:
            raise ProblemError("nullity", nullity, f"from 1 to {n}")
        _, _, right = np.linalg.svd(parametrised.jacobian(u, p))
        basis = right[n - nullity :].T
        self.start = np.concatenate([u, p, basis.T.ravel()])
        tape = with_null_vectors(parametrised.tape, n, basis)
        self.domain = _domain(parametrised, n * nullity)
        self.accuracy = Accuracy(
            derivatives="recorded",
            equations=f"recorded ({tape.size} operations)",
            hessian_error=EXACT_HESSIAN,
        )
        sizes = np.linalg.svd(tape.compiled.jacobians(self.start[None])[0])[1]
        self.magnitude = float(sizes.max())
        self.compiled = ScaledTape(tape, self.magnitude, self.domain)

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """The equations (k, m) at points (k, n)."""
        assert self.compiled is not None
        return self.compiled.residuals(points)

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """Their derivatives (k, m, n) at points (k, n)."""
        assert self.compiled is not None
        return self.compiled.jacobians(points)


def _domain(parametrised: ParametrisedProblem, entries: int) -> Domain:
    """The unknowns of the point: those of the equations, the parameters, and the
    ``entries`` of V."""
    domain, parameters = parametrised.domain, parametrised.parameters
    names = tuple(f"v{k + 1}" for k in range(entries))
    endless = np.full((entries, 2), [-np.inf, np.inf])
    return Domain(
        names=(*domain.names, *parameters.names, *names),
        units=(*domain.units, *parameters.units, *[""] * entries),
        periods=np.concatenate(
            [domain.periods, parameters.periods, np.full(entries, np.inf)]
        ),
        bounds=np.concatenate([domain.bounds, parameters.bounds, endless]),
        scale=domain.scale,
    )
