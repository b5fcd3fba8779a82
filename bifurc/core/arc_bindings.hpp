// What the module of bifurc hands over to Python of arcs.
#pragma once

#include <nanobind/stl/optional.h>

#include <optional>

#include "bifurc/core/kantorovich.hpp"
#include "bifurc/core/numpy.hpp"

namespace bifurc::python {

namespace nb = nanobind;
using numpy::Array;
using numpy::CubeIn;
using numpy::MatrixIn;
using numpy::VectorIn;

inline Matrix<double> copied(const MatrixIn<double>& array) {
    Matrix<double> own(static_cast<Index>(array.shape(0)), static_cast<Index>(array.shape(1)));
    std::copy_n(array.data(), array.size(), own.view().data);
    return own;
}

inline Chebyshev chebyshev_of(const MatrixIn<double>& to_coefficients, const MatrixIn<double>& to_edges,
                              const MatrixIn<double>& powers, const VectorIn<double>& errors, double lebesgue,
                              double bend) {
    const std::size_t nodes = to_coefficients.shape(0);
    const bool fits = nodes % 2 == 0 && to_coefficients.shape(1) == nodes && to_edges.shape(0) == nodes &&
                      powers.shape(0) == nodes && powers.shape(1) == errors.size();
    if (!fits) throw nb::value_error("the tables of Chebyshev nodes do not fit each other");
    return Chebyshev(copied(to_coefficients), copied(to_edges), copied(powers),
                     {errors.data(), errors.data() + errors.size()}, lebesgue, bend);
}

inline void check_length(const char* name, const VectorIn<double>& array, Index most) {
    if (static_cast<Index>(array.size()) <= most) return;
    throw nb::value_error((std::string(name) + ": there must be no more entries than nodes").c_str());
}

// (N, q) of values (N, q).
inline nb::object coefficients(const Chebyshev& chebyshev, const MatrixIn<double>& values) {
    const View<const double> at_nodes = numpy::view(values);
    if (at_nodes.rows != chebyshev.nodes()) throw nb::value_error("values: there must be a row for each node");
    Array<double> out({at_nodes.rows, at_nodes.columns});
    chebyshev.coefficients(at_nodes, out.matrix());
    return out.release();
}

// (c + 1) of a series (k).
inline nb::object on_edges(const Chebyshev& chebyshev, const VectorIn<double>& series) {
    check_length("series", series, chebyshev.nodes());
    Array<double> out({chebyshev.edges()});
    chebyshev.on_edges(numpy::view(series), out.vector());
    return out.release();
}

// (e) of sizes (k).
inline nb::object on_ellipses(const Chebyshev& chebyshev, const VectorIn<double>& sizes) {
    check_length("sizes", sizes, chebyshev.nodes());
    Array<double> out({chebyshev.ellipses()});
    chebyshev.on_ellipses(numpy::view(sizes), out.vector());
    return out.release();
}

// Arcs (a) at their N nodes, as Python has them.
struct ArcArrays {
    CubeIn<double> slopes, residuals;                                  // (a, N, n), (a, N, m)
    nb::ndarray<const double, nb::ndim<4>, nb::c_contig> jacobians;    // (a, N, m, n)
    CubeIn<double> left, images;                                       // (a, m, n - 1), (a, 2, m)
    MatrixIn<double> travel, curvature;                                // (a, e)

    Index count() const { return static_cast<Index>(slopes.shape(0)); }
    Index nodes() const { return static_cast<Index>(slopes.shape(1)); }
    Index unknowns() const { return static_cast<Index>(slopes.shape(2)); }
    Index equations() const { return static_cast<Index>(residuals.shape(2)); }

    // The values of polynomials of a ``degree`` have to fit the nodes.
    void check(const Chebyshev& chebyshev, Index degree) const {
        const auto has = [](const auto& array, std::initializer_list<Index> shape) {
            std::size_t axis = 0;
            for (Index extent : shape) {
                if (static_cast<Index>(array.shape(axis++)) != extent) return false;
            }
            return true;
        };
        const Index a = count(), n = unknowns(), m = equations(), nodes = chebyshev.nodes(), e = chebyshev.ellipses();
        const bool fits = n > 0 && degree >= 0 && degree < nodes && has(slopes, {a, nodes, n}) && has(residuals, {a, nodes, m}) &&
                          has(jacobians, {a, nodes, m, n}) && has(left, {a, m, n - 1}) && has(images, {a, 2, m}) &&
                          has(travel, {a, e}) && has(curvature, {a, e});
        if (!fits) throw nb::value_error("the arrays of arcs do not fit each other");
    }

