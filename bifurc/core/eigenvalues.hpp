// Eigenvalues of small complex matrices.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "bifurc/core/arrays.hpp"

namespace bifurc {

namespace detail {

using Complex = std::complex<double>;

// The modulus of a number that is neither huge nor tiny.
inline double modulus(const Complex& value) { return std::sqrt(std::norm(value)); }

inline Complex times_power(Complex value, int exponent) {
    return {std::ldexp(value.real(), exponent), std::ldexp(value.imag(), exponent)};
}

inline void scale_by_power(View<Complex> matrix, int exponent) {
    for (Index i = 0; i < matrix.rows; ++i) {
        for (Complex& entry : matrix.row(i)) entry = times_power(entry, exponent);
    }
}

// To Hessenberg form by reflections, in place (Golub and Van Loan 2013, algorithm 7.4.2).
inline void reduce_to_hessenberg(View<Complex> matrix) {
    const Index n = matrix.rows;
    std::vector<Complex> reflector(n);
    for (Index k = 0; k + 2 < n; ++k) {
        double square = 0.0;
        for (Index i = k + 1; i < n; ++i) square += std::norm(matrix(i, k));
        const double below = square - std::norm(matrix(k + 1, k));
        if (below <= 0.0) continue;
        const double norm = std::sqrt(square), size = modulus(matrix(k + 1, k));
        const Complex phase = size > 0.0 ? matrix(k + 1, k) / size : Complex(1.0);
        for (Index i = k + 1; i < n; ++i) reflector[i] = matrix(i, k);
        reflector[k + 1] += phase * norm;
        const double scale = 1.0 / (norm * (norm + size));  // 2 over the squared length
        for (Index j = k; j < n; ++j) {
            Complex dot = 0.0;
            for (Index i = k + 1; i < n; ++i) dot += std::conj(reflector[i]) * matrix(i, j);
            for (Index i = k + 1; i < n; ++i) matrix(i, j) -= scale * dot * reflector[i];
        }
        for (Index i = 0; i < n; ++i) {
            Complex dot = 0.0;
            for (Index j = k + 1; j < n; ++j) dot += matrix(i, j) * reflector[j];
            for (Index j = k + 1; j < n; ++j) matrix(i, j) -= scale * dot * std::conj(reflector[j]);
        }
    }
}

// The eigenvalue of the 2 x 2 block that ends at ``last`` which is nearer to its last entry.
inline Complex wilkinson_shift(View<const Complex> matrix, Index last) {
    const Complex a = matrix(last - 1, last - 1), d = matrix(last, last);
    const Complex product = matrix(last - 1, last) * matrix(last, last - 1);
    const Complex half = 0.5 * (a - d);
    const Complex root = std::sqrt(half * half + product);
    const Complex denominator = std::norm(half + root) > std::norm(half - root) ? half + root : half - root;
    return denominator == 0.0 ? d : d - product / denominator;
}

// H - shift = Q R, then R Q + shift, on rows and columns ``first`` to ``last``.
inline void qr_step(View<Complex> matrix, Index first, Index last, Complex shift, Vector<double> cosines,
                    Vector<Complex> sines) {
    for (Index i = first; i <= last; ++i) matrix(i, i) -= shift;
    for (Index k = first; k < last; ++k) {
        const Complex upper = matrix(k, k), lower = matrix(k + 1, k);
        const double size = modulus(upper), norm = std::sqrt(std::norm(upper) + std::norm(lower));
        const Complex phase = size > 0.0 ? upper / size : Complex(1.0);
        cosines[k] = norm > 0.0 ? size / norm : 1.0;
        sines[k] = norm > 0.0 ? phase * std::conj(lower) / norm : Complex(0.0);
        for (Index j = k; j <= last; ++j) {
            const Complex above = matrix(k, j), below = matrix(k + 1, j);
            matrix(k, j) = cosines[k] * above + sines[k] * below;
            matrix(k + 1, j) = cosines[k] * below - std::conj(sines[k]) * above;
        }
    }
    for (Index k = first; k < last; ++k) {
        for (Index i = first; i <= std::min(k + 1, last); ++i) {
            const Complex left = matrix(i, k), right = matrix(i, k + 1);
            matrix(i, k) = cosines[k] * left + std::conj(sines[k]) * right;
            matrix(i, k + 1) = cosines[k] * right - sines[k] * left;
        }
    }
    for (Index i = first; i <= last; ++i) matrix(i, i) += shift;
}

}  // namespace detail

// Fills the eigenvalues (n) of a finite matrix (n, n), which is overwritten; false where the
// iteration does not end. QR iteration on the Hessenberg form with Wilkinson's shifts (Golub and
// Van Loan 2013, 7.4 and 7.5). The values are those of a matrix that differs by rounding of the
// norm: nothing is balanced, so that small ones beside large ones are known to that only.
inline bool find_eigenvalues(View<std::complex<double>> matrix, Vector<std::complex<double>> values) {
    constexpr double rounding = std::numeric_limits<double>::epsilon();
    constexpr int most_steps = 30;     // for one eigenvalue; three are usual
    constexpr int steps_in_vain = 10;  // until another shift breaks a symmetry
    const Index n = matrix.rows;
    double size = 0.0;
    for (Index i = 0; i < n; ++i) {
        for (const auto& entry : matrix.row(i)) size += std::abs(entry);
    }
    if (!std::isfinite(size)) return false;
    // a power of two, so that no square is too large or too small
    const int exponent = size > 0.0 ? std::ilogb(size) : 0;
    detail::scale_by_power(matrix, -exponent);
    detail::reduce_to_hessenberg(matrix);
    std::vector<double> cosines(n);
    std::vector<std::complex<double>> sines(n);
    int steps = 0;
    for (Index last = n - 1; last >= 0;) {
        Index first = last;  // of the block without negligible entries below its diagonal
        for (; first > 0; --first) {
            const double diagonal =
                detail::modulus(matrix(first, first)) + detail::modulus(matrix(first - 1, first - 1));
            const double negligible = rounding * (diagonal > 0.0 ? diagonal : 1.0);
            if (detail::modulus(matrix(first, first - 1)) <= negligible) break;
        }
        if (first == last) {
            values[last] = detail::times_power(matrix(last, last), exponent);
            --last;
            steps = 0;
            continue;
        }
        if (++steps > most_steps) return false;
        const std::complex<double> shift =
            steps % steps_in_vain ? detail::wilkinson_shift(matrix, last)
                                  : matrix(last, last) + 0.75 * detail::modulus(matrix(last, last - 1));
        detail::qr_step(matrix, first, last, shift, cosines, sines);
    }
    return true;
}

}  // namespace bifurc
