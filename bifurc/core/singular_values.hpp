// Singular values of small matrices.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "bifurc/core/arrays.hpp"

namespace bifurc {

// QR with column pivoting, then one-sided Jacobi rotations on the rows of R, which are graded by
// then: two or three sweeps are enough. Small singular values come out to high relative accuracy,
// and the same on every processor (Drmac and Veselic 2008; Golub and Van Loan 2013, 8.6.3).
class SingularValues {
public:
    SingularValues(Index rows, Index columns)
        : is_tall_(rows >= columns),
          work_(std::max(rows, columns), std::min(rows, columns)),
          rows_of_r_(work_.columns(), work_.columns()),
          squares_(work_.columns()),
          columns_(work_.columns()) {}

    // The singular values of ``matrix``, the largest first; not numbers where an entry is none.
    void of(View<const double> matrix, Vector<double> values) {
        double largest = 0.0;  // by which all is divided: squares are not to underflow
        for (Index i = 0; i < matrix.rows; ++i) {
            for (double entry : matrix.row(i)) largest = std::max(largest, std::abs(entry));
        }
        const double unit = largest > 0.0 ? largest : 1.0;
        for (Index i = 0; i < work_.rows(); ++i) {
            for (Index j = 0; j < work_.columns(); ++j) work_(i, j) = (is_tall_ ? matrix(i, j) : matrix(j, i)) / unit;
        }
        triangularise();
        for (int sweep = 0; sweep < most_sweeps; ++sweep) {
            if (!rotate_all()) break;
        }
        for (Index i = 0; i < rows_of_r_.rows(); ++i) values[i] = unit * length(rows_of_r_.row(i));
        std::sort(values.begin(), values.end(), std::greater<>());
    }

    // The rate of singular value ``number``, counted from 0, of the matrix that was taken apart last,
    // where it changes by ``change``: l^T change r with its singular vectors. 0 for a value of 0, which
    // has none; its square does not change at first order.
    double rate(Index number, View<const double> matrix, View<const double> change) const {
        const Index row = row_of(number);
        const double size = length(rows_of_r_.row(row));
        if (!(size > 0.0)) return 0.0;
        // the row of R is the singular vector that is as long as it, its entries pivoted
        std::vector<double> vector(columns_.size());
        for (std::size_t k = 0; k < columns_.size(); ++k) vector[columns_[k]] = rows_of_r_(row, k) / size;
        // the other one is the image of this one
        double image_of_change = 0.0, square = 0.0;
        const Index others = is_tall_ ? matrix.rows : matrix.columns;
        for (Index i = 0; i < others; ++i) {
            double image = 0.0, moved = 0.0;
            for (std::size_t j = 0; j < vector.size(); ++j) {
                const Index k = static_cast<Index>(j);
                image += (is_tall_ ? matrix(i, k) : matrix(k, i)) * vector[j];
                moved += (is_tall_ ? change(i, k) : change(k, i)) * vector[j];
            }
            image_of_change += image * moved;
            square += image * image;
        }
        return image_of_change / std::sqrt(square);
    }

private:
    // The row of R that is singular value ``number``.
    Index row_of(Index number) const {
        std::vector<Index> order(rows_of_r_.rows());
        for (Index i = 0; i < rows_of_r_.rows(); ++i) order[i] = i;
        std::sort(order.begin(), order.end(),
                  [&](Index i, Index j) { return squared_length(rows_of_r_.row(i)) > squared_length(rows_of_r_.row(j)); });
        return order[number];
    }

    static constexpr int most_sweeps = 40;

    // R of a QR with column pivoting, by Householder reflections.
    void triangularise() {
        const Index rows = work_.rows(), columns = work_.columns();
        for (Index k = 0; k < columns; ++k) columns_[k] = k;
        for (Index k = 0; k < columns; ++k) {
            pivot(k);
            double square = 0.0;
            for (Index i = k; i < rows; ++i) square += work_(i, k) * work_(i, k);
            const double norm = std::sqrt(square);
            const double diagonal = work_(k, k) > 0.0 ? -norm : norm;
            const double head = work_(k, k) - diagonal;
            if (norm != 0.0) {
                for (Index j = k + 1; j < columns; ++j) {
                    double dot = head * work_(k, j);
                    for (Index i = k + 1; i < rows; ++i) dot += work_(i, k) * work_(i, j);
                    const double share = dot / (diagonal * head);
                    work_(k, j) += share * head;
                    for (Index i = k + 1; i < rows; ++i) work_(i, j) += share * work_(i, k);
                }
            }
            for (Index j = 0; j < columns; ++j) rows_of_r_(k, j) = j > k ? work_(k, j) : 0.0;
            rows_of_r_(k, k) = diagonal;
        }
    }

    // Brings the column that is longest from row k on to place k.
    void pivot(Index k) {
        Index best = k;
        double largest = -1.0;
        for (Index j = k; j < work_.columns(); ++j) {
            double square = 0.0;
            for (Index i = k; i < work_.rows(); ++i) square += work_(i, j) * work_(i, j);
            if (square > largest) {
                largest = square;
                best = j;
            }
        }
        if (best == k) return;
        std::swap(columns_[k], columns_[best]);
        for (Index i = 0; i < work_.rows(); ++i) std::swap(work_(i, k), work_(i, best));
        for (Index i = 0; i < k; ++i) std::swap(rows_of_r_(i, k), rows_of_r_(i, best));
    }

    // One rotation for every pair of rows; whether any was needed.
    bool rotate_all() {
        for (Index i = 0; i < rows_of_r_.rows(); ++i) squares_[i] = squared_length(rows_of_r_.row(i));
        bool has_turned = false;
        for (Index i = 0; i + 1 < rows_of_r_.rows(); ++i) {
            for (Index j = i + 1; j < rows_of_r_.rows(); ++j) has_turned = rotate(i, j) || has_turned;
        }
        return has_turned;
    }

    bool rotate(Index i, Index j) {
        const Vector<double> p = rows_of_r_.row(i), q = rows_of_r_.row(j);
        double gamma = 0.0;
        for (std::size_t k = 0; k < p.size(); ++k) gamma += p[k] * q[k];
        const double orthogonal = std::numeric_limits<double>::epsilon() * std::sqrt(squares_[i] * squares_[j]);
        if (!(std::abs(gamma) > orthogonal)) return false;
        const double zeta = (squares_[j] - squares_[i]) / (2.0 * gamma);
        const double tangent = std::copysign(1.0, zeta) / (std::abs(zeta) + std::sqrt(1.0 + zeta * zeta));
        const double cosine = 1.0 / std::sqrt(1.0 + tangent * tangent), sine = cosine * tangent;
        for (std::size_t k = 0; k < p.size(); ++k) {
            const double turned = cosine * p[k] - sine * q[k];
            q[k] = sine * p[k] + cosine * q[k];
            p[k] = turned;
        }
        squares_[i] = squared_length(p);
        squares_[j] = squared_length(q);
        return true;
    }

    bool is_tall_;
    Matrix<double> work_, rows_of_r_;
    std::vector<double> squares_;
    std::vector<Index> columns_;  // of the matrix, in the order of the columns of R
};

}  // namespace bifurc