    Arc arc(Index number) const {
        const Index n = unknowns(), m = equations();
        const auto entry = [&](const auto& array, Index rows, Index columns) {
            return View<const double>{array.data() + number * rows * columns, rows, columns};
        };
        return {{entry(slopes, nodes(), n), entry(jacobians, nodes() * m, n), entry(left, m, n - 1)},
                entry(residuals, nodes(), m),
                entry(images, 2, m),
                numpy::view(travel).row(number),
                numpy::view(curvature).row(number)};
    }
};

// (a, e) from points (a, N, n): `bound_travel`.
inline nb::object travel_of_arcs(const Chebyshev& chebyshev, const CubeIn<double>& points, Index degree) {
    const auto count = static_cast<Index>(points.shape(0)), n = static_cast<Index>(points.shape(2));
    const bool fits = static_cast<Index>(points.shape(1)) == chebyshev.nodes() && degree >= 0 && degree < chebyshev.nodes();
    if (!fits) throw nb::value_error("the points do not fit the nodes");
    Array<double> travel({count, chebyshev.ellipses()});
    for (Index arc = 0; arc < count; ++arc) {
        const View<const double> of_arc{points.data() + arc * chebyshev.nodes() * n, chebyshev.nodes(), n};
        bound_travel(chebyshev, of_arc, degree, travel.matrix().row(arc));
    }
    return travel.release();
}

// (doubts in the cells (a, c), least at a node (a), whether the arc is uneven (a)) by the bound on F'', or
// by F'' itself at the nodes, ``hessians`` (a * N, m * n, n), where they are given.
inline nb::tuple doubts_of_arcs(const Chebyshev& chebyshev, const SecondDerivative& second, const ArcArrays& arcs,
                                Index degree, const std::optional<CubeIn<double>>& hessians) {
    arcs.check(chebyshev, degree);
    const Index n = arcs.unknowns(), m = arcs.equations(), nodes = chebyshev.nodes();
    const bool fits = !hessians || (static_cast<Index>(hessians->shape(0)) == arcs.count() * nodes &&
                                    static_cast<Index>(hessians->shape(1)) == m * n &&
                                    static_cast<Index>(hessians->shape(2)) == n);
    if (!fits) throw nb::value_error("the arrays of arcs do not fit each other");
    Array<double> in_cells({arcs.count(), chebyshev.edges() - 1}), least({arcs.count()});
    Array<bool> is_uneven({arcs.count()});
    {
        nb::gil_scoped_release release;
        ArcBounds bounds(chebyshev, second, n, m, degree);
        for (Index number = 0; number < arcs.count(); ++number) {
            const Arc arc = arcs.arc(number);
            bounds.look_at(arc);
            const Vector<double> cells = in_cells.matrix().row(number);
            const Index first = number * nodes * m * n;
            least.data()[number] =
                hessians ? bounds.bound_doubts({hessians->data() + first * n, nodes * m * n, n}, cells)
                         : bounds.bound_doubts(cells);
            is_uneven.data()[number] = bounds.is_uneven();
        }
    }
    return nb::make_tuple(in_cells.release(), least.release(), is_uneven.release());
}

// (bounds on |H^-1| in the cells (a, c), bounds on |G| (a)), which the doubts are made of.
inline nb::tuple sizes_on_arcs(const Chebyshev& chebyshev, const ArcArrays& arcs, Index degree) {
    arcs.check(chebyshev, degree);
    Array<double> sizes({arcs.count(), chebyshev.edges() - 1}), gaps({arcs.count()});
    ArcBounds bounds(chebyshev, {}, arcs.unknowns(), arcs.equations(), degree);
    for (Index number = 0; number < arcs.count(); ++number) {
        const Arc arc = arcs.arc(number);
        bounds.look_at(arc);
        bounds.bound_sizes(sizes.matrix().row(number));
        gaps.data()[number] = bounds.gap();
    }
    return nb::make_tuple(sizes.release(), gaps.release());
}

inline void bind_arcs(nb::module_& module) {
    using namespace nb::literals;
    nb::class_<Chebyshev>(module, "Chebyshev")
        .def(
            "__init__",
            [](Chebyshev* place, const MatrixIn<double>& to_coefficients, const MatrixIn<double>& to_edges,
               const MatrixIn<double>& powers, const VectorIn<double>& errors, double lebesgue, double bend) {
                new (place) Chebyshev(chebyshev_of(to_coefficients, to_edges, powers, errors, lebesgue, bend));
            },
            "to_coefficients"_a, "to_edges"_a, "powers"_a, "errors"_a, "lebesgue"_a, "bend"_a)
        .def("coefficients", &coefficients, "values"_a)
        .def("on_edges", &on_edges, "series"_a)
        .def("on_ellipses", &on_ellipses, "sizes"_a)
        .def("slack", [](const Chebyshev& chebyshev, const VectorIn<double>& series) {
            check_length("series", series, chebyshev.nodes());
            return chebyshev.slack(numpy::view(series));
        }, "series"_a)
        .def("largest", [](const Chebyshev& chebyshev, const VectorIn<double>& at_nodes,
                           const VectorIn<double>& in_coefficients) {
            check_length("at_nodes", at_nodes, chebyshev.nodes());
            check_length("in_coefficients", in_coefficients, chebyshev.nodes());
            return chebyshev.largest(numpy::view(at_nodes), numpy::view(in_coefficients));
        }, "at_nodes"_a, "in_coefficients"_a);
    nb::class_<SecondDerivative>(module, "SecondDerivative")
        .def(
            "__init__",
            [](SecondDerivative* place, double bound, double residual, double growth, double reach, double error) {
                new (place) SecondDerivative{bound, residual, growth, reach, error};
            },
            "bound"_a, "residual"_a, "growth"_a, "reach"_a, "error"_a);
    nb::class_<ArcArrays>(module, "Arcs")
        .def(
            "__init__",
            [](ArcArrays* place, const CubeIn<double>& slopes, const CubeIn<double>& residuals,
               const nb::ndarray<const double, nb::ndim<4>, nb::c_contig>& jacobians, const CubeIn<double>& left,
               const CubeIn<double>& images, const MatrixIn<double>& travel, const MatrixIn<double>& curvature) {
                new (place) ArcArrays{slopes, residuals, jacobians, left, images, travel, curvature};
            },
            "slopes"_a, "residuals"_a, "jacobians"_a, "left"_a, "images"_a, "travel"_a, "curvature"_a);
    module.def("travel_of_arcs", &travel_of_arcs, "chebyshev"_a, "points"_a, "degree"_a);
    module.def("doubts_of_arcs", &doubts_of_arcs, "chebyshev"_a, "second"_a, "arcs"_a, "degree"_a, "hessians"_a);
    module.def("sizes_on_arcs", &sizes_on_arcs, "chebyshev"_a, "arcs"_a, "degree"_a);
}

}  // namespace bifurc::python
