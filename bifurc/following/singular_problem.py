"""The equations of a singular point whose place and parameters are unknown."""

from __future__ import annotations

import numpy as np

from bifurc.domain import Domain
from bifurc.equations.differentiation import with_null_vectors
from bifurc.equations.system import ScaledTape
from bifurc.equations.tape import Tape
from bifurc.errors import ProblemError
from bifurc.function_problem import EXACT_HESSIAN, NumericalProblem
from bifurc.parametrised import ParametrisedProblem
from bifurc.system import Accuracy

BESIDE, PROBES = 0.3, 15  # sizes of the unknowns, points at which F' is looked at


class SingularPointProblem(NumericalProblem):
    """The points at which F_u has a null space of dimension ``nullity``, while the
    parameters p move: F(u, p) = 0, F_u V = 0, in the unknowns u (n,), p (q,) and the
    columns of V (n, nullity).

    It starts from ``u`` (n,) and ``p`` (q,), where the singular values that belong to the
    null space are the smallest ones; `start` (n + q + n nullity,) is that. Inside, u and p
    are counted in ``sizes`` (n + q,), and equations in the size of their derivatives, so
    that nothing depends on units; `place` leads back. Works for overdetermined equations as
    long as these agree. Source of the idea: Seydel 1979 for folds, Beyn 1991 for points of
    higher corank.
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
        self.sizes = parametrised.sizes
        point = np.concatenate([u, p]) / self.sizes
        own = _in_sizes(parametrised.tape, self.sizes, point)
        jacobian = own.compiled.jacobians(point[None])[0]
        _, _, right = np.linalg.svd(jacobian[:, :n])
        basis = right[n - nullity :].T
        self.start = np.concatenate([point, basis.T.ravel()])
        tape = with_null_vectors(own, n, basis)
        self.domain = _domain(parametrised, self.sizes, n * nullity)
        self.accuracy = Accuracy(
            derivatives="recorded",
            equations=f"recorded ({tape.size} operations)",
            hessian_error=EXACT_HESSIAN,
        )
        sigma = np.linalg.svd(tape.compiled.jacobians(self.start[None])[0])[1]
        self.magnitude = float(sigma.max())
        self.compiled = ScaledTape(tape, self.magnitude, self.domain)

    def place(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """u (..., n) and p (..., q) at points (..., n + q + n nullity)."""
        n = self.parametrised.n
        both = points[..., : len(self.sizes)] * self.sizes
        return both[..., :n], both[..., n:]

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """The equations (k, m) at points (k, n)."""
        assert self.compiled is not None
        return self.compiled.residuals(points)

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """Their derivatives (k, m, n) at points (k, n)."""
        assert self.compiled is not None
        return self.compiled.jacobians(points)


def _in_sizes(tape: Tape, sizes: np.ndarray, point: np.ndarray) -> Tape:
    """The equations in unknowns that are counted in ``sizes`` (n,), each over the size of
    its derivatives about a ``point`` (n,) of these: at the point they may vanish."""
    even = tape.in_units(np.zeros(tape.n), sizes, np.ones(tape.m))
    beside = np.random.default_rng(0).uniform(-BESIDE, BESIDE, (PROBES, tape.n))
    with np.errstate(all="ignore"):
        jacobians = even.compiled.jacobians(point + beside)
        slopes = np.nanmedian(np.linalg.norm(jacobians, axis=2), axis=0)
    is_known = np.isfinite(slopes) & (slopes > 0.0)
    weights = np.divide(1.0, slopes, out=np.ones(tape.m), where=is_known)
    return tape.in_units(np.zeros(tape.n), sizes, weights)


def _domain(
    parametrised: ParametrisedProblem, sizes: np.ndarray, entries: int
) -> Domain:
    """The unknowns of the point: those of the equations and the parameters in ``sizes``
    (n + q,), and the ``entries`` of V."""
    domain, parameters = parametrised.domain, parametrised.parameters
    names = tuple(f"v{k + 1}" for k in range(entries))
    endless = np.full((entries, 2), [-np.inf, np.inf])
    bounds = np.concatenate([domain.bounds, parameters.bounds]) / sizes[:, None]
    periods = np.concatenate([domain.periods, parameters.periods]) / sizes
    return Domain(
        names=(*domain.names, *parameters.names, *names),
        units=(*domain.units, *parameters.units, *[""] * entries),
        periods=np.concatenate([periods, np.full(entries, np.inf)]),
        bounds=np.concatenate([bounds, endless]),
    )
