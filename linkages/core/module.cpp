// The Python module linkages._core.
#include <nanobind/stl/optional.h>

#include <optional>

#include "bifurc/core/bindings.hpp"
#include "bifurc/core/equations_bindings.hpp"
#include "bifurc/core/valley_bindings.hpp"
#include "linkages/core/closure.hpp"
#include "linkages/core/slices_module.hpp"

namespace nb = nanobind;
namespace python = bifurc::python;
using namespace linkages;
using bifurc::numpy::view;
using python::Doubles;
using python::Table;

namespace {

nb::object residuals(const Table& thetas, const Table& geometry) {
    return python::residuals(Closure(view(geometry)), thetas);
}

nb::object jacobians(const Table& thetas, const Table& geometry) {
    return python::jacobians(Closure(view(geometry)), thetas);
}

nb::object hessians(const Table& thetas, const Table& geometry) {
    const Closure closure(view(geometry));
    python::check_unknowns("thetas", thetas.shape(1), closure.unknowns());
    const bifurc::View<const double> at = view(thetas);
    bifurc::numpy::Array<double> out({at.rows, closure.equations(), closure.unknowns(), closure.unknowns()});
    for (Index i = 0; i < at.rows; ++i) closure.hessian(at.row(i), out.entry(i));
    return out.release();
}

// The closure over a magnitude, for what bifurc makes of any equations.
nb::capsule equations(const Table& geometry, double magnitude) {
    const auto make = [](const Table& of) { return Closure(view(of)); };
    return python::hand_over(std::make_unique<bifurc::EquationsOf<Closure, Table>>(geometry, make, magnitude));
}

nb::tuple march(const Doubles& start, const Doubles& tangent, const Table& geometry, Index order,
                double tolerance, double shortest, double longest, Index count, double closing,
                double misclosure, const Table& anchor, double within, const Doubles& periods,
                const Table& bounds, double length) {
    const bifurc::MarchSettings settings{order, tolerance, shortest, longest, count, closing, misclosure};
    const auto region = python::region_of(anchor, within, periods, bounds, length);
    return python::march(Closure(view(geometry)), start, tangent, settings, region);
}

nb::tuple project(const Table& starts, const Table& geometry, double noise, int iterations) {
    return python::project(Closure(view(geometry)), starts, noise, iterations);
}

nb::tuple project_to_sphere(const Table& starts, const Doubles& center, double radius, const Table& geometry,
                            int iterations) {
    return python::project_to_sphere(Closure(view(geometry)), starts, center, radius, iterations);
}

nb::object valley_points_at_nodes(const Table& geometry, const Doubles& start, const Doubles& heading,
                                  const Doubles& offsets, const Table& predictors, double enough, double most) {
    return python::valley_points_at_nodes(Closure(view(geometry)), start, heading, offsets, predictors, enough, most);
}

}  // namespace

NB_MODULE(_core, module) {
    module.doc() = "Compiled parts of linkages.";
    python::leave_what_threads_hold();
    module.def("residuals", &residuals, nb::arg("thetas"), nb::arg("geometry"));
    module.def("jacobians", &jacobians, nb::arg("thetas"), nb::arg("geometry"));
    module.def("hessians", &hessians, nb::arg("thetas"), nb::arg("geometry"));
    module.def("equations", &equations, nb::arg("geometry"), nb::arg("magnitude"));
    module.def("march", &march, nb::arg("start"), nb::arg("tangent"), nb::arg("geometry"), nb::arg("order"),
               nb::arg("tolerance"), nb::arg("shortest"), nb::arg("longest"), nb::arg("count"),
               nb::arg("closing"), nb::arg("misclosure"), nb::arg("anchor"), nb::arg("within"), nb::arg("periods"),
               nb::arg("bounds"), nb::arg("length"));
    module.def("project", &project, nb::arg("starts"), nb::arg("geometry"), nb::arg("noise"),
               nb::arg("iterations"));
    module.def("project_to_sphere", &project_to_sphere, nb::arg("starts"), nb::arg("center"), nb::arg("radius"),
               nb::arg("geometry"), nb::arg("iterations"));
    module.def("valley_points_at_nodes", &valley_points_at_nodes, nb::arg("geometry"), nb::arg("start"),
               nb::arg("heading"), nb::arg("offsets"), nb::arg("predictors"), nb::arg("enough"), nb::arg("most"));
    linkages::define_slices(module);
}
