// Many starts at once, onto the solutions of a system.
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "bifurc/core/system.hpp"

namespace bifurc {

namespace projection {
constexpr double first_damping = 1e-2;  // over the residual
constexpr double least_damping = 1e-14;
constexpr double smallest_factor = 1e-8;
constexpr int most_failures = 12;
constexpr double nothing_left = 1e-14;  // a step on a sphere after which no other is made
constexpr Index together = 32;          // starts on a sphere whose derivatives are taken at once
constexpr double settled = 1e-6;        // over the radius: a step so short that does not shrink is rounding
}  // namespace projection

// Levenberg-Marquardt from every one of ``points`` (k, n), in place, onto the solutions;
// ``gaps`` (k) takes the residuals that are left. The damping is the residual's norm, for which
// convergence is quadratic to solution sets that are not isolated points as well (Fan and Yuan
// 2005). A residual of ``noise`` is none.
template <System S>
void project(const S& system, View<double> points, Vector<double> gaps, double noise, int iterations) {
    const Index n = system.unknowns(), m = system.equations();
    std::vector<double> residual(m), trial_residual(m), step(n), trial(n);
    typename S::Damped damped = system.damped();
    auto jacobian = damped.jacobian(), trial_jacobian = damped.jacobian();
    for (Index start = 0; start < points.rows; ++start) {
        const Vector<double> point = points.row(start);
        system.linearize(point, residual, jacobian);
        double gap = length(residual), factor = projection::first_damping;
        int failures = 0;
        for (int iteration = 0; iteration < iterations && gap > noise; ++iteration) {
            // without a floor the step along the null space would be rounding over rounding,
            // next to a solution
            const double damping = std::max(factor * gap, projection::least_damping);
            damped.step(jacobian, residual, damping, step);
            for (Index j = 0; j < n; ++j) trial[j] = point[j] + step[j];
            system.linearize(trial, trial_residual, trial_jacobian);
            const double reached = length(trial_residual);
            if (reached < gap) {
                failures = 0;
                if (reached < 0.5 * gap) factor *= 0.2;
                factor = std::max(factor, projection::smallest_factor);
                std::copy(trial.begin(), trial.end(), point.begin());
                std::swap(jacobian, trial_jacobian);
                std::swap(residual, trial_residual);
                gap = reached;
                continue;
            }
            factor *= 8.0;
            ++failures;
            // so near a solution it is rounding that does not fall
            if (failures > projection::most_failures || gap <= 10.0 * noise) break;
        }
        gaps[start] = gap;
    }
}

// Gauss-Newton from every one of ``points`` (k, n), in place, onto solutions at distance
// ``radius`` from ``center``; residuals (k) and lengths of the last step (k) beside. Next to a
// singular point the equations differ in size by the radius; undamped Gauss-Newton does not see
// that, a merit function would. Steps are cut to a third of the radius.
template <DenseSystem S>
void project_to_sphere(const S& system, View<double> points, Vector<const double> center, double radius,
                       int iterations, Vector<double> gaps, Vector<double> last_steps) {
    const Index n = system.unknowns(), m = system.equations(), together = projection::together;
    std::vector<double> right(m + 1), step(n);
    std::vector<Index> moving;
    Matrix<double> at(together, n), residuals(together, m), jacobians(together * m, n), matrix(m + 1, n);
    std::fill(last_steps.begin(), last_steps.end(), 0.0);
    for (Index begin = 0; begin < points.rows; begin += together) {
        moving.resize(std::min(together, points.rows - begin));
        std::iota(moving.begin(), moving.end(), begin);
        for (int iteration = 0; iteration < iterations && !moving.empty(); ++iteration) {
            const auto count = static_cast<Index>(moving.size());
            for (Index i = 0; i < count; ++i) std::copy_n(points.row(moving[i]).data(), n, at.row(i).data());
            linearize_all<S>(system, at.view().first_rows(count), residuals.view().first_rows(count),
                             jacobians.view().first_rows(count * m));
            std::size_t left = 0;
            for (Index i = 0; i < count; ++i) {
                const Index start = moving[i];
                const Vector<double> point = points.row(start);
                const double before = last_steps[start];
                std::copy_n(jacobians.row(i * m).data(), m * n, matrix.view().data);
                double square = 0.0;
                for (Index j = 0; j < n; ++j) {
                    matrix(m, j) = (point[j] - center[j]) / radius;
                    square += matrix(m, j) * matrix(m, j);
                }
                for (Index row = 0; row < m; ++row) right[row] = -residuals(i, row);
                right[m] = 0.5 * radius * (1.0 - square);
                solve_by_rank(matrix, right, step);
                const double size = length(step);
                const double cut = std::min(1.0, radius / (3.0 * size + 1e-300));
                for (Index j = 0; j < n; ++j) point[j] += cut * step[j];
                last_steps[start] = size;
                const bool is_rounding = iteration > 0 && size >= before && size < projection::settled * radius;
                if (!(size < projection::nothing_left || is_rounding)) moving[left++] = start;
            }
            moving.resize(left);
        }
    }
    Matrix<double> left(points.rows, m);
    linearize_all<S>(system, points, left, {nullptr, 0, n});
    for (Index start = 0; start < points.rows; ++start) gaps[start] = length(left.row(start));
}

}  // namespace bifurc
