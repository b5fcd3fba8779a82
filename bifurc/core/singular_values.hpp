// Singular values of small matrices.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "bifurc/core/arrays.hpp"

namespace bifurc {

// QR with column pivoting, then one-sided Jacobi rotations on the rows of R, which are graded by
// then: two or three sweeps are enough. Small singular values come out to high relative accuracy,
// and the same on every processor (Drmac and Veselic 2008; Golub and Van Loan 2013, 8.6.3).
//
// Four matrices are taken abreast, which changes no bit: a rotation waits for its square roots and
// quotients.
class SingularValues {
public:
    static constexpr Index lanes = 4;

    SingularValues(Index rows, Index columns)
        : is_tall_(rows >= columns),
          work_(std::max(rows, columns), std::min(rows, columns)),
          rows_of_r_(work_.columns(), work_.columns()),
          squares_(work_.columns()),
          columns_(work_.columns()) {}

    // The singular values of up to four matrices (count * rows, columns), one below the other: a row
    // (count, min(rows, columns)) for each, the largest first; not numbers where an entry is none.
    void of(View<const double> matrices, View<double> values) {
        const Index count = values.rows;
        const Index rows = is_tall_ ? work_.rows() : work_.columns();
        std::array<double, lanes> units{};
        for (Index lane = 0; lane < count; ++lane) {
            const double* const begin = matrices.data + lane * rows * matrices.columns;
            units[lane] = take({begin, rows, matrices.columns}, lane);
        }
        for (Index lane = count; lane < lanes; ++lane) clear(lane);
        triangularise();
        for (int sweep = 0; sweep < most_sweeps; ++sweep) {
            if (!rotate_all()) break;
        }
        for (Index i = 0; i < rows_of_r_.rows(); ++i) squares_[i] = squared_lengths(i);
        for (Index lane = 0; lane < count; ++lane) {
            const Vector<double> row = values.row(lane);
            for (Index i = 0; i < rows_of_r_.rows(); ++i) row[i] = units[lane] * std::sqrt(squares_[i][lane]);
            std::sort(row.begin(), row.end(), std::greater<>());
        }
    }

