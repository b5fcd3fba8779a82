// What the compiled methods ask of a system of equations.
#pragma once

#include <concepts>

#include "bifurc/core/arrays.hpp"
#include "bifurc/core/least_squares.hpp"

namespace bifurc {

// F: R^n -> R^m with any m, whose solutions are curves. ``residual`` fills F (m),
// ``linearize`` F and F' (m, n) at a point; ``series`` fills Taylor coefficients
// (order + 1, n) of the solution curve u(s), s the arclength, about a point on it, from its
// unit tangent and the factored [F'; tangent].
template <class S>
concept System = requires(const S& system, Vector<const double> point, Vector<const double> tangent,
                          Vector<double> residual, View<double> matrix,
                          const Factorization& factorization) {
    { system.unknowns() } -> std::convertible_to<Index>;
    { system.equations() } -> std::convertible_to<Index>;
    system.residual(point, residual);
    system.linearize(point, residual, matrix);
    system.series(point, tangent, factorization, matrix);
};

}  // namespace bifurc
