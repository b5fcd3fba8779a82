// Equations along whose solutions F' has a lower rank: `bifurc.curves.deflation.RankDeflated`.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "bifurc/core/equations.hpp"
#include "bifurc/core/singular_values.hpp"

namespace bifurc {

// F(u) = 0 and U^T F'(u) V = 0, with orthonormal bases U and V of the left and right singular vectors after number
// ``rank``, those at each point; for the derivative they are held. Not for two threads at once.
class RankDeflatedEquations : public Equations {
public:
    RankDeflatedEquations(const Equations& equations, Index rank)
        : equations_(equations), rank_(rank), n_(equations.unknowns()), values_(n_) {}

    Index unknowns() const override { return n_; }
    Index at_once() const override { return equations_.at_once(); }

    // Bases have signs of their own.
    bool is_continuous() const override { return false; }

    void fill(View<const double> points, bool has_jacobians, Values& values) const override {
        equations_.fill(points, true, values_);
        const Index m = values_.equations(), rights = n_ - rank_, lefts = std::max<Index>(m - rank_, 0);
        values.reserve(points.rows, m + lefts * rights, has_jacobians);
        SingularValues decomposition(m, n_);
        Matrix<double> singular(SingularValues::lanes, std::min(m, n_));
        for (Index k = 0; k < points.rows; ++k) {
            const Index lane = k % SingularValues::lanes;
            if (lane == 0) {
                const Index count = std::min(SingularValues::lanes, points.rows - k);
                decomposition.of({values_.jacobian(k).data, count * m, n_}, singular.view().first_rows(count));
            }
            const View<const double> jacobian = values_.jacobian(k);
            find_bases(decomposition, lane, singular.row(lane), jacobian);
            const Vector<double> residual = values.residual(k);
            std::copy_n(values_.residual(k).begin(), m, residual.begin());
            Matrix<double> images(rights, m);
            multiply(jacobian, images);
            for (Index a = 0; a < lefts; ++a) {
                for (Index b = 0; b < rights; ++b) residual[m + a * rights + b] = dot(left_.row(a), images.row(b));
            }
            if (has_jacobians) linearize(points.row(k), jacobian, values.jacobian(k));
        }
    }

    // Third derivatives would be needed.
    void bend(Vector<const double>, View<const double>, View<double>) const override {
        throw std::logic_error("deflated equations have no second derivatives");
    }

private:
    // Both bases, a vector a row.
    void find_bases(const SingularValues& decomposition, Index lane, Vector<const double> singular,
                    View<const double> jacobian) const {
        const Index m = jacobian.rows, count = std::min(m, n_);
        Index rank = 0;
        while (rank < std::min(rank_, count) && singular[rank] > rounding * singular[0]) ++rank;
        const Matrix<double> regular = decomposition.leading_vectors(lane, jacobian, rank);
        Matrix<double> images(rank, m);
        for (Index i = 0; i < rank; ++i) {
            for (Index row = 0; row < m; ++row) images(i, row) = dot(jacobian.row(row), regular.row(i));
            const double size = length(images.row(i));
            for (double& entry : images.row(i)) entry /= size;
        }
        right_ = complement(regular, n_ - rank_);
        left_ = complement(images, std::max<Index>(m - rank_, 0));
    }

    // Orthonormal rows (count, n) across orthonormal rows (r, n): from the axes that are farthest from these.
    static Matrix<double> complement(const Matrix<double>& rows, Index count) {
        const Index n = rows.columns(), r = rows.rows();
        Matrix<double> all(n, n);
        std::copy_n(rows.view().data, r * n, all.view().data);
        std::vector<double> left(n, 1.0);  // of each axis, of its squared length
        for (Index i = 0; i < n; ++i) {
            const Vector<double> row = all.row(i);
            if (i >= r) {
                const Index axis = std::max_element(left.begin(), left.end()) - left.begin();
                row[axis] = 1.0;
                for (int time = 0; time < 2; ++time) {  // twice is enough (Giraud and Langou 2002)
                    for (Index other = 0; other < i; ++other) {
                        const double part = dot(all.row(other), row);
                        for (Index j = 0; j < n; ++j) row[j] -= part * all(other, j);
                    }
                }
                const double size = length(row);
                for (double& entry : row) entry /= size;
            }
            for (Index j = 0; j < n; ++j) left[j] -= row[j] * row[j];
        }
        Matrix<double> last(count, n);
        std::copy_n(all.view().data + (n - count) * n, count * n, last.view().data);
        return last;
    }

    // F' V, transposed.
    void multiply(View<const double> jacobian, View<double> images) const {
        for (Index b = 0; b < images.rows; ++b) {
            for (Index row = 0; row < jacobian.rows; ++row) images(b, row) = dot(jacobian.row(row), right_.row(b));
        }
    }

    // F' and below it U^T F'' V.
    void linearize(Vector<const double> point, View<const double> jacobian, View<double> out) const {
        const Index m = jacobian.rows, rights = right_.rows();
        std::copy_n(jacobian.data, m * n_, out.data);
        std::fill(out.row(m).data(), out.data + out.rows * n_, 0.0);
        Matrix<double> bends(rights * m, n_);
        equations_.bend(point, right_, bends);
        for (Index a = 0; a < left_.rows(); ++a) {
            for (Index b = 0; b < rights; ++b) {
                const Vector<double> target = out.row(m + a * rights + b);
                for (Index row = 0; row < m; ++row) {
                    for (Index j = 0; j < n_; ++j) target[j] += left_(a, row) * bends(b * m + row, j);
                }
            }
        }
    }

    static constexpr double rounding = 1e-15;  // a singular value, over the largest, that has no vectors

    const Equations& equations_;
    Index rank_, n_;
    mutable Values values_;
    mutable Matrix<double> left_{0, 0}, right_{0, 0};
};

}  // namespace bifurc
