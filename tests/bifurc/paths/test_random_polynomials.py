"""Random square systems have the solutions that exact Groebner bases say."""

import itertools

import numpy as np
import pytest
import sympy
from sympy.polys.matrices import DomainMatrix

from bifurc.limits import Deadline
from bifurc.paths.follow import copy_of
from bifurc.paths.sparse import SparseFamily, have_curves
from tests.samples import one_in

KINDS = ("plain", "at infinity", "multiple", "with curves")


def random_polynomial(symbols, degree, rng):
    monomials = sorted(sympy.itermonomials(symbols, degree), key=str)
    chosen = rng.choice(len(monomials), min(4, len(monomials)), replace=False)
    values = rng.integers(1, 6, len(chosen)) * rng.choice([-1, 1], len(chosen))
    total = sum(
        int(v) * monomials[k] for v, k in zip(values, sorted(chosen), strict=True)
    )
    return total if total.free_symbols else total + symbols[0]


def random_system(seed):
    """Two to four polynomials, some with solutions at infinity, multiple ones, or
    curves."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 5))
    symbols = sympy.symbols(f"x:{n}")
    system = [
        random_polynomial(symbols, int(rng.integers(1, 3)), rng) for _ in range(n)
    ]
    linear = [random_polynomial(symbols, 1, rng) for _ in range(3)]
    kind = KINDS[seed % len(KINDS)]
    if kind == "at infinity":
        system[0] = system[1] + symbols[0] * linear[0]
    elif kind == "multiple":
        system[0] = linear[0] ** 2
    elif kind == "with curves":
        system[:2] = [linear[0] * linear[1], linear[0] * linear[2]]
    return symbols, [sympy.Poly(one, *symbols) for one in system]


def multiplication(basis, factor, symbols, standard):
    """The matrix of the products with a factor, in standard monomials."""
    rows = []
    for monomial in standard:
        powers = zip(symbols, monomial, strict=True)
        product = factor * sympy.prod(s**k for s, k in powers)
        rest = sympy.Poly(basis.reduce(product)[1], *symbols)
        rows.append([rest.coeff_monomial(one) for one in standard])
    return DomainMatrix.from_Matrix(sympy.Matrix(rows)).convert_to(sympy.QQ)


def trace_of_product(one, other):
    columns = other.transpose().to_list()
    pairs = zip(itertools.chain(*one.to_list()), itertools.chain(*columns), strict=True)
    return sum((a * b for a, b in pairs), sympy.QQ(0))


def exact_counts(symbols, system):
    """How many solutions there are with their multiplicities, how many different ones,
    and how many real ones (Hermite's trace form); None where they are not isolated."""
    basis = sympy.groebner(system, *symbols, order="grevlex")
    leading = [one.monoms(order="grevlex")[0] for one in basis.polys]
    if leading == [(0,) * len(symbols)]:
        return 0, 0, 0
    powers = [max(one) for one in leading if sum(map(bool, one)) == 1]
    if len({one.index(max(one)) for one in leading if max(one) == sum(one)}) < len(
        symbols
    ):
        return None
    ranges = [range(max(powers))] * len(symbols)
    standard = [
        one
        for one in itertools.product(*ranges)
        if not any(np.all(np.array(one) >= lead) for lead in leading)
    ]
    identity = DomainMatrix.eye(len(standard), sympy.QQ)
    of_unknowns = [multiplication(basis, one, symbols, standard) for one in symbols]
    matrices = []
    for monomial in standard:
        product = identity
        for factor, power in zip(of_unknowns, monomial, strict=True):
            product = product * factor**power
        matrices.append(product)
    form = [[trace_of_product(one, other) for other in matrices] for one in matrices]
    exact = DomainMatrix(form, identity.shape, sympy.QQ)
    values = [value for value in exact.charpoly() if value]
    numbers = [k for k, value in enumerate(exact.charpoly()) if value]
    positive = sum(a * b < 0 for a, b in itertools.pairwise(values))
    turned = [v * (-1) ** k for v, k in zip(values, numbers, strict=True)]
    negative = sum(a * b < 0 for a, b in itertools.pairwise(turned))
    return len(standard), exact.rank(), positive - negative


@pytest.mark.parametrize("seed", one_in(25, range(200)))
def test_what_is_known_for_sure_is_so(seed):
    symbols, system = random_system(seed)
    polynomials = [
        {term: float(value) for term, value in one.terms()} for one in system
    ]
    rng = np.random.default_rng(seed)
    paths = SparseFamily.of(polynomials).solve(polynomials, rng, Deadline(), 500)
    has_curves = have_curves(polynomials, rng, Deadline(), 500)
    exact = exact_counts(symbols, system)
    if exact is None:
        assert has_curves is not False
        return
    with_multiplicities, different, real = exact
    regular = paths.regular
    assert not has_curves
    assert len(regular) <= different
    if has_curves is None or paths.lost or paths.far() or len(paths.singular):
        return
    copies = copy_of(np.concatenate([regular, regular.conj()]))[len(regular) :]
    assert len(regular) == different == with_multiplicities
    assert np.count_nonzero(copies == np.arange(len(regular))) == real
