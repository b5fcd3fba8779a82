// Points of a curve at the nodes of a piece: what `bifurc.numerics.collocation` interpolates.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "bifurc/core/bordered.hpp"

namespace bifurc {

// Where points are wanted: at ``offsets`` (k), from 0 on, along a unit ``heading`` (n) from a point ``start``
// (n). Row i of ``predictors`` (k, k) has the weights by which the points before number i predict it.
// A correction whose step is at most ``enough`` is the last; no point may miss by more than ``most``.
struct Nodes {
    Vector<const double> start, heading, offsets;
    View<const double> predictors;
    double enough;
    double most;
};

// Corrections of `correct_across` (bifurc/numerics/corrector.py), point after point, each with the
// factorisation that served the one before it. ``System`` has `residual` and `linearize`.
template <class System>
class NodeCorrector {
public:
    NodeCorrector(System& system, Vector<const double> heading)
        : system_(system),
          heading_(heading),
          bordered_(system.equations(), system.unknowns()),
          right_(system.equations() + 1),
          step_(system.unknowns()),
          current_(system),
          best_(system) {}

    // Fills the points (k, n); whether all of them lie on the curve, none far from the one before it.
    bool fill(const Nodes& nodes, View<double> points) {
        constexpr double far = 4.0;
        std::copy(nodes.start.begin(), nodes.start.end(), points.row(0).begin());
        factor_at(points.row(0));
        for (Index k = 1; k < points.rows; ++k) {
            const Vector<double> point = points.row(k);
            predict(nodes, points, k);
            const double gap = correct(point, nodes.enough);
            double square = 0.0;
            for (Index j = 0; j < points.columns; ++j) {
                const double move = points(k, j) - points(k - 1, j);
                square += move * move;
            }
            const bool is_near = std::sqrt(square) <= far * (nodes.offsets[k] - nodes.offsets[k - 1]);
            if (!is_near || !(gap <= nodes.most)) return false;
        }
        return true;
    }

private:
    static constexpr int steps = 30;
    // residual left by one step, as a share, above which a factorisation made elsewhere is given up
    static constexpr double slow = 0.05;
    // a residual above this may rise once for a bend, and not for rounding
    static constexpr double bent = 1e-13;
    // steps shrink by no less than that from one to the next, as far as it is relied on
    static constexpr double least_rate = 0.01;

    struct Iterate {
        explicit Iterate(const System& system) : point(system.unknowns()), residual(system.equations()) {}

        std::vector<double> point, residual;
        double gap = std::numeric_limits<double>::infinity();
    };

    // Point k (n) by the points before it, moved along the heading to its offset.
    void predict(const Nodes& nodes, View<double> points, Index k) {
        const Vector<double> point = points.row(k);
        if (k == 1) {
            std::copy(nodes.start.begin(), nodes.start.end(), point.begin());
        } else {
            std::fill(point.begin(), point.end(), 0.0);
            for (Index i = 0; i < k; ++i) {
                for (Index j = 0; j < points.columns; ++j) point[j] += nodes.predictors(k, i) * points(i, j);
            }
        }
        double missing = nodes.offsets[k];
        for (Index j = 0; j < points.columns; ++j) missing -= (point[j] - nodes.start[j]) * heading_[j];
        for (Index j = 0; j < points.columns; ++j) point[j] += missing * heading_[j];
    }

    // Corrects a point (n) across the heading; gives back the residual that was left before the last step.
    double correct(Vector<double> point, double enough) {
        constexpr double infinite = std::numeric_limits<double>::infinity();
        double gap_before = infinite;
        bool is_fresh = false, has_bend = false;
        best_.gap = infinite;
        std::copy(point.begin(), point.end(), current_.point.begin());
        std::copy(point.begin(), point.end(), best_.point.begin());
        for (int step = 0; step < steps; ++step) {
            system_.residual(current_.point, current_.residual);
            current_.gap = length(current_.residual);
            if (current_.gap < best_.gap) best_ = current_;
            const bool has_risen = is_fresh && current_.gap >= gap_before;
            const bool has_stopped = has_risen && (has_bend || current_.gap < bent);
            if (has_stopped || !std::isfinite(current_.gap)) break;
            has_bend = has_bend || has_risen;
            const double rate = gap_before < infinite ? current_.gap / gap_before : 1.0;
            is_fresh = current_.gap > slow * gap_before;
            if (is_fresh) {
                if (!has_risen) current_ = best_;
                factor_at(current_.point);
            }
            gap_before = current_.gap;
            const double size = advance();
            if (size * std::max(rate, least_rate) <= enough) {
                std::copy(current_.point.begin(), current_.point.end(), point.begin());
                return gap_before;
            }
        }
        std::copy(best_.point.begin(), best_.point.end(), point.begin());
        return best_.gap;
    }

    void factor_at(Vector<const double> point) {
        system_.linearize(point, Vector<double>(right_).first(system_.equations()), bordered_.jacobian());
        bordered_.factor(heading_);
    }

    // One step from the current point; its length.
    double advance() {
        const Index m = system_.equations();
        for (Index row = 0; row < m; ++row) right_[row] = -current_.residual[row];
        right_[m] = 0.0;
        bordered_.solve(right_, step_);
        for (std::size_t j = 0; j < step_.size(); ++j) current_.point[j] += step_[j];
        return length(step_);
    }

    System& system_;
    Vector<const double> heading_;
    DenseBordered bordered_;
    std::vector<double> right_, step_;
    Iterate current_, best_;
};

}  // namespace bifurc
