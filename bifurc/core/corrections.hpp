// Points corrected onto solutions of any dimension, straight to tangent spaces.
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "bifurc/core/equations.hpp"

namespace bifurc {

namespace corrections {
constexpr int most_steps = 10;
constexpr double settled = 1e-9;           // last step, over the scale
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

// Gauss-Newton on [F'; T^T] d = [-F; 0] by normal equations: what a step loses to rounding the next one
// mends. A little damping keeps them regular at singular points. Not for two threads at once.
class NormalCorrector {
public:
    NormalCorrector(const Equations& equations, double scale)
        : equations_(equations),
          scale_(scale),
          n_(equations.unknowns()),
          values_(n_),
          normal_(n_, n_),
          step_(n_) {}

    double scale() const { return scale_; }

    // Corrects ``points`` (k, n) in place, each straight to its tangent space (n, d), which ``plane`` gives
    // by number.
    template <class PlaneOf>
    void correct(View<double> points, PlaneOf plane, std::vector<Correction>& out) {
        out.assign(points.rows, {});
        const Index at_once = equations_.at_once();
        for (Index begin = 0; begin < points.rows; begin += at_once) {
            unsettled_.resize(std::min(at_once, points.rows - begin));
            std::iota(unsettled_.begin(), unsettled_.end(), begin);
            for (int number = 0; number < corrections::most_steps && !unsettled_.empty(); ++number) {
                step_all(points, plane, number, out);
            }
            const Index count = std::min(at_once, points.rows - begin);
            equations_.fill({points.row(begin).data(), count, n_}, false, values_);
            for (Index i = 0; i < count; ++i) out[begin + i].gap = length(values_.residual(i));
        }
    }

private:
    // One step of each point that is not settled.
    template <class PlaneOf>
    void step_all(View<double> points, PlaneOf plane, int number, std::vector<Correction>& out) {
        const auto count = static_cast<Index>(unsettled_.size());
        at_.resize(count * n_);
        const View<double> at{at_.data(), count, n_};
        for (Index i = 0; i < count; ++i) {
            const Vector<double> point = points.row(unsettled_[i]);
            std::copy(point.begin(), point.end(), at.row(i).begin());
        }
        equations_.fill(at, true, values_);
        std::size_t left = 0;
        for (Index i = 0; i < count; ++i) {
            const Index k = unsettled_[i];
            solve(values_.jacobian(i), values_.residual(i), plane(k));
            const double size = length(step_);
            const double share = std::min(1.0, corrections::farthest * scale_ / (size + corrections::tiny));
            for (Index j = 0; j < n_; ++j) points(k, j) += share * step_[j];
            Correction& correction = out[k];
            correction.last = size;
            if (number == 0) correction.first = size;
            if (number == 1) correction.second = size;
            if (!correction.is_settled(scale_)) unsettled_[left++] = k;
        }
        unsettled_.resize(left);
    }

    // The step with (F'^T F' + T T^T + damping) step = -F'^T F; none where F' is too large for its square
    // to be a number.
    void solve(View<const double> jacobian, Vector<const double> residual, View<const double> plane) {
        for (Index i = 0; i < n_; ++i) {
            for (Index j = 0; j <= i; ++j) normal_(i, j) = dot(plane.row(i), plane.row(j));
            normal_(i, i) += corrections::damping;
        }
        std::fill(step_.begin(), step_.end(), 0.0);
        for (Index row = 0; row < jacobian.rows; ++row) {
            const double* const entries = jacobian.row(row).data();
            const double rest = residual[row];
            for (Index i = 0; i < n_; ++i) {
                const double entry = entries[i];
                if (entry == 0.0) continue;
                double* const target = normal_.row(i).data();
                for (Index j = 0; j <= i; ++j) target[j] += entry * entries[j];
                step_[i] -= entry * rest;
            }
        }
        if (!is_finite()) {
            std::fill(step_.begin(), step_.end(), 0.0);
            return;
        }
        factor();
        substitute();
    }

    bool is_finite() const {
        for (Index i = 0; i < n_; ++i) {
            if (!std::isfinite(step_[i])) return false;
            for (Index j = 0; j <= i; ++j) {
                if (!std::isfinite(normal_(i, j))) return false;
            }
        }
        return true;
    }

    // Cholesky's factor, row by row.
    void factor() {
        for (Index i = 0; i < n_; ++i) {
            double* const row = normal_.row(i).data();
            for (Index j = 0; j <= i; ++j) {
                const double* const other = normal_.row(j).data();
                double total = row[j];
                for (Index k = 0; k < j; ++k) total -= row[k] * other[k];
                row[j] = i == j ? std::sqrt(std::max(total, corrections::smallest_pivot)) : total / other[j];
            }
        }
    }

    void substitute() {
        for (Index i = 0; i < n_; ++i) {
            for (Index k = 0; k < i; ++k) step_[i] -= normal_(i, k) * step_[k];
            step_[i] /= normal_(i, i);
        }
        for (Index i = n_ - 1; i >= 0; --i) {
            step_[i] /= normal_(i, i);
            for (Index k = 0; k < i; ++k) step_[k] -= normal_(i, k) * step_[i];
        }
    }

    const Equations& equations_;
    double scale_;
    Index n_;
    Values values_;
    Matrix<double> normal_;
    std::vector<double> step_, at_;
    std::vector<Index> unsettled_;
};

}  // namespace bifurc