    // The rate of singular value ``number``, counted from 0, of matrix ``lane`` of those that were taken
    // apart last, where it changes by ``change``: l^T change r with its singular vectors. 0 for a value
    // of 0, which has none; its square does not change at first order.
    double rate(Index lane, Index number, View<const double> matrix, View<const double> change) const {
        const Index row = row_of(number, lane);
        if (!(squares_[row][lane] > 0.0)) return 0.0;
        const std::vector<double> vector = vector_of(row, lane);
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

    // The unit vector (columns) of the null space of matrix ``lane`` of those that were taken apart last
    // that is nearest to ``along``: the null space is that of the smallest singular value, and of those
    // below ``negligible`` of the largest. Where ``along`` is empty or has less than ``agreeing`` of its
    // length in it, another vector of the null space.
    std::vector<double> null_vector(Index lane, View<const double> matrix, Vector<const double> along,
                                    double negligible, double agreeing) const {
        const Matrix<double> regular = regular_vectors(lane, matrix, negligible);
        std::vector<double> vector(along.begin(), along.end());
        if (!along.empty() && leave_null_space(regular, vector) > agreeing * length(along)) return vector;
        // a vector that no symmetry puts across the null space; then the axes, one of which is not
        vector.resize(matrix.columns);
        for (Index j = 0; j < matrix.columns; ++j) vector[j] = std::cos(1.0 + static_cast<double>(j));
        double part = leave_null_space(regular, vector);
        for (Index j = 0; j < matrix.columns && !(part > agreeing); ++j) {
            std::fill(vector.begin(), vector.end(), 0.0);
            vector[j] = 1.0;
            part = leave_null_space(regular, vector);
        }
        return vector;
    }

    // The right singular vectors (count, columns) of the ``count`` largest singular values of matrix ``lane`` of
    // those that were taken apart last, none of which is zero.
    Matrix<double> leading_vectors(Index lane, View<const double> matrix, Index count) const {
        Matrix<double> vectors(count, matrix.columns);
        for (Index number = 0; number < count; ++number) {
            const std::vector<double> right = right_vector_of(row_of(number, lane), lane, matrix);
            std::copy(right.begin(), right.end(), vectors.row(number).begin());
        }
        return vectors;
    }

private:
    using Abreast = std::array<double, lanes>;  // a number of each matrix
    static constexpr int most_sweeps = 40;

    // The singular vector that row ``row`` of R is, over its length, its entries pivoted: on the right of
    // a tall matrix, on the left of another.
    std::vector<double> vector_of(Index row, Index lane) const {
        const double size = std::sqrt(squares_[row][lane]);
        std::vector<double> vector(columns_.size());
        for (std::size_t k = 0; k < columns_.size(); ++k) {
            vector[columns_[k][lane]] = rows_of_r_(row, static_cast<Index>(k))[lane] / size;
        }
        return vector;
    }

    // The right singular vectors (r, columns) across the null space.
    Matrix<double> regular_vectors(Index lane, View<const double> matrix, double negligible) const {
        const Index rows = rows_of_r_.rows();
        double largest = 0.0, least = std::numeric_limits<double>::infinity();
        for (Index i = 0; i < rows; ++i) {
            largest = std::max(largest, squares_[i][lane]);
            least = std::min(least, squares_[i][lane]);
        }
        // a wide matrix has as many singular values of 0 as there are further columns
        const double smallest = matrix.columns > rows ? 0.0 : least;
        const double zero = std::max(smallest, negligible * negligible * largest);
        std::vector<Index> kept;
        for (Index i = 0; i < rows; ++i) {
            if (squares_[i][lane] > zero) kept.push_back(i);
        }
        Matrix<double> vectors(static_cast<Index>(kept.size()), matrix.columns);
        for (Index i = 0; i < vectors.rows(); ++i) {
            const std::vector<double> right = right_vector_of(kept[i], lane, matrix);
            std::copy(right.begin(), right.end(), vectors.row(i).begin());
        }
        return vectors;
    }

    // The right singular vector (columns) that belongs to row ``row`` of R, which is not zero.
    std::vector<double> right_vector_of(Index row, Index lane, View<const double> matrix) const {
        const std::vector<double> vector = vector_of(row, lane);
        if (is_tall_) return vector;
        std::vector<double> right(matrix.columns);
        for (Index i = 0; i < matrix.rows; ++i) {
            for (Index j = 0; j < matrix.columns; ++j) right[j] += vector[i] * matrix(i, j);
        }
        double largest_entry = 0.0;  // its square may be no number
        for (double entry : right) largest_entry = std::max(largest_entry, std::abs(entry));
        for (double& entry : right) entry /= largest_entry;
        const double size = length(right);
        for (double& entry : right) entry /= size;
        return right;
    }

    // Takes from ``vector`` what it has along orthonormal rows, and divides it by the length that is
    // left, which is given back. Twice is enough (Giraud and Langou 2002).
    static double leave_null_space(const Matrix<double>& regular, Vector<double> vector) {
        for (int time = 0; time < 2; ++time) {
            for (Index i = 0; i < regular.rows(); ++i) {
                const Vector<const double> row = regular.row(i);
                double part = 0.0;
                for (std::size_t j = 0; j < vector.size(); ++j) part += row[j] * vector[j];
                for (std::size_t j = 0; j < vector.size(); ++j) vector[j] -= part * row[j];
            }
        }
        const double size = length(vector);
        for (double& entry : vector) entry /= size;
        return size;
    }

    // The row of R that is singular value ``number`` of a lane.
    Index row_of(Index number, Index lane) const {
        std::vector<Index> order(rows_of_r_.rows());
        for (Index i = 0; i < rows_of_r_.rows(); ++i) order[i] = i;
        std::sort(order.begin(), order.end(), [&](Index i, Index j) { return squares_[i][lane] > squares_[j][lane]; });
        return order[number];
    }

    // Fills the work of a lane with a matrix, all divided by its largest entry, which is given back: squares
    // are not to underflow.
    double take(View<const double> matrix, Index lane) {
        double largest = 0.0;
        for (Index i = 0; i < matrix.rows; ++i) {
            for (double entry : matrix.row(i)) largest = std::max(largest, std::abs(entry));
        }
        const double unit = largest > 0.0 ? largest : 1.0;
        for (Index i = 0; i < work_.rows(); ++i) {
            for (Index j = 0; j < work_.columns(); ++j) {
                work_(i, j)[lane] = (is_tall_ ? matrix(i, j) : matrix(j, i)) / unit;
            }
        }
        return unit;
    }

    void clear(Index lane) {
        for (Index i = 0; i < work_.rows(); ++i) {
            for (Index j = 0; j < work_.columns(); ++j) work_(i, j)[lane] = 0.0;
        }
    }

    // R of a QR with column pivoting, by Householder reflections.
    void triangularise() {
        const Index rows = work_.rows(), columns = work_.columns();
        for (Index k = 0; k < columns; ++k) columns_[k].fill(k);
        for (Index k = 0; k < columns; ++k) {
            const Abreast squares = pivot(k);
            Abreast diagonal, head, divisor;
            for (Index lane = 0; lane < lanes; ++lane) {
                const double norm = std::sqrt(squares[lane]);
                diagonal[lane] = work_(k, k)[lane] > 0.0 ? -norm : norm;
                head[lane] = work_(k, k)[lane] - diagonal[lane];
                // nothing is left of a column of zeros, nor of those after it
                divisor[lane] = norm != 0.0 ? diagonal[lane] * head[lane] : 1.0;
            }
            for (Index j = k + 1; j < columns; ++j) {
                Abreast share;
                for (Index lane = 0; lane < lanes; ++lane) share[lane] = head[lane] * work_(k, j)[lane];
                for (Index i = k + 1; i < rows; ++i) {
                    for (Index lane = 0; lane < lanes; ++lane) share[lane] += work_(i, k)[lane] * work_(i, j)[lane];
                }
                for (Index lane = 0; lane < lanes; ++lane) {
                    share[lane] /= divisor[lane];
                    work_(k, j)[lane] += share[lane] * head[lane];
                }
                for (Index i = k + 1; i < rows; ++i) {
                    for (Index lane = 0; lane < lanes; ++lane) work_(i, j)[lane] += share[lane] * work_(i, k)[lane];
                }
            }
            for (Index j = 0; j < columns; ++j) rows_of_r_(k, j) = j > k ? work_(k, j) : Abreast{};
            rows_of_r_(k, k) = diagonal;
        }
    }

    // Brings the column that is longest from row k on to place k, lane by lane; gives back the squares of
    // its length.
    Abreast pivot(Index k) {
        std::array<Index, lanes> best;
        Abreast largest;
        best.fill(k);
        largest.fill(-1.0);
        for (Index j = k; j < work_.columns(); ++j) {
            Abreast square{};
            for (Index i = k; i < work_.rows(); ++i) {
                for (Index lane = 0; lane < lanes; ++lane) square[lane] += work_(i, j)[lane] * work_(i, j)[lane];
            }
            for (Index lane = 0; lane < lanes; ++lane) {
                if (!(square[lane] > largest[lane])) continue;
                largest[lane] = square[lane];
                best[lane] = j;
            }
        }
        for (Index lane = 0; lane < lanes; ++lane) {
            const Index other = best[lane];
            if (other == k) continue;
            std::swap(columns_[k][lane], columns_[other][lane]);
            for (Index i = 0; i < work_.rows(); ++i) std::swap(work_(i, k)[lane], work_(i, other)[lane]);
            for (Index i = 0; i < k; ++i) std::swap(rows_of_r_(i, k)[lane], rows_of_r_(i, other)[lane]);
        }
        return largest;
    }

    // Of row i, in every lane.
    Abreast squared_lengths(Index i) const {
        Abreast total{};
        for (Index k = 0; k < rows_of_r_.columns(); ++k) {
            const Abreast entries = rows_of_r_(i, k);
            for (Index lane = 0; lane < lanes; ++lane) total[lane] += entries[lane] * entries[lane];
        }
        return total;
    }

    // One rotation for every pair of rows; whether any was needed.
    bool rotate_all() {
        for (Index i = 0; i < rows_of_r_.rows(); ++i) squares_[i] = squared_lengths(i);
        bool has_turned = false;
        for (Index i = 0; i + 1 < rows_of_r_.rows(); ++i) {
            for (Index j = i + 1; j < rows_of_r_.rows(); ++j) has_turned = rotate(i, j) || has_turned;
        }
        return has_turned;
    }

    // Turns rows i and j to right angles, in the lanes where they are not.
    bool rotate(Index i, Index j) {
        const Vector<Abreast> p = rows_of_r_.row(i), q = rows_of_r_.row(j);
        Abreast gamma{};
        for (std::size_t k = 0; k < p.size(); ++k) {
            for (Index lane = 0; lane < lanes; ++lane) gamma[lane] += p[k][lane] * q[k][lane];
        }
        Abreast cosine, sine;
        std::array<bool, lanes> turns;
        for (Index lane = 0; lane < lanes; ++lane) {
            const double orthogonal =
                std::numeric_limits<double>::epsilon() * std::sqrt(squares_[i][lane] * squares_[j][lane]);
            turns[lane] = std::abs(gamma[lane]) > orthogonal;
        }
        if (std::none_of(turns.begin(), turns.end(), std::identity())) return false;
        for (Index lane = 0; lane < lanes; ++lane) {
            const double zeta = (squares_[j][lane] - squares_[i][lane]) / (2.0 * gamma[lane]);
            const double tangent = std::copysign(1.0, zeta) / (std::abs(zeta) + std::sqrt(1.0 + zeta * zeta));
            cosine[lane] = 1.0 / std::sqrt(1.0 + tangent * tangent);
            sine[lane] = cosine[lane] * tangent;
        }
        for (Index lane = 0; lane < lanes; ++lane) {
            if (turns[lane]) continue;
            cosine[lane] = 1.0;
            sine[lane] = 0.0;
        }
        Abreast first{}, second{};
        for (std::size_t k = 0; k < p.size(); ++k) {
            for (Index lane = 0; lane < lanes; ++lane) {
                const double turned = cosine[lane] * p[k][lane] - sine[lane] * q[k][lane];
                const double other = sine[lane] * p[k][lane] + cosine[lane] * q[k][lane];
                p[k][lane] = turned;
                q[k][lane] = other;
                first[lane] += turned * turned;
                second[lane] += other * other;
            }
        }
        squares_[i] = first;
        squares_[j] = second;
        return true;
    }

    bool is_tall_;
    Matrix<Abreast> work_;
    Matrix<Abreast> rows_of_r_;
    std::vector<Abreast> squares_;
    std::vector<std::array<Index, lanes>> columns_;  // of the matrices, in the order of the columns of R
};

}  // namespace bifurc
