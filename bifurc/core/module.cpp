// The Python module bifurc._core.
#include <string>

#include "bifurc/core/arc_bindings.hpp"
#include "bifurc/core/brackets.hpp"
#include "bifurc/core/curve.hpp"
#include "bifurc/core/eigenvalues.hpp"
#include "bifurc/core/exits.hpp"
#include "bifurc/core/march.hpp"
#include "bifurc/core/numpy.hpp"
#include "bifurc/core/returns.hpp"
#include "bifurc/core/sheet_module.hpp"
#include "bifurc/core/paths_bindings.hpp"
#include "bifurc/core/singular_values.hpp"
#include "bifurc/core/tape_bindings.hpp"
#include "bifurc/core/turnings.hpp"
#include "bifurc/core/valley_bindings.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace bifurc;
using numpy::Array;
using numpy::CubeIn;
using numpy::MatrixIn;
using numpy::VectorIn;

namespace {

std::vector<double> copied(const VectorIn<double>& array) { return {array.data(), array.data() + array.size()}; }

// All that a curve is made of, as Python has it.
using CurveArrays = std::tuple<VectorIn<double>, VectorIn<double>, VectorIn<double>, CubeIn<double>,
                               VectorIn<double>, VectorIn<double>>;

Curve curve_of(const CurveArrays& arrays) {
    const auto& [breaks, centers, radii, pieces, periods, travel] = arrays;
    const View<const double> coefficients = numpy::rows(pieces);
    const bool fits = radii.size() == pieces.shape(0) && centers.size() == radii.size() &&
                      breaks.size() == radii.size() + 1 && periods.size() == pieces.shape(2) &&
                      (travel.size() == 0 || travel.size() == pieces.shape(2)) && pieces.shape(1) > 0;
    if (!fits) throw nb::value_error("the arrays of a curve do not fit each other");
    Matrix<double> own(coefficients.rows, coefficients.columns);
    std::copy(pieces.data(), pieces.data() + pieces.size(), own.view().data);
    return Curve({copied(breaks), copied(centers), copied(radii), std::move(own), copied(periods), copied(travel)});
}

void check_width(const char* name, std::size_t given, Index needed) {
    if (static_cast<Index>(given) != needed) {
        throw nb::value_error((std::string(name) + " have another number of unknowns than the curve").c_str());
    }
}

void check_count(const VectorIn<double>& numbers, Index count) {
    if (static_cast<Index>(numbers.size()) != count) throw nb::value_error("there must be a number for each bracket");
}

nb::object values_on(const Curve& curve, const VectorIn<double>& s, int derivative) {
    if (curve.count() == 0 && s.size() > 0) throw nb::value_error("a curve of no pieces has no points");
    if (!curve.has_all(numpy::view(s))) throw nb::value_error("an arclength is beyond the curve");
    Array<double> out({static_cast<Index>(s.shape(0)), curve.unknowns()});
    curve.evaluate(numpy::view(s), derivative, out.matrix());
    return out.release();
}

// (2, p, n): `Curve::evaluate_ends`.
nb::object ends_of_pieces(const Curve& curve, int derivative) {
    Array<double> out({2, curve.count(), curve.unknowns()});
    curve.evaluate_ends(derivative, out.matrix());
    return out.release();
}

Height height_of(const Curve& curve, const MatrixIn<double>& coefficients) {
    if (curve.count() == 0) throw nb::value_error("a curve of no pieces has no points");
    check_width("the coefficients of a height", coefficients.shape(1), curve.unknowns());
    if (coefficients.shape(0) != 4) throw nb::value_error("the coefficients of a height must be four rows");
    const View<const double> rows = numpy::view(coefficients);
    return {rows.row(0), rows.row(1), rows.row(2), rows.row(3)};
}

// (k) at arclengths (k): `Curve::rate_of_height`.
nb::object rates_of_height(const Curve& curve, const MatrixIn<double>& coefficients, const VectorIn<double>& s) {
    const Height height = height_of(curve, coefficients);
    std::vector<double> room(curve.room_for_a_foot());
    Array<double> rates({static_cast<Index>(s.size())});
    for (std::size_t i = 0; i < s.size(); ++i) {
        rates.data()[i] = curve.rate_of_height(height, s.data()[i], room);
    }
    return rates.release();
}

// Arclengths (k), one in each bracket from ``low`` to ``high`` (k), at which a height is level.
nb::object level_places(const Curve& curve, const MatrixIn<double>& coefficients, const VectorIn<double>& low,
                        const VectorIn<double>& high, double tolerance) {
    check_count(high, static_cast<Index>(low.size()));
    const Height height = height_of(curve, coefficients);
    std::vector<double> room(curve.room_for_a_foot());
    Array<double> roots({static_cast<Index>(low.size())});
    find_roots([&](double s) { return curve.rate_of_height(height, s, room); }, numpy::view(low), numpy::view(high),
               tolerance, roots.vector());
    return roots.release();
}

// Roots (k) of a sum of waves, the real part of sum_j c_j exp(i j angle), one in each bracket.
nb::object roots_of_waves(const VectorIn<std::complex<double>>& coefficients, const VectorIn<double>& low,
                          const VectorIn<double>& high, double tolerance) {
    check_count(high, static_cast<Index>(low.size()));
    const auto waves = numpy::view(coefficients);
    const auto value = [&](double angle) {
        const std::complex<double> turn{std::cos(angle), std::sin(angle)};
        std::complex<double> total = 0.0;
        for (std::size_t j = waves.size(); j-- > 0;) total = total * turn + waves[j];
        return total.real();
    };
    Array<double> roots({static_cast<Index>(low.size())});
    find_roots(value, numpy::view(low), numpy::view(high), tolerance, roots.vector());
    return roots.release();
}

nb::tuple nearest(const Curve& curve, const MatrixIn<double>& points, double within) {
    check_width("points", points.shape(1), curve.unknowns());
    const View<const double> at = numpy::view(points);
    Array<double> distances({at.rows}), s({at.rows});
    {
        nb::gil_scoped_release release;
        std::vector<double> room(curve.room_for_a_foot());
        for (Index i = 0; i < at.rows; ++i) {
            const Foot foot = curve.nearest(at.row(i), within, room);
            distances.data()[i] = foot.distance;
            s.data()[i] = foot.s;
        }
    }
    return nb::make_tuple(distances.release(), s.release());
}

nb::object passes(const Curve& curve, const VectorIn<double>& point, double within, double same) {
    check_width("points", point.size(), curve.unknowns());
    const std::vector<double> found = curve.passes(numpy::view(point), within, same);
    Array<double> out({static_cast<Index>(found.size())});
    out.fill(found);
    return out.release();
}

// As many matrices (k, m, n) from number ``begin`` on as `SingularValues` takes at a time, one below
// the other.
View<const double> matrices_from(const CubeIn<double>& matrices, Index begin) {
    const auto count = static_cast<Index>(matrices.shape(0)), m = static_cast<Index>(matrices.shape(1)),
               n = static_cast<Index>(matrices.shape(2));
    return {matrices.data() + begin * m * n, m * std::min(SingularValues::lanes, count - begin), n};
}

// As many rows.
View<double> rows_from(View<double> table, Index begin) {
    return {table.data + begin * table.columns, std::min(SingularValues::lanes, table.rows - begin), table.columns};
}

// (k, n) of matrices (k, m, n), zeros after the first min(m, n); all of a matrix that is not finite are
// infinite.
nb::object singular_values(const CubeIn<double>& matrices) {
    const auto count = static_cast<Index>(matrices.shape(0)), m = static_cast<Index>(matrices.shape(1)),
               n = static_cast<Index>(matrices.shape(2));
    Array<double> out({count, n});
    {
        nb::gil_scoped_release release;
        SingularValues decomposition(m, n);
        Matrix<double> values(count, std::min(m, n));
        for (Index begin = 0; begin < count; begin += SingularValues::lanes) {
            decomposition.of(matrices_from(matrices, begin), rows_from(values, begin));
        }
        for (Index i = 0; i < count; ++i) {
            const Vector<double> row = out.matrix().row(i);
            const double* const entries = matrices.data() + i * m * n;
            const bool is_finite = std::all_of(entries, entries + m * n, [](double entry) { return std::isfinite(entry); });
            if (is_finite)
                std::copy(values.row(i).begin(), values.row(i).end(), row.begin());
            else
                std::fill(row.begin(), row.end(), std::numeric_limits<double>::infinity());
        }
    }
    return out.release();
}

// (values (k), rates (k)) of singular value ``number`` of each matrix, counted from 0, where the
// matrices change by ``changes``
nb::tuple singular_value_rates(const CubeIn<double>& matrices, const CubeIn<double>& changes, int number) {
    const auto count = static_cast<Index>(matrices.shape(0)), m = static_cast<Index>(matrices.shape(1)),
               n = static_cast<Index>(matrices.shape(2));
    const bool fits = changes.shape(0) == matrices.shape(0) && changes.shape(1) == matrices.shape(1) &&
                      changes.shape(2) == matrices.shape(2) && 0 <= number && number < std::min(m, n);
    if (!fits) throw nb::value_error("the arrays of matrices and of their changes do not fit each other");
    Array<double> values({count}), rates({count});
    {
        nb::gil_scoped_release release;
        SingularValues decomposition(m, n);
        Matrix<double> all(count, std::min(m, n));
        for (Index begin = 0; begin < count; begin += SingularValues::lanes) {
            decomposition.of(matrices_from(matrices, begin), rows_from(all, begin));
            const Index end = std::min(count, begin + SingularValues::lanes);
            for (Index i = begin; i < end; ++i) {
                const View<const double> matrix{matrices.data() + i * m * n, m, n};
                values.data()[i] = all(i, number);
                rates.data()[i] = decomposition.rate(i - begin, number, matrix, {changes.data() + i * m * n, m, n});
            }
        }
    }
    return nb::make_tuple(values.release(), rates.release());
}

// What `Brackets` gives with as many numbers as there are brackets.
template <auto method>
nb::object numbers_of(const Brackets& brackets) {
    Array<double> out({brackets.count()});
    (brackets.*method)(out.vector());
    return out.release();
}

// (k, 5): the numbers of `Turning`.
nb::object turnings(const Curve& curve, Index unknown, double share, double jump) {
    if (unknown < 0 || unknown >= curve.unknowns()) throw nb::index_error("no such unknown");
    const std::vector<Turning> found = UnknownRate(curve, unknown, {share, jump}).turnings();
    Array<double> out({static_cast<Index>(found.size()), 5});
    double* entry = out.data();
    for (const Turning& one : found) {
        for (double value : {one.s, one.low, one.high, one.before, one.after}) *entry++ = value;
    }
    return out.release();
}

Trail trail_of(const CubeIn<double>& pieces, const VectorIn<double>& centers, const VectorIn<double>& radii,
               const VectorIn<double>& periods) {
    check_width("periods", periods.size(), static_cast<Index>(pieces.shape(2)));
    const bool fits = centers.size() == pieces.shape(0) && radii.size() == centers.size();
    if (!fits) throw nb::value_error("the arrays of a curve do not fit each other");
    return {numpy::rows(pieces), numpy::view(centers), numpy::view(radii), numpy::view(periods)};
}

// A list of (s, distance, forward, speed, offset (n)): `Return`.
nb::list returns_on(const CubeIn<double>& pieces, const VectorIn<double>& centers, const VectorIn<double>& radii,
                 const VectorIn<double>& periods, Index number, double s, Index first) {
    const Trail trail = trail_of(pieces, centers, radii, periods);
    if (number < 0 || number >= trail.count() || first < 0) throw nb::index_error("no such piece");
    nb::list found;
    for (const Return& passing : returns_to(trail, number, s, first)) {
        Array<double> offset({static_cast<Index>(passing.offset.size())});
        offset.fill(passing.offset);
        found.append(
            nb::make_tuple(passing.s, passing.distance, passing.forward, passing.speed, offset.release()));
    }
    return found;
}

// The arclength, or None.
nb::object exit_of(const CubeIn<double>& pieces, const VectorIn<double>& centers, const VectorIn<double>& radii,
                   const VectorIn<double>& periods, Index first, const MatrixIn<double>& bounds, double slack) {
    const Trail trail = trail_of(pieces, centers, radii, periods);
    check_width("bounds", bounds.shape(0), static_cast<Index>(pieces.shape(2)));
    if (bounds.shape(1) != 2) throw nb::value_error("bounds: a row must have two ends");
    if (first < 0) throw nb::index_error("no such piece");
    const std::optional<double> s = exit_of_bounds(trail, first, numpy::view(bounds), slack);
    return s ? nb::cast(*s) : nb::none();
}

// (n) of a matrix (m, n), for ``along`` (n) or (0).
nb::object null_vector(const MatrixIn<double>& matrix, const VectorIn<double>& along, double negligible,
                       double agreeing) {
    const View<const double> view = numpy::view(matrix);
    if (along.size() > 0) check_width("along", along.size(), view.columns);
    SingularValues decomposition(view.rows, view.columns);
    Matrix<double> values(1, std::min(view.rows, view.columns));
    decomposition.of(view, values);
    Array<double> out({view.columns});
    out.fill(decomposition.null_vector(0, view, numpy::view(along), negligible, agreeing));
    return out.release();
}

// (n) of a complex matrix (n, n).
// The least-squares solution (n) of matrix x = right, (m, n) and (m), of any rank.
nb::object solution_by_rank(const MatrixIn<double>& matrix, const VectorIn<double>& right) {
    if (matrix.shape(0) != right.shape(0)) throw nb::value_error("right: there must be an entry for each row");
    Matrix<double> work(static_cast<Index>(matrix.shape(0)), static_cast<Index>(matrix.shape(1)));
    std::copy_n(matrix.data(), matrix.size(), work.view().data);
    std::vector<double> sides(right.data(), right.data() + right.shape(0));
    Array<double> solution({work.columns()});
    solve_by_rank(work, sides, solution.vector());
    return solution.release();
}

nb::object eigenvalues(const MatrixIn<std::complex<double>>& matrix) {
    const auto n = static_cast<Index>(matrix.shape(0));
    if (matrix.shape(1) != matrix.shape(0)) throw nb::value_error("matrix: it must be square");
    Array<std::complex<double>> values({n});
    Matrix<std::complex<double>> copy(n, n);
    std::copy_n(matrix.data(), n * n, copy.view().data);
    if (!find_eigenvalues(copy, values.vector())) throw nb::value_error("matrix: its entries must be finite");
    return values.release();
}

}  // namespace

