// Determinants and inverses of small matrices.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "bifurc/core/arrays.hpp"

namespace bifurc {

// Gauss-Jordan elimination with row pivoting: fills the inverse of a matrix (n, n), which is
// overwritten, and returns its determinant. Where that is 0 the inverse is no number.
inline double invert(View<double> matrix, View<double> inverse) {
    const Index n = matrix.rows;
    double determinant = 1.0;
    for (Index i = 0; i < n; ++i) {
        for (Index j = 0; j < n; ++j) inverse(i, j) = i == j ? 1.0 : 0.0;
    }
    for (Index k = 0; k < n; ++k) {
        Index best = k;
        for (Index i = k + 1; i < n; ++i) {
            if (std::abs(matrix(i, k)) > std::abs(matrix(best, k))) best = i;
        }
        if (best != k) {
            std::swap_ranges(matrix.row(k).begin(), matrix.row(k).end(), matrix.row(best).begin());
            std::swap_ranges(inverse.row(k).begin(), inverse.row(k).end(), inverse.row(best).begin());
            determinant = -determinant;
        }
        const double pivot = matrix(k, k);
        determinant *= pivot;
        for (Index j = k; j < n; ++j) matrix(k, j) /= pivot;
        for (Index j = 0; j < n; ++j) inverse(k, j) /= pivot;
        for (Index i = 0; i < n; ++i) {
            const double factor = matrix(i, k);
            if (i == k || factor == 0.0) continue;
            for (Index j = k; j < n; ++j) matrix(i, j) -= factor * matrix(k, j);
            for (Index j = 0; j < n; ++j) inverse(i, j) -= factor * inverse(k, j);
        }
    }
    return determinant;
}

}  // namespace bifurc
