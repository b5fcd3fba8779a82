"""The equations of a singular point whose place and parameters are unknown."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from bifurc.domain import Domain
from bifurc.equations.differentiation import with_null_vectors
from bifurc.equations.system import ScaledTape
from bifurc.equations.tape import Tape
from bifurc.errors import ProblemError
from bifurc.function_problem import EXACT_HESSIAN, NumericalProblem
from bifurc.numerics.corrector import project_by_least_squares
from bifurc.parametrised import ParametrisedProblem
from bifurc.system import NO_SHORTCUTS, Accuracy, Shortcuts

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
        self.weights = _weights(parametrised.tape, self.sizes, point)
        _, _, right = np.linalg.svd(self._slopes(point[None])[0, :, :n])
        self.basis = right[n - nullity :].T
        self.start = np.concatenate([point, self.basis.T.ravel()])
        self.domain = _domain(parametrised, self.sizes, n * nullity)
        self.accuracy = Accuracy(
            derivatives="recorded",
            equations=f"recorded ({parametrised.tape.size} operations)",
            hessian_error=EXACT_HESSIAN,
        )
        self.magnitude = float(np.linalg.norm(self.jacobians(self.start[None])[0], 2))

    @cached_property
    def compiled(self) -> ScaledTape:  # type: ignore[override]
        """The same equations on a tape of their own, by which their curve is traced. To
        write it takes longer than to solve them once."""
        tape = self.parametrised.tape
        own = tape.in_units(np.zeros(tape.n), self.sizes, self.weights)
        whole = with_null_vectors(own, self.parametrised.n, self.basis)
        return ScaledTape(whole, self.magnitude, self.domain)

    @property
    def shortcuts(self) -> Shortcuts:
        """None: these equations are small."""
        return NO_SHORTCUTS

    @property
    def parameters(self) -> slice:
        """Where the parameters stand among the unknowns."""
        return slice(self.parametrised.n, len(self.sizes))

    def place(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """u (..., n) and p (..., q) at points (..., n + q + n nullity)."""
        n = self.parametrised.n
        both = points[..., : len(self.sizes)] * self.sizes
        return both[..., :n], both[..., n:]

    def project(self, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Solutions (k, n) near starts (k, n) and the relative residual (k,) that is
        left at each."""
        return project_by_least_squares(self, starts)

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """The equations (k, m) at points (k, n), in the order of
        `bifurc.equations.differentiation.with_null_vectors`."""
        n, q = self.parametrised.n, self.parametrised.q
        places = points[:, : n + q]
        vectors = points[:, n + q :].reshape(len(points), self.nullity, n)
        values = self.parametrised.tape.compiled.residuals(places * self.sizes)
        changes = np.einsum("kij,kcj->kci", self._slopes(places)[:, :, :n], vectors)
        parts = [values * self.weights, changes.reshape(len(points), -1)]
        for i, one in enumerate(vectors.swapaxes(0, 1)):
            for j, other in enumerate(vectors[:, :i].swapaxes(0, 1)):
                parts.append(np.sum(one * other, axis=1)[:, None])
                turned = other @ self.basis[:, i] - one @ self.basis[:, j]
                parts.append(turned[:, None])
            parts.append(np.sum(one * one, axis=1)[:, None] - 1.0)
        return np.concatenate(parts, axis=1)

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """Their derivatives (k, m, n) at points (k, n)."""
        return np.array([self._jacobian(point) for point in points])

    def _jacobian(self, point: np.ndarray) -> np.ndarray:
        """F' (m, n) at a point (n,)."""
        n, size = self.parametrised.n, len(self.sizes)
        place, vectors = point[:size], point[size:].reshape(self.nullity, n)
        slopes = self._slopes(place[None])[0]
        hessian = self.parametrised.tape.compiled.hessian(place * self.sizes)
        hessian *= self.weights[:, None, None] * np.outer(self.sizes, self.sizes)
        blocks = np.zeros((self.nullity + 1, len(slopes), len(point)))
        blocks[0, :, :size] = slopes
        for block, column, vector in zip(
            blocks[1:], self._columns, vectors, strict=True
        ):
            block[:, :size] = np.einsum("ijl,j->il", hessian[:, :n], vector)
            block[:, column] = slopes[:, :n]
        rows = blocks.reshape(-1, len(point))
        return np.concatenate([rows, self._slopes_of_basis(vectors)])

    def _slopes_of_basis(self, vectors: np.ndarray) -> np.ndarray:
        """The derivatives (k^2, n) of the conditions on null vectors (k, n)."""
        slopes = np.zeros((self.nullity**2, len(self.start)))
        rows = iter(slopes)
        for i, own in enumerate(self._columns):
            for j, other in enumerate(self._columns[:i]):
                row = next(rows)
                row[own], row[other] = vectors[j], vectors[i]
                row = next(rows)
                row[own], row[other] = -self.basis[:, j], self.basis[:, i]
            next(rows)[own] = 2.0 * vectors[i]
        return slopes

    @property
    def _columns(self) -> list[slice]:
        """Where each null vector stands among the unknowns."""
        size, n = len(self.sizes), self.parametrised.n
        return [slice(size + n * c, size + n * (c + 1)) for c in range(self.nullity)]

    def _slopes(self, places: np.ndarray) -> np.ndarray:
        """The derivatives (k, m, n + q) of the weighted equations by the unknowns and
        parameters at places (k, n + q), all in their sizes."""
        jacobians = self.parametrised.tape.compiled.jacobians(places * self.sizes)
        weighted: np.ndarray = jacobians * self.weights[:, None] * self.sizes
        return weighted


def _weights(tape: Tape, sizes: np.ndarray, point: np.ndarray) -> np.ndarray:
    """What equations (m,) in unknowns that are counted in ``sizes`` (n,) are multiplied
    by: 1 over the size of their derivatives about a ``point`` (n,) of these; at the point
    they may vanish."""
    beside = np.random.default_rng(0).uniform(-BESIDE, BESIDE, (PROBES, tape.n))
    with np.errstate(all="ignore"):
        jacobians = tape.compiled.jacobians((point + beside) * sizes) * sizes
        slopes = np.nanmedian(np.linalg.norm(jacobians, axis=2), axis=0)
    is_known = np.isfinite(slopes) & (slopes > 0.0)
    weights = np.ones(tape.m)
    weights[is_known] = 1.0 / slopes[is_known]
    return weights


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
