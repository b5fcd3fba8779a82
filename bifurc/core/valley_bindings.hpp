// What the modules hand over to Python of valleys.
#pragma once

#include "bifurc/core/collocation.hpp"
#include "bifurc/core/numpy.hpp"
#include "bifurc/core/valley.hpp"

namespace bifurc::python {

namespace nb = nanobind;

// Points (k, n) of the valley of a system at the nodes of a piece; None where correction fails.
template <CurvedSystem S>
nb::object valley_points_at_nodes(const S& system, const numpy::VectorIn<double>& start,
                                  const numpy::VectorIn<double>& heading, const numpy::VectorIn<double>& offsets,
                                  const numpy::MatrixIn<double>& predictors, double enough, double most) {
    const auto n = static_cast<std::size_t>(system.unknowns());
    const std::size_t count = offsets.shape(0);
    const bool fits = start.shape(0) == n && heading.shape(0) == n && count > 0 && predictors.shape(0) == count &&
                      predictors.shape(1) == count;
    if (!fits) throw nb::value_error("start, heading, offsets and predictors do not fit each other");
    numpy::Array<double> points({static_cast<Index>(count), system.unknowns()});
    const Nodes nodes{numpy::view(start), numpy::view(heading), numpy::view(offsets), numpy::view(predictors), enough, most};
    bool is_filled = false;
    {
        nb::gil_scoped_release release;
        Valley valley(system);
        is_filled = NodeCorrector(valley, nodes.heading).fill(nodes, points.matrix());
    }
    return is_filled ? points.release() : nb::none();
}

// G (k, m) from F (k, m) and F' (k, m, n).
inline nb::object valley_residuals(const numpy::MatrixIn<double>& residuals, const numpy::CubeIn<double>& jacobians) {
    const auto count = static_cast<Index>(residuals.shape(0)), m = static_cast<Index>(residuals.shape(1));
    const auto n = static_cast<Index>(jacobians.shape(2));
    const bool fits = jacobians.shape(0) == residuals.shape(0) && jacobians.shape(1) == residuals.shape(1) && n > 0;
    if (!fits) throw nb::value_error("residuals and jacobians do not fit each other");
    numpy::Array<double> out({count, m});
    ValleyEquations valley(m, n);
    for (Index i = 0; i < count; ++i) {
        const View<const double> jacobian{jacobians.data() + i * m * n, m, n};
        valley.residual(numpy::view(residuals).row(i), jacobian, out.matrix().row(i));
    }
    return out.release();
}

// G' (k, m, n) from F (k, m), F' (k, m, n) and F'' (k, m * n, n).
inline nb::object valley_jacobians(const numpy::MatrixIn<double>& residuals, const numpy::CubeIn<double>& jacobians,
                                   const numpy::CubeIn<double>& hessians) {
    const auto count = static_cast<Index>(residuals.shape(0)), m = static_cast<Index>(residuals.shape(1));
    const auto n = static_cast<Index>(jacobians.shape(2));
    const bool fits = jacobians.shape(0) == residuals.shape(0) && jacobians.shape(1) == residuals.shape(1) && n > 0 &&
                      hessians.shape(0) == residuals.shape(0) && static_cast<Index>(hessians.shape(1)) == m * n &&
                      hessians.shape(2) == jacobians.shape(2);
    if (!fits) throw nb::value_error("residuals, jacobians and hessians do not fit each other");
    numpy::Array<double> out({count, m, n});
    ValleyEquations valley(m, n);
    std::vector<double> projected(m);
    for (Index i = 0; i < count; ++i) {
        const View<const double> jacobian{jacobians.data() + i * m * n, m, n};
        const View<const double> hessian{hessians.data() + i * m * n * n, m * n, n};
        valley.linearize(numpy::view(residuals).row(i), jacobian, hessian, projected, out.entry(i));
    }
    return out.release();
}

}  // namespace bifurc::python