NB_MODULE(_core, module) {
    module.doc() = "Compiled parts of bifurc.";
    bifurc::python::leave_what_threads_hold();
    nb::class_<Curve>(module, "Curve")
        .def(
            "__init__",
            [](Curve* place, const VectorIn<double>& breaks, const VectorIn<double>& centers,
               const VectorIn<double>& radii, const CubeIn<double>& pieces, const VectorIn<double>& periods,
               const VectorIn<double>& travel) {
                new (place) Curve(curve_of({breaks, centers, radii, pieces, periods, travel}));
            },
            "breaks"_a, "centers"_a, "radii"_a, "pieces"_a, "periods"_a, "travel"_a)
        .def("evaluate", &values_on, "s"_a, "derivative"_a)
        .def("ends_of_pieces", &ends_of_pieces, "derivative"_a)
        .def("rates_of_height", &rates_of_height, "coefficients"_a, "s"_a)
        .def("level_places", &level_places, "coefficients"_a, "low"_a, "high"_a, "tolerance"_a)
        .def("nearest", &nearest, "points"_a, "within"_a)
        .def("turnings", &turnings, "unknown"_a, "share"_a, "jump"_a)
        .def("passes", &passes, "point"_a, "within"_a, "same"_a);
    nb::class_<Brackets>(module, "Brackets")
        .def(
            "__init__",
            [](Brackets* place, const VectorIn<double>& low, const VectorIn<double>& high,
               const VectorIn<double>& at_low, const VectorIn<double>& at_high, double tolerance) {
                for (const VectorIn<double>& numbers : {high, at_low, at_high}) {
                    check_count(numbers, static_cast<Index>(low.size()));
                }
                new (place) Brackets(numpy::view(low), numpy::view(high), numpy::view(at_low), numpy::view(at_high),
                                     tolerance);
            },
            "low"_a, "high"_a, "at_low"_a, "at_high"_a, "tolerance"_a)
        .def("points", &numbers_of<&Brackets::points>)
        .def(
            "narrow",
            [](Brackets& brackets, const VectorIn<double>& values) {
                check_count(values, brackets.count());
                return brackets.narrow(numpy::view(values));
            },
            "values"_a)
        .def("roots", &numbers_of<&Brackets::roots>);
    module.def("exit_of_bounds", &exit_of, "pieces"_a, "centers"_a, "radii"_a, "periods"_a, "first"_a,
               "bounds"_a, "slack"_a);
    module.def("mixed_cells", &bifurc::python::mixed_cells, "exponents"_a, "sizes"_a, "lifts"_a, "most"_a, "seconds"_a);
    module.def("null_vector", &null_vector, "matrix"_a, "along"_a, "negligible"_a, "agreeing"_a);
    module.def("returns", &returns_on, "pieces"_a, "centers"_a, "radii"_a, "periods"_a, "number"_a, "s"_a, "first"_a);
    module.def("roots_of_waves", &roots_of_waves, "coefficients"_a, "low"_a, "high"_a, "tolerance"_a);
    module.def("singular_values", &singular_values, "matrices"_a);
    module.def("singular_value_rates", &singular_value_rates, "matrices"_a, "changes"_a, "number"_a);
    module.def("eigenvalues", &eigenvalues, "matrix"_a);
    module.def("solve_by_rank", &solution_by_rank, "matrix"_a, "right"_a);
    module.def("valley_residuals", &bifurc::python::valley_residuals, "residuals"_a, "jacobians"_a);
    module.def("valley_jacobians", &bifurc::python::valley_jacobians, "residuals"_a, "jacobians"_a, "hessians"_a);
    bifurc::python::bind_arcs(module);
    bifurc::python::bind_tape(module);
    bifurc::python::bind_sheets(module);
}
