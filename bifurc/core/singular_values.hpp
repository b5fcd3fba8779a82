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
          squares_(work_.columns()) {}

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

private:
    static constexpr int most_sweeps = 40;

    // R of a QR with column pivoting, by Householder reflections.
    void triangularise() {
        const Index rows = work_.rows(), columns = work_.columns();
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
};

}  // namespace bifurc
