"""A problem of expressions as a Fortran subroutine, for AUTO-07p."""

from __future__ import annotations

import sympy

from bifurc.equations.expression_problem import ExpressionProblem

HEAD = """\
subroutine other_equations(x, f, jacobian)
  implicit none
  double precision, intent(in) :: x({n})
  double precision, intent(out) :: f({m}), jacobian({m}, {n})
"""


def fortran_of(problem: ExpressionProblem) -> str:
    """The subroutine `other_equations` with F (m,) and F' (m, n) at x (n,), common
    parts computed once."""
    places = [sympy.Symbol(f"v{k}") for k in range(1, problem.n + 1)]
    symbols = dict(zip(problem.domain.names, places, strict=True))
    expressions = problem.program.over(problem.places, symbols, sympy, sympy.Rational)
    values = [_in_numbers(one) for one in expressions]
    rows = [[value.diff(place) for place in places] for value in values]
    flat = [*values, *(entry for row in rows for entry in row)]
    parts, results = sympy.cse(flat, symbols=sympy.numbered_symbols("t"))
    m, n = len(values), len(places)
    names = [str(place) for place in places] + [str(name) for name, _ in parts]
    lines = [HEAD.format(n=n, m=m), f"  double precision :: {', '.join(names)}"]
    lines += [f"  v{k} = x({k})" for k in range(1, n + 1)]
    lines += [f"  {name} = {_text(part)}" for name, part in parts]
    lines += [f"  f({i + 1}) = {_text(results[i])}" for i in range(m)]
    for i in range(m):
        for k in range(n):
            entry = results[m + n * i + k]
            lines.append(f"  jacobian({i + 1}, {k + 1}) = {_text(entry)}")
    return "\n".join([*lines, "end subroutine", ""])


def _in_numbers(expression: sympy.Expr) -> sympy.Expr:
    """The expression with pi and e as numbers."""
    constants = expression.atoms(sympy.NumberSymbol)
    numbers = {constant: constant.evalf(20) for constant in constants}
    return sympy.sympify(expression).xreplace(numbers).evalf(20)


def _text(expression: sympy.Expr) -> str:
    return str(sympy.fcode(expression, standard=95, source_format="free")).replace(
        "&\n", ""
    )
