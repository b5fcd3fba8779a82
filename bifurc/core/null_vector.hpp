// Singular values of small matrices, real or complex.
#pragma once

#include <array>
#include <cmath>

#include "bifurc/core/arrays.hpp"

namespace bifurc {

// The smallest singular value of a matrix, and its unit right singular vector.
template <class T, std::size_t columns>
struct SmallestSingularValue {
    double value;
    std::array<T, columns> vector;
};

// From the columns of a matrix: they are turned, two and two, until they are at right angles
// (one-sided Jacobi: Golub and Van Loan 2013, 8.6.3).
template <class T, std::size_t rows, std::size_t columns>
SmallestSingularValue<T, columns> smallest_singular_value(std::array<std::array<T, rows>, columns> matrix) {
    constexpr double right_angle = 1e-15;  // a cosine
    constexpr int most_sweeps = 30;        // six are usual
    std::array<std::array<T, columns>, columns> vectors{};
    for (std::size_t j = 0; j < columns; ++j) vectors[j][j] = 1.0;
    // columns p and q become c p - s phase q and s p + c phase q
    const auto turn = [](auto& p, auto& q, double c, double s, const T& phase) {
        for (std::size_t i = 0; i < p.size(); ++i) {
            const T first = p[i], second = phase * q[i];
            p[i] = c * first - s * second;
            q[i] = s * first + c * second;
        }
    };
    bool is_turned = true;
    for (int sweep = 0; is_turned && sweep < most_sweeps; ++sweep) {
        is_turned = false;
        for (std::size_t p = 0; p < columns; ++p) {
            for (std::size_t q = p + 1; q < columns; ++q) {
                const double first = squared_size(matrix[p]), second = squared_size(matrix[q]);
                const T inner = inner_product(matrix[p], matrix[q]);
                const double size = std::abs(inner);
                if (size <= right_angle * std::sqrt(first * second) || size == 0.0) continue;
                is_turned = true;
                const double ratio = (second - first) / (2.0 * size);
                const double tangent = std::copysign(1.0, ratio) / (std::abs(ratio) + std::hypot(1.0, ratio));
                const double c = 1.0 / std::sqrt(1.0 + tangent * tangent), s = c * tangent;
                const T phase = conjugate_of(inner) / size;
                turn(matrix[p], matrix[q], c, s, phase);
                turn(vectors[p], vectors[q], c, s, phase);
            }
        }
    }
    std::size_t least = 0;
    for (std::size_t j = 1; j < columns; ++j) {
        if (squared_size(matrix[j]) < squared_size(matrix[least])) least = j;
    }
    return {std::sqrt(squared_size(matrix[least])), vectors[least]};
}

}  // namespace bifurc
