// Points corrected onto solutions of any dimension, straight to tangent spaces.
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "bifurc/core/equations.hpp"

namespace bifurc {

namespace corrections {
constexpr int most_steps = 20;
constexpr double settled = 1e-9;           // last step, over the scale
constexpr double exact = 1e-15;            // the step that would be next, over the scale
constexpr double farthest = 0.5;           // longest step, over the scale
constexpr double damping = 1e-14;          // of normal equations, over the largest squared singular value
constexpr double smallest_pivot = 1e-300;  // of their factor: its inverse is still a double
constexpr double tiny = 1e-300;            // keeps a step of no length from being divided by
}  // namespace corrections

// How a point was corrected: the residual that is left, over the magnitude, and the lengths of the first
// step, the second and the last; a step that was not needed has none.
struct Correction {
    double gap, first, second, last;

    // Whether the last step was too small to matter.
    bool is_settled(double scale) const { return last < corrections::settled * scale; }

    // Small where no other solution is near (Deuflhard 2004, section 2.1).
    double contraction() const { return second / std::max(first, corrections::tiny); }
};

// F'^T F' + T T^T, a little damped, factored for many residuals.
class NormalEquations {
public:
    // With F' (m, n) and a tangent space (n, d).
    void factor(View<const double> jacobian, View<const double> space) {
        const Index n = jacobian.columns;
        if (factor_.rows() != n) factor_ = Matrix<double>(n, n);
        jacobian_.assign(jacobian.data, jacobian.data + jacobian.rows * n);
        for (Index i = 0; i < n; ++i) {
            for (Index j = 0; j <= i; ++j) factor_(i, j) = dot(space.row(i), space.row(j));
            factor_(i, i) += corrections::damping;
        }
        for (Index row = 0; row < jacobian.rows; ++row) {
            const double* const entries = jacobian.row(row).data();
            for (Index i = 0; i < n; ++i) {
                const double entry = entries[i];
                if (entry == 0.0) continue;
                double* const target = factor_.row(i).data();
                for (Index j = 0; j <= i; ++j) target[j] += entry * entries[j];
            }
        }
        is_finite_ = true;
        for (Index i = 0; i < n; ++i) is_finite_ = is_finite_ && are_finite(factor_.row(i).first(i + 1));
        if (is_finite_) take_apart();
    }

    // The step (n) for a residual (m); none where F' is too large for its square to be a number.
    void solve(Vector<const double> residual, Vector<double> step) const {
        const Index n = factor_.rows();
        std::fill(step.begin(), step.end(), 0.0);
        for (std::size_t row = 0; row < residual.size(); ++row) {
            const double* const entries = jacobian_.data() + static_cast<Index>(row) * n;
            for (Index j = 0; j < n; ++j) step[j] -= entries[j] * residual[row];
        }
        if (!is_finite_ || !are_finite(step)) {
            std::fill(step.begin(), step.end(), 0.0);
            return;
        }
        for (Index i = 0; i < n; ++i) {
            for (Index k = 0; k < i; ++k) step[i] -= factor_(i, k) * step[k];
            step[i] /= factor_(i, i);
        }
        for (Index i = n - 1; i >= 0; --i) {
            step[i] /= factor_(i, i);
            for (Index k = 0; k < i; ++k) step[k] -= factor_(i, k) * step[i];
        }
    }

private:
    static bool are_finite(Vector<const double> values) {
        return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
    }

    // Cholesky's factor, row by row.
    void take_apart() {
        for (Index i = 0; i < factor_.rows(); ++i) {
            double* const row = factor_.row(i).data();
            for (Index j = 0; j <= i; ++j) {
                const double* const other = factor_.row(j).data();
                double total = row[j];
                for (Index k = 0; k < j; ++k) total -= row[k] * other[k];
                row[j] = i == j ? std::sqrt(std::max(total, corrections::smallest_pivot)) : total / other[j];
            }
        }
    }

    Matrix<double> factor_{0, 0};
    std::vector<double> jacobian_;
    bool is_finite_ = true;
};

// Gauss-Newton on [F'; T^T] d = [-F; 0] by normal equations: what a step loses to rounding the next one
// mends. A little damping keeps them regular at singular points. Every other step is made with the factor of the
// one before it, for which F is enough: two steps are of third order (Traub 1964, section 8.4). Not for two threads
// at once.
class NormalCorrector {
public:
    NormalCorrector(const Equations& equations, double scale)
        : equations_(equations), scale_(scale), n_(equations.unknowns()), values_(n_), step_(n_) {}

    double scale() const { return scale_; }

    // Corrects ``points`` (k, n) in place, each straight to its tangent space (n, d), which ``plane`` gives
    // by number.
    template <class PlaneOf>
    void correct(View<double> points, PlaneOf plane, std::vector<Correction>& out) {
        out.assign(points.rows, {});
        const Index at_once = equations_.at_once();
        for (Index begin = 0; begin < points.rows; begin += at_once) {
            const Index count = std::min(at_once, points.rows - begin);
            unsettled_.resize(count);
            if (static_cast<Index>(normal_.size()) < count) normal_.resize(count);
            std::iota(unsettled_.begin(), unsettled_.end(), begin);
            for (int number = 0; number < corrections::most_steps && !unsettled_.empty(); ++number) {
                step_all(points, plane, begin, number, out);
            }
            equations_.fill({points.row(begin).data(), count, n_}, false, values_);
            for (Index i = 0; i < count; ++i) out[begin + i].gap = length(values_.residual(i));
        }
    }

private:
    // One step of each of the points from ``begin`` on that is not settled.
    template <class PlaneOf>
    void step_all(View<double> points, PlaneOf plane, Index begin, int number, std::vector<Correction>& out) {
        const auto count = static_cast<Index>(unsettled_.size());
        const bool is_fresh = number % 2 == 0 || !equations_.is_continuous();
        at_.resize(count * n_);
        const View<double> at{at_.data(), count, n_};
        for (Index i = 0; i < count; ++i) {
            const Vector<double> point = points.row(unsettled_[i]);
            std::copy(point.begin(), point.end(), at.row(i).begin());
        }
        equations_.fill(at, is_fresh, values_);
        std::size_t left = 0;
        for (Index i = 0; i < count; ++i) {
            const Index k = unsettled_[i];
            NormalEquations& normal = normal_[k - begin];
            if (is_fresh) normal.factor(values_.jacobian(i), plane(k));
            normal.solve(values_.residual(i), step_);
            const double size = length(step_);
            const double share = std::min(1.0, corrections::farthest * scale_ / (size + corrections::tiny));
            for (Index j = 0; j < n_; ++j) points(k, j) += share * step_[j];
            Correction& correction = out[k];
            const double next = is_fresh ? 0.0 : size * size / std::max(correction.last, corrections::tiny);
            correction.last = size;
            if (number == 0) correction.first = size;
            if (number == 1) correction.second = size;
            if (!correction.is_settled(scale_) || next > corrections::exact * scale_) unsettled_[left++] = k;
        }
        unsettled_.resize(left);
    }

    const Equations& equations_;
    double scale_;
    Index n_;
    Values values_;
    std::vector<double> step_, at_;
    std::vector<Index> unsettled_;
    std::vector<NormalEquations> normal_;
};

}  // namespace bifurc
