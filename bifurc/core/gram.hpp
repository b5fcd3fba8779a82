// Singular values of matrices of few columns, as bases of tangent spaces are, by way of the products of these.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "bifurc/core/arrays.hpp"

namespace bifurc {

// S^T S for the columns of a matrix S (n, d), taken apart by Jacobi's rotations (Golub and Van Loan 2013, 8.5.3). The
// squares of singular values come out to within rounding of the largest: enough for cosines between spaces that are
// compared with no small number.
class Gram {
public:
    static constexpr Index most = 8;  // columns

    explicit Gram(View<const double> columns) : d_(columns.columns) {
        for (Index i = 0; i < d_; ++i) {
            for (Index j = i; j < d_; ++j) {
                double total = 0.0;
                for (Index row = 0; row < columns.rows; ++row) total += columns(row, i) * columns(row, j);
                products_[i][j] = products_[j][i] = total;
                vectors_[i][j] = vectors_[j][i] = i == j ? 1.0 : 0.0;
            }
        }
        for (int sweep = 0; sweep < most_sweeps && rotate_all(); ++sweep) {
        }
    }

    double smallest() const {
        double least = products_[0][0];
        for (Index i = 1; i < d_; ++i) least = std::min(least, products_[i][i]);
        return std::sqrt(std::max(least, 0.0));
    }

    double largest() const {
        double most_of_all = products_[0][0];
        for (Index i = 1; i < d_; ++i) most_of_all = std::max(most_of_all, products_[i][i]);
        return std::sqrt(most_of_all);
    }

    // Makes the columns orthonormal, turned as little as can be: S (S^T S)^-1/2.
    void straighten(View<double> columns) const {
        std::array<std::array<double, most>, most> factor{};
        for (Index k = 0; k < d_; ++k) {
            const double root = std::sqrt(std::max(products_[k][k], tiny));
            for (Index i = 0; i < d_; ++i) {
                for (Index j = 0; j < d_; ++j) factor[i][j] += vectors_[i][k] * vectors_[j][k] / root;
            }
        }
        std::array<double, most> before;
        for (Index row = 0; row < columns.rows; ++row) {
            for (Index i = 0; i < d_; ++i) before[i] = columns(row, i);
            for (Index j = 0; j < d_; ++j) {
                double total = 0.0;
                for (Index i = 0; i < d_; ++i) total += before[i] * factor[i][j];
                columns(row, j) = total;
            }
        }
    }

private:
    static constexpr int most_sweeps = 20;
    static constexpr double tiny = 1e-300, settled = 1e-16;

    bool rotate_all() {
        bool has_turned = false;
        for (Index i = 0; i < d_; ++i) {
            for (Index j = i + 1; j < d_; ++j) has_turned = rotate(i, j) || has_turned;
        }
        return has_turned;
    }

    // Whether columns i and j were not yet orthogonal.
    bool rotate(Index i, Index j) {
        const double off = products_[i][j];
        if (!(std::abs(off) > settled * std::sqrt(std::abs(products_[i][i] * products_[j][j])))) return false;
        const double ratio = (products_[j][j] - products_[i][i]) / (2.0 * off);
        const double t = std::copysign(1.0, ratio) / (std::abs(ratio) + std::hypot(1.0, ratio));
        const double c = 1.0 / std::hypot(1.0, t), s = t * c;
        for (Index k = 0; k < d_; ++k) turn(products_[k][i], products_[k][j], c, s);
        for (Index k = 0; k < d_; ++k) turn(products_[i][k], products_[j][k], c, s);
        for (Index k = 0; k < d_; ++k) turn(vectors_[k][i], vectors_[k][j], c, s);
        products_[i][j] = products_[j][i] = 0.0;
        return true;
    }

    static void turn(double& one, double& other, double c, double s) {
        const double before = one;
        one = c * before - s * other;
        other = s * before + c * other;
    }

    Index d_;
    std::array<std::array<double, most>, most> products_{}, vectors_{};
};

}  // namespace bifurc
