// Complex numbers with twice the digits of doubles: each part is a sum of two doubles (Dekker 1971; Hida, Li
// and Bailey 2001), and the operations of tapes on them.
#pragma once

#include <cmath>
#include <complex>

#include "bifurc/core/tape.hpp"

namespace bifurc {

struct Twofold {
    double high = 0.0, low = 0.0;

    // The exact sum of two doubles, of which the first is the larger one or both are of one size.
    static Twofold of_ordered(double larger, double smaller) {
        const double sum = larger + smaller;
        return {sum, smaller - (sum - larger)};
    }
    static Twofold of_sum(double a, double b) {
        const double sum = a + b, part = sum - a;
        return {sum, (a - (sum - part)) + (b - part)};
    }
    // The exact product of two doubles, by halves of their digits.
    static Twofold of_product(double a, double b) {
        constexpr double splitter = 134217729.0;  // 2^27 + 1
        const double wide_a = splitter * a, wide_b = splitter * b;
        const double high_a = wide_a - (wide_a - a), high_b = wide_b - (wide_b - b);
        const double low_a = a - high_a, low_b = b - high_b, product = a * b;
        return {product, ((high_a * high_b - product) + high_a * low_b + low_a * high_b) + low_a * low_b};
    }

    friend Twofold operator+(const Twofold& a, const Twofold& b) {
        const Twofold highs = of_sum(a.high, b.high), lows = of_sum(a.low, b.low);
        const Twofold sum = of_ordered(highs.high, highs.low + lows.high);
        return of_ordered(sum.high, sum.low + lows.low);
    }
    friend Twofold operator-(const Twofold& a) { return {-a.high, -a.low}; }
    friend Twofold operator-(const Twofold& a, const Twofold& b) { return a + -b; }
    friend Twofold operator*(const Twofold& a, const Twofold& b) {
        const Twofold product = of_product(a.high, b.high);
        return of_ordered(product.high, product.low + (a.high * b.low + a.low * b.high));
    }
    friend Twofold operator/(const Twofold& a, const Twofold& b) {
        const double first = a.high / b.high;
        const Twofold rest = a - b * Twofold{first};
        const double second = rest.high / b.high;
        const double third = (rest - b * Twofold{second}).high / b.high;
        return of_ordered(first, second) + Twofold{third};
    }
};

struct TwofoldComplex {
    Twofold real, imag;

    TwofoldComplex() = default;
    TwofoldComplex(const Twofold& real, const Twofold& imag) : real(real), imag(imag) {}
    TwofoldComplex(double number) : real{number} {}
    TwofoldComplex(const std::complex<double>& number) : real{number.real()}, imag{number.imag()} {}

    std::complex<double> rounded() const { return {real.high, imag.high}; }

    friend TwofoldComplex operator+(const TwofoldComplex& a, const TwofoldComplex& b) {
        return {a.real + b.real, a.imag + b.imag};
    }
    friend TwofoldComplex operator-(const TwofoldComplex& a, const TwofoldComplex& b) {
        return {a.real - b.real, a.imag - b.imag};
    }
    friend TwofoldComplex operator*(const TwofoldComplex& a, const TwofoldComplex& b) {
        return {a.real * b.real - a.imag * b.imag, a.real * b.imag + a.imag * b.real};
    }
    friend TwofoldComplex operator/(const TwofoldComplex& a, const TwofoldComplex& b) {
        const Twofold size = b.real * b.real + b.imag * b.imag;
        const TwofoldComplex product = a * TwofoldComplex(b.real, -b.imag);
        return {product.real / size, product.imag / size};
    }
};

// A whole power.
inline TwofoldComplex power_of(const TwofoldComplex& number, int exponent) {
    TwofoldComplex power(1.0), square = number;
    for (int rest = std::abs(exponent); rest; rest /= 2, square = square * square) {
        if (rest % 2) power = power * square;
    }
    return exponent < 0 ? TwofoldComplex(1.0) / power : power;
}

// What an operation makes of the values of its operands: as exact as doubles where it is none of arithmetic.
inline TwofoldComplex value_of(const Instruction& instruction, const TwofoldComplex& left, const TwofoldComplex& right) {
    const double constant = instruction.constant;
    switch (instruction.operation) {
        case Operation::add: return left + right;
        case Operation::subtract: return left - right;
        case Operation::multiply: return left * right;
        case Operation::divide: return left / right;
        case Operation::shift: return left + TwofoldComplex(constant);
        case Operation::scale: return left * TwofoldComplex(constant);
        case Operation::over: return left / TwofoldComplex(constant);
        case Operation::power:
            if (constant == std::round(constant) && std::abs(constant) < 1e3) return power_of(left, static_cast<int>(constant));
            break;
        default: break;
    }
    return value_of<std::complex<double>>(instruction, left.rounded(), right.rounded());
}

}  // namespace bifurc
