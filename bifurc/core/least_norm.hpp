// Least squares of any rank, with the shortest of the solutions.
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "bifurc/core/arrays.hpp"

namespace bifurc {

// The X (n, k) of least |X| among those of least |A X - B|, for A (m, n) and B (m, k): by a complete orthogonal
// factorisation (Golub and Van Loan 2013, 5.5.2). Not for two threads at once.
class LeastNorm {
public:
    // Makes room for a matrix and its right-hand sides, to be filled before `solve`.
    void reserve(Index rows, Index columns, Index sides) {
        if (matrix_.rows() != rows || matrix_.columns() != columns || sides_.columns() != sides) {
            matrix_ = Matrix<double>(rows, columns);
            sides_ = Matrix<double>(rows, sides);
            order_.resize(columns);
            squares_.resize(columns);
            sums_.resize(std::max(columns, sides));
        }
        std::fill_n(sides_.view().data, rows * sides, 0.0);
    }

    View<double> matrix() { return matrix_; }
    View<double> sides() { return sides_; }

    // Entries on the diagonal up to ``negligible`` of the largest count as zero.
    void solve(double negligible, View<double> solution) {
        const Index rank = triangularise(negligible);
        std::fill_n(solution.data, solution.rows * solution.columns, 0.0);
        if (rank == matrix_.columns()) substitute_back(solution);
        else project(rank, solution);
    }

private:
    Index triangularise(double negligible) {
        const Index rows = matrix_.rows(), columns = matrix_.columns();
        std::iota(order_.begin(), order_.end(), Index{0});
        double largest = 0.0;
        for (Index k = 0; k < std::min(rows, columns); ++k) {
            const double norm = std::sqrt(pivot(k));
            largest = std::max(largest, norm);
            if (!(norm > negligible * largest)) return k;
            const double diagonal = matrix_(k, k) > 0.0 ? -norm : norm;
            const double head = matrix_(k, k) - diagonal;
            const double scale = 1.0 / (diagonal * head);
            matrix_(k, k) = head;  // the reflector, for as long as it is needed
            reflect(k, scale, matrix_, k + 1);
            reflect(k, scale, sides_, 0);
            matrix_(k, k) = diagonal;
        }
        return std::min(rows, columns);
    }

    // Brings the column that is longest from row k on to place k; gives back its squared length.
    double pivot(Index k) {
        const Index rows = matrix_.rows(), columns = matrix_.columns();
        std::fill(squares_.begin() + k, squares_.end(), 0.0);
        for (Index i = k; i < rows; ++i) {
            const double* const row = matrix_.row(i).data();
            for (Index j = k; j < columns; ++j) squares_[j] += row[j] * row[j];
        }
        const Index best = std::max_element(squares_.begin() + k, squares_.end()) - squares_.begin();
        if (best != k) {
            std::swap(order_[k], order_[best]);
            for (Index i = 0; i < rows; ++i) std::swap(matrix_(i, k), matrix_(i, best));
        }
        return squares_[best];
    }

    // Reflects the columns of ``target`` from number ``first`` on by the reflector in column k.
    void reflect(Index k, double scale, View<double> target, Index first) {
        const Index rows = matrix_.rows(), columns = target.columns;
        std::fill(sums_.begin() + first, sums_.begin() + columns, 0.0);
        for (Index i = k; i < rows; ++i) {
            const double entry = matrix_(i, k);
            for (Index j = first; j < columns; ++j) sums_[j] += entry * target(i, j);
        }
        for (Index i = k; i < rows; ++i) {
            const double share = scale * matrix_(i, k);
            for (Index j = first; j < columns; ++j) target(i, j) += share * sums_[j];
        }
    }

    void substitute_back(View<double> solution) const {
        for (Index k = matrix_.columns() - 1; k >= 0; --k) {
            const Vector<double> row = solution.row(order_[k]);
            for (Index side = 0; side < solution.columns; ++side) {
                double total = sides_(k, side);
                for (Index j = k + 1; j < matrix_.columns(); ++j) total -= matrix_(k, j) * solution(order_[j], side);
                row[side] = total / matrix_(k, k);
            }
        }
    }

    // The rows of R, which are ``rank``, become orthonormal rows Q with R = L Q: X = Q^T L^-1 B.
    void project(Index rank, View<double> solution) {
        const Index columns = matrix_.columns();
        for (Index i = 0; i < rank; ++i) {
            const Vector<double> row = matrix_.row(i);
            std::fill(row.begin(), row.begin() + i, 0.0);
            const Vector<double> side = sides_.row(i);
            for (int time = 0; time < 2; ++time) {  // twice is enough (Giraud and Langou 2002)
                for (Index other = 0; other < i; ++other) {
                    const Vector<const double> q = matrix_.row(other);
                    const double part = dot(q, row);
                    for (Index j = 0; j < columns; ++j) row[j] -= part * q[j];
                    for (Index j = 0; j < solution.columns; ++j) side[j] -= part * sides_(other, j);
                }
            }
            const double size = length(row);
            for (double& entry : row) entry /= size;
            for (double& entry : side) entry /= size;
            for (Index j = 0; j < columns; ++j) {
                for (Index k = 0; k < solution.columns; ++k) solution(order_[j], k) += row[j] * side[k];
            }
        }
    }

    Matrix<double> matrix_{0, 0}, sides_{0, 0};
    std::vector<Index> order_;
    std::vector<double> squares_, sums_;
};

}  // namespace bifurc
