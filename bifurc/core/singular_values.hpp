// Singular values of small matrices.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "bifurc/core/arrays.hpp"

namespace bifurc {

// One-sided Jacobi rotations on the columns of R, of a QR with column pivoting, or of its transpose: small singular
// values come out to high relative accuracy, and the same on every processor (Demmel and Veselic
// 1992; Golub and Van Loan 2013, 8.6.3).
class SingularValues {
public:
    SingularValues(Index rows, Index columns) : rows_(rows), columns_(columns), work_(0, 0) {
        // the rows of ``work_`` are orthogonalised: as few of them as there are singular values
        work_ = Matrix<double>(std::min(rows, columns), std::max(rows, columns));
    }

    // The singular values of ``matrix``, the largest first; none is a number where an entry is not.
    void of(View<const double> matrix, Vector<double> values) {
        const bool is_tall = rows_ >= columns_;
        for (Index i = 0; i < work_.rows(); ++i) {
            for (Index j = 0; j < work_.columns(); ++j) work_(i, j) = is_tall ? matrix(j, i) : matrix(i, j);
        }
        for (int sweep = 0; sweep < most_sweeps; ++sweep) {
            if (!rotate_all()) break;
        }
        for (Index i = 0; i < work_.rows(); ++i) values[i] = length(work_.row(i));
        std::sort(values.begin(), values.end(), std::greater<>());
    }

private:
    static constexpr int most_sweeps = 40;

    // One rotation for every pair of rows; whether any was needed.
    bool rotate_all() {
        bool has_turned = false;
        for (Index i = 0; i + 1 < work_.rows(); ++i) {
            for (Index j = i + 1; j < work_.rows(); ++j) has_turned = rotate(work_.row(i), work_.row(j)) || has_turned;
        }
        return has_turned;
    }

    static bool rotate(Vector<double> p, Vector<double> q) {
        const double alpha = squared_length(p), beta = squared_length(q);
        double gamma = 0.0;
        for (std::size_t k = 0; k < p.size(); ++k) gamma += p[k] * q[k];
        const double orthogonal = std::numeric_limits<double>::epsilon() * std::sqrt(alpha * beta);
        if (!(std::abs(gamma) > orthogonal)) return false;
        const double zeta = (beta - alpha) / (2.0 * gamma);
        const double tangent = std::copysign(1.0, zeta) / (std::abs(zeta) + std::sqrt(1.0 + zeta * zeta));
        const double cosine = 1.0 / std::sqrt(1.0 + tangent * tangent), sine = cosine * tangent;
        for (std::size_t k = 0; k < p.size(); ++k) {
            const double turned = cosine * p[k] - sine * q[k];
            q[k] = sine * p[k] + cosine * q[k];
            p[k] = turned;
        }
        return true;
    }

    Index rows_, columns_;
    Matrix<double> work_;
};

}  // namespace bifurc
