// Small least-squares problems: one factorisation for many right-hand sides, systems of any
// rank, and damped normal equations. All arithmetic is here, so that every processor and every
// BLAS makes the same of it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "bifurc/core/arrays.hpp"

namespace bifurc {

// Householder QR of a matrix in place: R on and above the diagonal, below it the reflectors,
// whose first entry is 1, with their scales beside.
class Factorization {
public:
    Factorization(Index rows, Index columns)
        : matrix_(rows, columns), scale_(columns), inverse_diagonal_(columns), work_(std::max(rows, columns)), q_(0, 0), upper_(0, 0) {}

    // The matrix to be factored, to be filled before `factor`.
    View<double> matrix() { return matrix_; }

    void factor() {
        const Index rows = matrix_.rows();
        has_q_ = false;
        for (Index k = 0; k < rank(); ++k) {
            double square = 0.0;
            for (Index i = k; i < rows; ++i) square += matrix_(i, k) * matrix_(i, k);
            const double norm = std::sqrt(square);
            if (norm == 0.0) {
                scale_[k] = inverse_diagonal_[k] = 0.0;
                continue;
            }
            const double diagonal = matrix_(k, k) > 0.0 ? -norm : norm;
            const double pivot = matrix_(k, k) - diagonal;
            scale_[k] = -pivot / diagonal;
            for (Index i = k + 1; i < rows; ++i) matrix_(i, k) /= pivot;
            matrix_(k, k) = diagonal;
            inverse_diagonal_[k] = 1.0 / diagonal;
            reflect(k, matrix_, k + 1);
        }
    }

    // Multiplies the reflections out, of a small matrix: many right-hand sides are solved sooner then.
    void prepare_for_many() {
        const Index rows = matrix_.rows(), columns = rank();
        if (columns > few) return;
        has_q_ = true;
        if (q_.rows() != rows) {
            q_ = Matrix<double>(rows, columns);
            upper_ = Matrix<double>(columns, columns);
        }
        std::fill_n(q_.view().data, rows * columns, 0.0);
        for (Index k = columns - 1; k >= 0; --k) {
            q_(k, k) = 1.0;
            reflect(k, q_, k);
            for (Index j = 0; j < k; ++j) upper_(k, j) = matrix_(j, k);
        }
    }

    // The least-squares solution for one right-hand side, which is overwritten; with more
    // columns than rows the last unknowns are 0.
    void solve(Vector<double> right, Vector<double> solution) const {
        const Index rows = matrix_.rows(), columns = rank();
        std::fill(solution.begin(), solution.end(), 0.0);
        if (has_q_) {
            for (Index i = 0; i < rows; ++i) {
                for (Index j = 0; j < columns; ++j) solution[j] += right[i] * q_(i, j);
            }
            for (Index k = columns - 1; k >= 0; --k) {
                solution[k] *= inverse_diagonal_[k];
                for (Index j = 0; j < k; ++j) solution[j] -= upper_(k, j) * solution[k];
            }
            return;
        }
        for (Index k = 0; k < columns; ++k) {
            double dot = right[k];
            for (Index i = k + 1; i < rows; ++i) dot += matrix_(i, k) * right[i];
            dot *= scale_[k];
            right[k] -= dot;
            for (Index i = k + 1; i < rows; ++i) right[i] -= dot * matrix_(i, k);
        }
        for (Index k = columns - 1; k >= 0; --k) {
            double total = right[k];
            for (Index j = k + 1; j < columns; ++j) total -= matrix_(k, j) * solution[j];
            solution[k] = total * inverse_diagonal_[k];
        }
    }

