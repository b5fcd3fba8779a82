// The bordered matrix [F'; t], factored for many right-hand sides: of a tangent t, what is solved
// with it are corrections across a curve and its series.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "bifurc/core/least_squares.hpp"
#include "bifurc/core/sparse_qr.hpp"

namespace bifurc {

// Of a dense F' (m, n): QR of the whole.
class DenseBordered {
public:
    DenseBordered(Index equations, Index unknowns)
        : jacobian_(equations, unknowns), factorization_(equations + 1, unknowns) {}

    // F', to be filled before `factor`.
    View<double> jacobian() { return jacobian_; }

    void factor(Vector<const double> tangent) {
        const Index m = jacobian_.rows(), n = jacobian_.columns();
        const View<double> matrix = factorization_.matrix();
        for (Index row = 0; row < m; ++row) {
            for (Index j = 0; j < n; ++j) matrix(row, j) = jacobian_(row, j);
        }
        for (Index j = 0; j < n; ++j) matrix(m, j) = tangent[j];
        factorization_.factor();
    }

    // Makes what many solutions need, once.
    void prepare_for_many() { factorization_.prepare_for_many(); }

    // The least-squares solution (n) for a right-hand side (m + 1), which is overwritten.
    void solve(Vector<double> right, Vector<double> solution) const { factorization_.solve(right, solution); }

    // The smallest singular value, about.
    double smallest_singular_value() { return factorization_.smallest_singular_value(); }

private:
    Matrix<double> jacobian_;
    Factorization factorization_;
};

// Of a sparse F'. A full row t would fill R; in its place stands the unit vector e of its largest
// entry, which fills nothing. With the null vector v of F', F' v = 0 and e . v = 1, a solution d of
// the rows of F' becomes one of all, d + c v, where t . (d + c v) is what it has to be.
class SparseBordered {
public:
    explicit SparseBordered(const Sparsity& sparsity)
        : order_(sparsity.order),
          equations_(sparsity.pattern.rows()),
          entries_(sparsity.pattern.entries.size()),
          qr_(sparsity),
          tangent_(sparsity.pattern.columns),
          null_(sparsity.pattern.columns),
          vector_(sparsity.pattern.columns) {}

    // The entries of F' in the order of its pattern, to be filled before `factor`.
    Vector<double> jacobian() { return entries_; }

    void factor(Vector<const double> tangent) {
        std::copy(tangent.begin(), tangent.end(), tangent_.begin());
        const SingleEntry border{largest_entry(tangent), 1.0};
        qr_.factor(entries_, std::span(&border, 1));
        std::vector<double> right(equations_ + 1, 0.0);
        right[equations_] = 1.0;
        qr_.solve(right, null_);
        along_ = dot(tangent_, null_);
    }

    // Nothing: reflections are sparse, their product is not.
    void prepare_for_many() {}

    // The solution (n), of least squares in the rows of F', for a right-hand side (m + 1), which is
    // overwritten.
    void solve(Vector<double> right, Vector<double> solution) const {
        const double along = right[equations_];
        right[equations_] = 0.0;
        qr_.solve(right, solution);
        const double missing = (along - dot(tangent_, solution)) / along_;
        for (std::size_t j = 0; j < solution.size(); ++j) solution[j] += missing * null_[j];
    }

    // The smallest singular value of F' across its null vector, about: by inverse iteration.
    double smallest_singular_value() {
        const Index n = order_.size();
        for (Index j = 0; j < n; ++j) vector_[j] = 1.0 + 0.1 * static_cast<double>(j % variety);
        double norm = length(vector_);
        for (int iteration = 0; iteration < inverse_steps; ++iteration) {
            for (double& entry : vector_) entry /= norm;
            leave_null_vector();
            if (!qr_.solve_normal(vector_)) return 0.0;
            leave_null_vector();
            norm = length(vector_);
        }
        return 1.0 / std::sqrt(norm);
    }

private:
    static constexpr int inverse_steps = 2;  // a small singular value stands out after one
    static constexpr int variety = 7;        // entries of the vector from which it starts

    static double dot(Vector<const double> a, Vector<const double> b) {
        double total = 0.0;
        for (std::size_t j = 0; j < a.size(); ++j) total += a[j] * b[j];
        return total;
    }

    static Index largest_entry(Vector<const double> vector) {
        const auto is_smaller = [](double a, double b) { return std::abs(a) < std::abs(b); };
        return std::max_element(vector.begin(), vector.end(), is_smaller) - vector.begin();
    }

    // Takes its part along the null vector from the vector, which is in the order of elimination.
    void leave_null_vector() {
        double along = 0.0;
        for (Index place = 0; place < order_.size(); ++place) along += vector_[place] * null_[order_.column(place)];
        along /= squared_length(null_);
        for (Index place = 0; place < order_.size(); ++place) vector_[place] -= along * null_[order_.column(place)];
    }

    const ColumnOrder& order_;
    const Index equations_;
    std::vector<double> entries_;
    SparseQr qr_;
    std::vector<double> tangent_, null_, vector_;
    double along_ = 0.0;  // of the null vector, on the tangent
};

}  // namespace bifurc
