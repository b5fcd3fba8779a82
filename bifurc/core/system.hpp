// What the compiled methods ask of a system of equations.
#pragma once

#include <concepts>

#include "bifurc/core/arrays.hpp"
#include "bifurc/core/bordered.hpp"
#include "bifurc/core/damped.hpp"

namespace bifurc {

// F: R^n -> R^m with any m, whose solutions are curves. ``residual`` fills F (m), ``linearize`` F and
// F' at a point; ``bordered`` is what factors [F'; t], ``damped`` what makes damped steps; ``series`` fills Taylor coefficients
// (order + 1, n) of the solution curve u(s), s the arclength, about a point on it, from its
// unit tangent and the factored [F'; tangent].
template <class S>
concept System = requires(const S& system, Vector<const double> point, Vector<const double> tangent,
                          Vector<double> residual, View<double> coefficients, typename S::Bordered& bordered,
                          typename S::Damped::Jacobian& jacobian) {
    { system.unknowns() } -> std::convertible_to<Index>;
    { system.equations() } -> std::convertible_to<Index>;
    { system.bordered() } -> std::convertible_to<typename S::Bordered>;
    { system.damped() } -> std::convertible_to<typename S::Damped>;
    system.residual(point, residual);
    system.linearize(point, residual, jacobian);
    system.linearize(point, residual, bordered.jacobian());
    system.series(point, tangent, bordered, coefficients);
};

// One whose F' (m, n) is a dense matrix.
template <class S>
concept DenseSystem = System<S> && std::same_as<typename S::Bordered, DenseBordered>;

// F (k, m) at points (k, n), and F' (k * m, n) where there is room for it: at once where the system can do that.
template <class S>
void linearize_all(const S& system, View<const double> points, View<double> residuals, View<double> jacobians) {
    if constexpr (requires { system.fill(points, residuals, jacobians); }) {
        system.fill(points, residuals, jacobians);
    } else {
        const Index m = system.equations();
        for (Index k = 0; k < points.rows; ++k) {
            if (jacobians.rows == 0) {
                system.residual(points.row(k), residuals.row(k));
            } else {
                const View<double> jacobian{jacobians.row(k * m).data(), m, jacobians.columns};
                system.linearize(points.row(k), residuals.row(k), jacobian);
            }
        }
    }
}

}  // namespace bifurc