    // The smallest singular value of R, about, by inverse iteration on R^T R; 0 where R is
    // singular. A diagonal entry of R alone may be larger by any factor.
    double smallest_singular_value() {
        const Index size = rank();
        const Vector<double> vector{work_.data(), static_cast<std::size_t>(size)};
        for (Index k = 0; k < size; ++k) {
            if (matrix_(k, k) == 0.0) return 0.0;
            vector[k] = 1.0 + 0.1 * k;  // along no vector of a symmetric system, nor across it
        }
        double norm = length(vector);
        for (int iteration = 0; iteration < inverse_steps; ++iteration) {
            for (Index k = 0; k < size; ++k) {
                double total = vector[k] / norm;
                for (Index j = 0; j < k; ++j) total -= matrix_(j, k) * vector[j];
                vector[k] = total * inverse_diagonal_[k];
            }
            for (Index k = size - 1; k >= 0; --k) {
                double total = vector[k];
                for (Index j = k + 1; j < size; ++j) total -= matrix_(k, j) * vector[j];
                vector[k] = total * inverse_diagonal_[k];
            }
            norm = length(vector);
        }
        return 1.0 / std::sqrt(norm);
    }

private:
    static constexpr int inverse_steps = 2;  // a small singular value stands out after one
    static constexpr Index few = 32;         // unknowns

    // As large as the rank may be.
    Index rank() const { return std::min(matrix_.rows(), matrix_.columns()); }

    // Applies reflection ``k`` to the columns of a matrix from number ``first`` on.
    void reflect(Index k, Matrix<double>& to, Index first) {
        const Index rows = to.rows(), columns = to.columns();
        for (Index j = first; j < columns; ++j) work_[j] = to(k, j);
        for (Index i = k + 1; i < rows; ++i) {
            for (Index j = first; j < columns; ++j) work_[j] += matrix_(i, k) * to(i, j);
        }
        for (Index j = first; j < columns; ++j) {
            work_[j] *= scale_[k];
            to(k, j) -= work_[j];
        }
        for (Index i = k + 1; i < rows; ++i) {
            for (Index j = first; j < columns; ++j) to(i, j) -= work_[j] * matrix_(i, k);
        }
    }

