// Determinants and inverses of small matrices.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "bifurc/core/arrays.hpp"

namespace bifurc {

// Gauss-Jordan elimination with row pivoting, in place: puts the inverse in the place of a matrix (n, n), and
// returns its determinant. Where that is 0 the inverse is no number. ``pivots`` (n) is room.
inline double invert(View<double> matrix, std::vector<Index>& pivots) {
    const Index n = matrix.rows;
    double determinant = 1.0;
    for (Index k = 0; k < n; ++k) {
        Index best = k;
        for (Index i = k + 1; i < n; ++i) {
            if (std::abs(matrix(i, k)) > std::abs(matrix(best, k))) best = i;
        }
        pivots[k] = best;
        if (best != k) {
            std::swap_ranges(matrix.row(k).begin(), matrix.row(k).end(), matrix.row(best).begin());
            determinant = -determinant;
        }
        if (matrix(k, k) == 0.0) return 0.0;
        determinant *= matrix(k, k);
        const double share = 1.0 / matrix(k, k);
        matrix(k, k) = 1.0;
        for (Index j = 0; j < n; ++j) matrix(k, j) *= share;
        for (Index i = 0; i < n; ++i) {
            if (i == k) continue;
            const double factor = matrix(i, k);
            matrix(i, k) = 0.0;
            for (Index j = 0; j < n; ++j) matrix(i, j) -= factor * matrix(k, j);
        }
    }
    // rows that were swapped are columns of the inverse
    for (Index k = n - 1; k >= 0; --k) {
        if (pivots[k] == k) continue;
        for (Index i = 0; i < n; ++i) std::swap(matrix(i, k), matrix(i, pivots[k]));
    }
    return determinant;
}

}  // namespace bifurc
