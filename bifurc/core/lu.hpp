// Square linear systems by elimination with row pivots.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "bifurc/core/arrays.hpp"

namespace bifurc {

// |re| + |im|: cheaper than the absolute value, and as good to choose a pivot by.
inline double rough_size(const std::complex<double>& value) {
    return std::abs(value.real()) + std::abs(value.imag());
}

// P A = L U of a complex matrix A (n, n). Pivots are chosen as if all rows were of one size: near infinity those of
// homogeneous equations are not.
class ComplexLu {
public:
    using Complex = std::complex<double>;

    explicit ComplexLu(Index n) : matrix_(n, n), sizes_(n), pivots_(n), inverse_diagonal_(n) {}

    // The matrix to be factored, to be filled before `factor`.
    View<Complex> matrix() { return matrix_; }

    // False where a pivot is zero or no number.
    bool factor() {
        const Index n = matrix_.rows();
        for (Index i = 0; i < n; ++i) {
            sizes_[i] = 0.0;
            for (const Complex& entry : matrix_.row(i)) sizes_[i] = std::max(sizes_[i], rough_size(entry));
        }
        for (Index k = 0; k < n; ++k) {
            Index pivot = k;
            double largest = 0.0;
            for (Index i = k; i < n; ++i) {
                const double size = rough_size(matrix_(i, k)) / sizes_[i];
                if (size > largest) {
                    pivot = i;
                    largest = size;
                }
            }
            if (!(largest > 0.0) || !std::isfinite(largest)) return false;
            pivots_[k] = pivot;
            if (pivot != k) std::swap_ranges(matrix_.row(k).begin(), matrix_.row(k).end(), matrix_.row(pivot).begin());
            std::swap(sizes_[k], sizes_[pivot]);
            inverse_diagonal_[k] = 1.0 / matrix_(k, k);
            for (Index i = k + 1; i < n; ++i) {
                if (matrix_(i, k) == 0.0) continue;
                const Complex factor = matrix_(i, k) * inverse_diagonal_[k];
                matrix_(i, k) = factor;
                for (Index j = k + 1; j < n; ++j) matrix_(i, j) -= factor * matrix_(k, j);
            }
        }
        return true;
    }

    // Turns a right-hand side into the solution.
    void solve(Vector<Complex> right) const {
        const Index n = matrix_.rows();
        for (Index k = 0; k < n; ++k) {
            std::swap(right[k], right[pivots_[k]]);
        }
        for (Index i = 1; i < n; ++i) {
            for (Index j = 0; j < i; ++j) right[i] -= matrix_(i, j) * right[j];
        }
        for (Index i = n - 1; i >= 0; --i) {
            for (Index j = i + 1; j < n; ++j) right[i] -= matrix_(i, j) * right[j];
            right[i] *= inverse_diagonal_[i];
        }
    }

private:
    Matrix<Complex> matrix_;
    std::vector<double> sizes_;
    std::vector<Index> pivots_;
    std::vector<Complex> inverse_diagonal_;
};

}  // namespace bifurc