    Matrix<double> matrix_;
    std::vector<double> scale_;
    std::vector<double> inverse_diagonal_;  // of R, 0 where that is 0
    std::vector<double> work_;
    bool has_q_ = false;
    Matrix<double> q_;      // the reflections, multiplied out
    Matrix<double> upper_;  // R above its diagonal, transposed
};

// The least-squares solution of a system of any rank and shape by QR with column pivoting.
// Matrix and right-hand side are overwritten. Pivots below 1e-13 of the first count as zero,
// and so do the unknowns that they belong to.
inline void solve_by_rank(View<double> matrix, Vector<double> right, Vector<double> solution) {
    constexpr double negligible = 1e-13;
    const Index rows = matrix.rows, columns = matrix.columns;
    std::vector<Index> order(columns);
    std::iota(order.begin(), order.end(), Index{0});
    std::fill(solution.begin(), solution.end(), 0.0);
    std::vector<double> sums(columns), squares(columns);  // one a column, row by row: these lie in one piece
    Index rank = 0;
    double first = 0.0;
    for (Index i = 0; i < rows; ++i) {
        for (Index j = 0; j < columns; ++j) squares[j] += matrix(i, j) * matrix(i, j);
    }
    for (Index k = 0; k < std::min(rows, columns); ++k) {
        const Index best = std::max_element(squares.begin() + k, squares.end()) - squares.begin();
        const double norm = std::sqrt(squares[best]);
        first = std::max(first, norm);
        if (norm <= negligible * first) break;
        std::swap(order[k], order[best]);
        for (Index i = 0; i < rows; ++i) std::swap(matrix(i, k), matrix(i, best));
        const double diagonal = matrix(k, k) > 0.0 ? -norm : norm;
        const double pivot = matrix(k, k) - diagonal;
        const double scale = -pivot / diagonal;
        for (Index i = k + 1; i < rows; ++i) matrix(i, k) /= pivot;
        matrix(k, k) = diagonal;
        for (Index j = k + 1; j < columns; ++j) sums[j] = matrix(k, j);
        for (Index i = k + 1; i < rows; ++i) {
            const double entry = matrix(i, k);
            for (Index j = k + 1; j < columns; ++j) sums[j] += entry * matrix(i, j);
        }
        for (Index j = k + 1; j < columns; ++j) {
            sums[j] *= scale;
            matrix(k, j) -= sums[j];
            squares[j] = 0.0;
        }
        for (Index i = k + 1; i < rows; ++i) {
            const double entry = matrix(i, k);
            for (Index j = k + 1; j < columns; ++j) {
                matrix(i, j) -= sums[j] * entry;
                squares[j] += matrix(i, j) * matrix(i, j);
            }
        }
        double dot = right[k];
        for (Index i = k + 1; i < rows; ++i) dot += matrix(i, k) * right[i];
        dot *= scale;
        right[k] -= dot;
        for (Index i = k + 1; i < rows; ++i) right[i] -= dot * matrix(i, k);
        rank = k + 1;
    }
    for (Index k = rank - 1; k >= 0; --k) {
        double total = right[k];
        for (Index j = k + 1; j < rank; ++j) total -= matrix(k, j) * solution[order[j]];
        solution[order[k]] = total / matrix(k, k);
    }
}

// The step with (J^T J + damping) step = -J^T F, by Cholesky's factorisation; ``normal`` is
// room for J^T J.
inline void damped_step(View<const double> jacobian, Vector<const double> residual, double damping,
                        View<double> normal, Vector<double> step) {
    constexpr double smallest_pivot = 1e-300;
    const Index rows = jacobian.rows, n = jacobian.columns;
    for (Index i = 0; i < n; ++i) {
        for (Index j = 0; j <= i; ++j) {
            double total = i == j ? damping : 0.0;
            for (Index row = 0; row < rows; ++row) total += jacobian(row, i) * jacobian(row, j);
            normal(i, j) = total;
        }
        double total = 0.0;
        for (Index row = 0; row < rows; ++row) total -= jacobian(row, i) * residual[row];
        step[i] = total;
    }
    for (Index j = 0; j < n; ++j) {
        for (Index k = 0; k < j; ++k) {
            for (Index i = j; i < n; ++i) normal(i, j) -= normal(i, k) * normal(j, k);
        }
        const double pivot = std::sqrt(std::max(normal(j, j), smallest_pivot));
        for (Index i = j + 1; i < n; ++i) normal(i, j) /= pivot;
        normal(j, j) = pivot;
    }
    for (Index i = 0; i < n; ++i) {
        for (Index k = 0; k < i; ++k) step[i] -= normal(i, k) * step[k];
        step[i] /= normal(i, i);
    }
    for (Index i = n - 1; i >= 0; --i) {
        for (Index k = i + 1; k < n; ++k) step[i] -= normal(k, i) * step[k];
        step[i] /= normal(i, i);
    }
}

// The x of least |a x - b| for the columns of a small matrix a, real or complex, which are
// overwritten as b is: Gram-Schmidt with pivots. Directions of which the pivot is at most
// ``negligible`` of the first get no part.
template <class T, std::size_t rows, std::size_t n>
std::array<T, n> least_squares(std::array<std::array<T, rows>, n>& columns, std::array<T, rows>& right,
                               double negligible) {
    const auto subtract = [](std::array<T, rows>& from, const T& factor, const std::array<T, rows>& column) {
        for (std::size_t i = 0; i < rows; ++i) from[i] -= factor * column[i];
    };
    std::array<std::size_t, n> order;
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::array<double, n> diagonal;
    SmallMatrix<T, n, n> upper{};
    std::array<T, n> x{}, out{};
    std::size_t rank = n;
    double first = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
        std::size_t best = k;
        double largest = -1.0;
        for (std::size_t j = k; j < n; ++j) {
            const double square = squared_size(columns[j]);
            if (square > largest) {
                best = j;
                largest = square;
            }
        }
        const double size = std::sqrt(largest);
        first = std::max(first, size);
        if (size <= negligible * first) {
            rank = k;
            break;
        }
        std::swap(columns[k], columns[best]);
        std::swap(order[k], order[best]);
        for (std::size_t i = 0; i < k; ++i) std::swap(upper(i, k), upper(i, best));
        diagonal[k] = size;
        for (T& entry : columns[k]) entry /= size;
        x[k] = inner_product(columns[k], right);
        subtract(right, x[k], columns[k]);
        for (std::size_t j = k + 1; j < n; ++j) {
            upper(k, j) = inner_product(columns[k], columns[j]);
            subtract(columns[j], upper(k, j), columns[k]);
        }
    }
    for (std::size_t k = rank; k-- > 0;) {
        for (std::size_t j = k + 1; j < rank; ++j) x[k] -= upper(k, j) * x[j];
        x[k] /= diagonal[k];
        out[order[k]] = x[k];
    }
    return out;
}

}  // namespace bifurc
