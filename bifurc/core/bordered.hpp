// The bordered matrix [F'; t], factored for many right-hand sides: of a tangent t, what is solved
// with it are corrections across a curve and its series.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "bifurc/core/block_tree.hpp"
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
//
// Many unknowns are solved block by block where every block of equations leaves one freedom, else by QR of
// the whole, which fills.
class SparseBordered {
public:
    explicit SparseBordered(const Sparsity& sparsity)
        : sparsity_(sparsity),
          equations_(sparsity.pattern.rows()),
          entries_(sparsity.pattern.entries.size()),
          tangent_(sparsity.pattern.columns),
          null_(sparsity.pattern.columns),
          vector_(sparsity.pattern.columns) {
        if (sparsity.pattern.columns < many) return;
        tree_.emplace(sparsity.pattern);
        if (!tree_->may_hold()) tree_.reset();
    }

    // The entries of F' in the order of its pattern, to be filled before `factor`.
    Vector<double> jacobian() { return entries_; }

    void factor(Vector<const double> tangent) {
        std::copy(tangent.begin(), tangent.end(), tangent_.begin());
        const SingleEntry border{largest_entry(tangent), 1.0};
        is_tree_ = tree_ && tree_->factor(entries_, border.column);
        if (!is_tree_) {
            if (!qr_) qr_.emplace(sparsity_);
            qr_->factor(entries_, std::span(&border, 1));
        }
        std::vector<double> right(equations_ + 1, 0.0);
        right[equations_] = 1.0;
        solve_at_entry(right, null_);
        along_ = dot(tangent_, null_);
    }

    // Nothing: reflections are sparse, their product is not.
    void prepare_for_many() {}

    // The solution (n), of least squares in the rows of F', for a right-hand side (m + 1), which is
    // overwritten; block by block of least squares where they agree.
    void solve(Vector<double> right, Vector<double> solution) const {
        const double along = right[equations_];
        right[equations_] = 0.0;
        solve_at_entry(right, solution);
        const double missing = (along - dot(tangent_, solution)) / along_;
        for (std::size_t j = 0; j < solution.size(); ++j) solution[j] += missing * null_[j];
    }

    // The smallest singular value of F' across its null vector, about: by inverse iteration.
    double smallest_singular_value() {
        for (std::size_t j = 0; j < vector_.size(); ++j) vector_[j] = 1.0 + 0.1 * static_cast<double>(j % variety);
        double norm = length(vector_);
        for (int iteration = 0; iteration < inverse_steps; ++iteration) {
            for (double& entry : vector_) entry /= norm;
            leave_null_vector();
            if (!solve_normal()) return 0.0;
            leave_null_vector();
            norm = length(vector_);
        }
        return 1.0 / std::sqrt(norm);
    }

private:
    static constexpr int inverse_steps = 2;  // a small singular value stands out after one
    static constexpr int variety = 7;        // entries of the vector from which it starts
    static constexpr Index many = 400;       // unknowns, of which the triangle R has many more entries than F'
    static constexpr int smoothing_steps = 40;
    static constexpr double rounding = 1e-15;  // of F' x, over x

    static double dot(Vector<const double> a, Vector<const double> b) {
        double total = 0.0;
        for (std::size_t j = 0; j < a.size(); ++j) total += a[j] * b[j];
        return total;
    }

    static Index largest_entry(Vector<const double> vector) {
        const auto is_smaller = [](double a, double b) { return std::abs(a) < std::abs(b); };
        return std::max_element(vector.begin(), vector.end(), is_smaller) - vector.begin();
    }

    // With the unit vector of the largest entry of the tangent in the place of that, in the least-squares sense.
    void solve_at_entry(Vector<double> right, Vector<double> solution) const {
        if (!is_tree_) {
            qr_->solve(right, solution);
            return;
        }
        tree_->solve(right, right[equations_], solution);
        smooth(right.first(equations_), solution);
    }

    // Some steps of conjugate gradients for the least squares of F' x - right (Bjorck 1996), from x on. What rounding
    // leaves along a tree is large only in equations that it does not need, and these soon share it with all others.
    void smooth(Vector<const double> right, Vector<double> x) const {
        std::vector<double> left(equations_), image(equations_), gradient(x.size()), direction(x.size(), 0.0);
        multiply(x, left);
        for (Index row = 0; row < equations_; ++row) left[row] = right[row] - left[row];
        const double enough = squared_length(x) * rounding * rounding;
        double before = 0.0;
        for (int step = 0; step < smoothing_steps && squared_length(left) > enough; ++step) {
            multiply_transposed(left, gradient);
            const double now = squared_length(gradient);
            const double turn = before > 0.0 ? now / before : 0.0;
            before = now;
            for (std::size_t j = 0; j < x.size(); ++j) direction[j] = gradient[j] + turn * direction[j];
            multiply(direction, image);
            const double length = squared_length(image);
            if (!(length > 0.0)) return;
            for (std::size_t j = 0; j < x.size(); ++j) x[j] += now / length * direction[j];
            for (Index row = 0; row < equations_; ++row) left[row] -= now / length * image[row];
        }
    }

    void multiply(Vector<const double> x, Vector<double> out) const {
        const SparsityPattern& pattern = sparsity_.pattern;
        for (Index row = 0; row < equations_; ++row) {
            out[row] = 0.0;
            for (Index i = pattern.starts[row]; i < pattern.starts[row + 1]; ++i) {
                out[row] += entries_[i] * x[pattern.entries[i]];
            }
        }
    }

    void multiply_transposed(Vector<const double> y, Vector<double> out) const {
        const SparsityPattern& pattern = sparsity_.pattern;
        std::fill(out.begin(), out.end(), 0.0);
        for (Index row = 0; row < equations_; ++row) {
            for (Index i = pattern.starts[row]; i < pattern.starts[row + 1]; ++i) {
                out[pattern.entries[i]] += entries_[i] * y[row];
            }
        }
    }

    // Takes its part along the null vector from the vector, which is in the order of elimination where there is one.
    void leave_null_vector() {
        const auto place_of = [&](Index column) { return is_tree_ ? column : sparsity_.order().place(column); };
        const Index n = sparsity_.pattern.columns;
        double along = 0.0;
        for (Index column = 0; column < n; ++column) along += vector_[place_of(column)] * null_[column];
        along /= squared_length(null_);
        for (Index column = 0; column < n; ++column) vector_[place_of(column)] -= along * null_[column];
    }

    // Overwrites the vector by the inverse of F'^T F' across the null vector times it; false where there is none.
    bool solve_normal() {
        if (!is_tree_) return qr_->solve_normal(vector_);
        std::vector<double> right(equations_ + 1, 0.0);
        tree_->solve_transposed(vector_, Vector<double>(right).first(equations_));
        tree_->solve(right, 0.0, vector_);
        return true;
    }

    const Sparsity& sparsity_;
    const Index equations_;
    std::vector<double> entries_;
    std::optional<BlockTree> tree_;
    std::optional<SparseQr> qr_;  // made where it is needed
    bool is_tree_ = false;
    std::vector<double> tangent_, null_, vector_;
    double along_ = 0.0;  // of the null vector, on the tangent
};

}  // namespace bifurc
