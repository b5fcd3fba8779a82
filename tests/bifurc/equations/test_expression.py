"""Texts of expressions: what they say, and that nothing else can be made of them."""

from __future__ import annotations

import math
import pickle
import random

import mpmath
import numpy as np
import pytest
import sympy

from bifurc.equations.expression import ExpressionError, Part, parse_expression
from bifurc.equations.program import Program, Step
from bifurc.equations.tape import TapeWriter

NAMES = ("x", "y", "p", "lambda", "λ", "x_1")
x, y, p = sympy.symbols("x y p")


def symbols_on(program: Program) -> dict[str, Part]:
    """The known symbols of a program."""
    return {name: Part(program.place(Step(name))) for name in NAMES}


def read(text: str) -> tuple[Program, Part]:
    """What a text says, and the program on which that stands."""
    program = Program()
    return program, parse_expression(text, symbols_on(program), program)


def in_sympy(text: str) -> sympy.Expr:
    """What a text says, as an expression of sympy."""
    program, part = read(text)
    symbols = {name: sympy.Symbol(name) for name in NAMES}
    return program.over([part.place], symbols, sympy, sympy.Rational)[0]


@pytest.mark.parametrize(
    "text, expected",
    [
        ("x^2 + y**2 - 1", x**2 + y**2 - 1),
        ("-x^2", -(x**2)),
        ("2^3^2", sympy.Integer(512)),
        ("2^-x", 2 ** (-x)),
        ("-x*-y", x * y),
        ("x - y - p", x - y - p),
        ("x/y/p", x / (y * p)),
        ("x/y*p", x * p / y),
        ("1.5e-1*x", sympy.Rational(3, 20) * x),
        (".5 + 1.", sympy.Rational(3, 2)),
        ("sin(x)*arctan(y)", sympy.sin(x) * sympy.atan(y)),
        ("atan2(y, x) + ln(e)", sympy.atan2(y, x) + 1),
        ("lambda*λ*x_1", math.prod(sympy.symbols("lambda λ x_1"))),
        ("x·y − p×2", x * y - 2 * p),
        ("cos(pi)", sympy.Integer(-1)),
        (" ( x )\t", x),
        ("0.0*x + 0e5", sympy.Integer(0)),
    ],
)
def test_a_text_says_what_it_says_in_mathematics(text, expected) -> None:
    assert sympy.simplify(in_sympy(text) - expected) == 0


@pytest.mark.parametrize(
    "text, message",
    [
        ("2x", r"an operator is missing at column 2; write 2\*x"),
        ("x y", r"an operator is missing at column 3; write x\*y"),
        ("(x)(y)", r"an operator is missing at column 4"),
        ("x(2)", r"'x' at column 1 is no function; write x\*"),
        ("(x", "the bracket at column 1 is not closed"),
        ("sin(x", "the bracket at column 4 is not closed"),
        ("x)", r"'\)' at column 2 is out of place"),
        ("x +", "something is missing at the end"),
        ("", "something is missing at the end"),
        ("* x", r"'\*' at column 1 is out of place"),
        ("sni(x)", "no function 'sni' at column 1; the nearest is 'sin'"),
        ("sin + x", r"'sin' at column 1 is a function; write sin\("),
        ("x + yy", "no symbol 'yy' at column 5; the nearest is 'y'"),
        ("qqq", "no symbol 'qqq' at column 1; known are x, y, p"),
        ("atan2(x)", "atan2 at column 1 has 1 arguments; it must have 2"),
        ("abs(x)", "'abs' at column 1 cannot be used: it has no derivative at 0"),
        ("max(x, y)", "cannot be used"),
        ("1/0", "/ at column 2 gives no real number for 1, 0"),
        ("x/(1 - 1)", "/ at column 2 gives no real number"),
        ("sqrt(-1)", "sqrt at column 1 gives no real number for -1"),
        ("(-8)^(1/3)", "no real number"),
        ("y - 0^x", "at column 6 raises 0 to an unknown"),
        ("(1 - 3)**x", "at column 8 raises -2 to an unknown"),
        ("log(0)", "no real number"),
        ("1e400", "outside the range of doubles"),
        ("1e-400", "outside the range of doubles"),
        ("x = y", "'=' at column 3 cannot be read"),
        ("x!", "'!' at column 2 cannot be read"),
    ],
)
def test_what_cannot_be_read_is_said_with_its_column(text, message) -> None:
    with pytest.raises(ExpressionError, match=message):
        read(text)


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os').system('echo')",
        "x.__class__",
        "().__class__.__bases__[0]",
        "open('/etc/passwd')",
        "exec('1')",
        "lambda: 0",
        "[y for y in x]",
        "x if y else p",
        "x; y",
        "x\n+ import os",
        "f'{x}'",
        '"x"',
        "x\\",
        "exp(exp(exp(10)))",
        "9^9^9^9",
        "x^1e9",
        "2^(10^9)",
        "((1.00000000000000000000000000001^1000)^1000)^1000",
        "((0.1^1000)^1000)^1000",
        "1e99999999999",
        "1" * 1000,
        "(" * 5000 + "x" + ")" * 5000,
        "-" * 9000 + "x",
        "x^" * 5000 + "x",
        "sin(" * 2000 + "x" + ")" * 2000,
        "x+" * 20000 + "x",
        "\0",
        "٣*x",
    ],
)
def test_hostile_texts_are_refused_at_once(text) -> None:
    with pytest.raises(ExpressionError):
        read(text)


def test_definitions_that_double_do_not_grow_without_bound() -> None:
    program = Program()
    symbols = symbols_on(program)
    with pytest.raises(ExpressionError, match="more than 20000 operations"):
        for _ in range(100):
            symbols["x"] = parse_expression("sin(x)*x + x", symbols, program)


def test_random_texts_are_read_or_refused() -> None:
    pieces = ["x", "y", "1.5", "(", ")", "+", "-", "*", "/", "^", "sin", ",", " ", "e"]
    generator = random.Random(1)
    count = 0
    for _ in range(3000):
        text = "".join(generator.choices(pieces, k=generator.randint(1, 12)))
        try:
            program, part = read(text)
        except ExpressionError:
            continue
        count += 1
        writer = TapeWriter(len(NAMES))
        tape = writer.tape(program.write_on(writer, [part.place], NAMES))
        value = tape.compiled.residuals(np.array([[0.3, 0.7, 0, 0, 0, 0]]))[0, 0]
        python = text.replace("^", "**").replace("sin", "math.sin")
        names = {"x": 0.3, "y": 0.7, "e": math.e, "math": math}
        assert value == pytest.approx(eval(python, names), rel=1e-12)
    assert count > 100


def test_a_long_sum_is_read_and_copied() -> None:
    program, part = read("log(x)" + " - sqrt(y)" * 1500)
    twin = pickle.loads(pickle.dumps(program))
    (value,) = twin.over([part.place], {"x": 1.0, "y": 4.0}, mpmath, mpmath.fraction)
    assert value == -3000


@pytest.mark.parametrize(
    "text", ["1/3", "sqrt(2)/2", "3*pi", "0.1*3", "1/sqrt(3)", "exp(1) - e", "pi/e"]
)
def test_a_constant_is_rounded_once(text) -> None:
    program, part = read(f"x*({text})")
    writer = TapeWriter(len(NAMES))
    (slot,) = program.write_on(writer, [part.place], NAMES)
    with mpmath.workdps(60):
        expected = float(
            program.over([part.place], {"x": 1}, mpmath, mpmath.fraction)[0]
        )
    node = writer.node(slot)
    assert node.constant == expected
