// Recorded equations handed over to Python.
#pragma once

#include <nanobind/nanobind.h>

#include <algorithm>
#include <complex>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <vector>

#include "bifurc/core/bindings.hpp"
#include "bifurc/core/boxes_bindings.hpp"
#include "bifurc/core/paths_bindings.hpp"
#include "bifurc/core/tape.hpp"
#include "bifurc/core/valley_bindings.hpp"

namespace bifurc::python {

using Whole = numpy::VectorIn<std::int64_t>;
using WholeTable = numpy::MatrixIn<std::int64_t>;

// ``operands`` (k, 3): left, right and rule.
inline void make_tape(Tape* self, Index unknowns, const Whole& operations, const WholeTable& operands,
                      const Doubles& constants, const Whole& outputs) {
    std::vector<Instruction> instructions(operations.shape(0));
    check_unknowns("operands", operands.shape(0), operations.shape(0));
    check_unknowns("constants", constants.shape(0), operations.shape(0));
    const auto rows = numpy::view(operands);
    for (Index slot = 0; slot < static_cast<Index>(instructions.size()); ++slot) {
        instructions[slot] = {static_cast<Operation>(operations.data()[slot]), rows(slot, 0), rows(slot, 1),
                              rows(slot, 2), constants.data()[slot]};
    }
    const std::vector<Index> ends(outputs.data(), outputs.data() + outputs.shape(0));
    new (self) Tape(unknowns, std::move(instructions), ends);
}

// F (k, m) at points (k, n), over any kind of number.
template <class T>
nb::object tape_values(const Tape& tape, const numpy::MatrixIn<T>& points) {
    check_unknowns("points", points.shape(1), tape.unknowns());
    const auto at = numpy::view(points);
    numpy::Array<T> out({at.rows, tape.equations()});
    if constexpr (std::is_same_v<T, double>) {
        ManyPoints(tape).fill(at, out.matrix(), {nullptr, 0, tape.unknowns()});
        return out.release();
    }
    Sweep<T> sweep(tape);
    for (Index i = 0; i < at.rows; ++i) {
        sweep.evaluate(at.row(i));
        for (Index row = 0; row < tape.equations(); ++row) out.matrix()(i, row) = sweep.value(row);
    }
    return out.release();
}

// F' (k, m, n) at points (k, n).
template <class T>
nb::object tape_jacobians(const Tape& tape, const numpy::MatrixIn<T>& points) {
    check_unknowns("points", points.shape(1), tape.unknowns());
    const auto at = numpy::view(points);
    numpy::Array<T> out({at.rows, tape.equations(), tape.unknowns()});
    if constexpr (std::is_same_v<T, double>) {
        Matrix<double> values(at.rows, tape.equations());
        ManyPoints(tape).fill(at, values, out.matrix());
        return out.release();
    }
    Sweep<T> sweep(tape);
    for (Index i = 0; i < at.rows; ++i) {
        sweep.linearize(at.row(i));
        sweep.jacobian(out.entry(i));
    }
    return out.release();
}

// F'' (m, n, n) at a point (n).
inline nb::object tape_hessian(const Tape& tape, const Doubles& point) {
    check_unknowns("point", point.shape(0), tape.unknowns());
    numpy::Array<double> out({tape.equations(), tape.unknowns(), tape.unknowns()});
    Sweep<double> sweep(tape);
    sweep.linearize(numpy::view(point));
    sweep.hessian(out.matrix());
    return out.release();
}

// Taylor coefficients (order + 1, m) of F along a curve with coefficients (order + 1, n).
inline nb::object tape_series(const Tape& tape, const Table& curve) {
    check_unknowns("curve", curve.shape(1), tape.unknowns());
    numpy::Array<double> out({static_cast<Index>(curve.shape(0)), tape.equations()});
    series_along(tape, numpy::view(curve), out.matrix());
    return out.release();
}

// Where F' (m, n) has entries, by rows: (starts (m + 1), columns).
inline nb::tuple tape_pattern(const Tape& tape) {
    const SparsityPattern pattern = tape.pattern();
    numpy::Array<std::int64_t> starts({static_cast<Index>(pattern.starts.size())});
    numpy::Array<std::int64_t> columns({static_cast<Index>(pattern.entries.size())});
    std::copy(pattern.starts.begin(), pattern.starts.end(), starts.data());
    std::copy(pattern.entries.begin(), pattern.entries.end(), columns.data());
    return nb::make_tuple(starts.release(), columns.release());
}

// The entries of F' at a point (n), in the order of `tape_pattern`.
inline nb::object tape_entries(const Tape& tape, const Doubles& point) {
    check_unknowns("point", point.shape(0), tape.unknowns());
    numpy::Array<double> out({static_cast<Index>(tape.pattern().entries.size())});
    Sweep<double> sweep(tape);
    sweep.linearize(numpy::view(point));
    sweep.entries(out.vector());
    return out.release();
}

inline nb::tuple ends_of(const std::vector<Interval>& values, std::initializer_list<Index> shape) {
    numpy::Array<double> low(shape), high(shape);
    for (std::size_t i = 0; i < values.size(); ++i) {
        low.data()[i] = values[i].low;
        high.data()[i] = values[i].high;
    }
    return nb::make_tuple(low.release(), high.release());
}

// Bounds (low (k, m), high (k, m)) of F in boxes (k, n).
inline nb::tuple tape_value_bounds(const Tape& tape, const Table& low, const Table& high) {
    check_unknowns("low", low.shape(1), tape.unknowns());
    check_unknowns("high", high.shape(1), tape.unknowns());
    check_unknowns("high", high.shape(0), low.shape(0));
    const auto lower = numpy::view(low), upper = numpy::view(high);
    std::vector<Interval> out;
    Sweep<Interval> sweep(tape);
    for (Index i = 0; i < lower.rows; ++i) {
        const auto box = intervals_of(lower.row(i), upper.row(i));
        sweep.evaluate(box);
        for (Index row = 0; row < tape.equations(); ++row) out.push_back(sweep.value(row));
    }
    return ends_of(out, {lower.rows, tape.equations()});
}

// Bounds (low (k, m, n), high (k, m, n)) of F' in boxes (k, n).
inline nb::tuple tape_jacobian_bounds(const Tape& tape, const Table& low, const Table& high) {
    check_unknowns("low", low.shape(1), tape.unknowns());
    check_unknowns("high", high.shape(1), tape.unknowns());
    check_unknowns("high", high.shape(0), low.shape(0));
    const auto lower = numpy::view(low), upper = numpy::view(high);
    const Index size = tape.equations() * tape.unknowns();
    std::vector<Interval> out(lower.rows * size);
    Sweep<Interval> sweep(tape);
    for (Index i = 0; i < lower.rows; ++i) {
        const auto box = intervals_of(lower.row(i), upper.row(i));
        sweep.linearize(box);
        sweep.jacobian({out.data() + i * size, tape.equations(), tape.unknowns()});
    }
    return ends_of(out, {lower.rows, tape.equations(), tape.unknowns()});
}

// --- methods over a scaled system --------------------------------------------------------------------

template <class S>
S system_of(const Tape& tape, const Doubles& units, const Doubles& weights) {
    check_unknowns("units", units.shape(0), tape.unknowns());
    check_unknowns("weights", weights.shape(0), tape.equations());
    return {tape, numpy::view(units), numpy::view(weights)};
}

inline nb::tuple tape_march(const Tape& tape, const Doubles& units, const Doubles& weights, const Doubles& start,
                            const Doubles& tangent, Index order, double tolerance, double shortest, double longest,
                            Index count, double closing, double misclosure, const Table& anchor, double within,
                            const Doubles& periods, const Table& bounds, double length, bool is_sparse) {
    const MarchSettings settings{order, tolerance, shortest, longest, count, closing, misclosure};
    const std::optional<Region> region = region_of(anchor, within, periods, bounds, length);
    if (is_sparse) return march(system_of<SparseTapeSystem>(tape, units, weights), start, tangent, settings, region);
    return march(system_of<TapeSystem>(tape, units, weights), start, tangent, settings, region);
}

inline nb::tuple tape_project(const Tape& tape, const Doubles& units, const Doubles& weights, const Table& starts,
                              double noise, int iterations, bool is_sparse) {
    if (is_sparse) return project(system_of<SparseTapeSystem>(tape, units, weights), starts, noise, iterations);
    return project(system_of<TapeSystem>(tape, units, weights), starts, noise, iterations);
}

inline nb::tuple tape_project_to_sphere(const Tape& tape, const Doubles& units, const Doubles& weights,
                                        const Table& starts, const Doubles& center, double radius, int iterations) {
    return project_to_sphere(system_of<TapeSystem>(tape, units, weights), starts, center, radius, iterations);
}

inline nb::object tape_valley_points(const Tape& tape, const Doubles& units, const Doubles& weights,
                                     const Doubles& start, const Doubles& heading, const Doubles& offsets,
                                     const Table& predictors, double enough, double most) {
    const auto system = system_of<TapeSystem>(tape, units, weights);
    return valley_points_at_nodes(system, start, heading, offsets, predictors, enough, most);
}

// [F'; t] at one point, factored.
class FactoredTape {
public:
    FactoredTape(const Tape& tape, const Doubles& units, const Doubles& weights, const Doubles& point,
                 const Doubles& tangent)
        : bordered_(tape.sparsity()), right_(tape.equations() + 1), solution_(tape.unknowns()) {
        check_unknowns("point", point.shape(0), tape.unknowns());
        check_unknowns("tangent", tangent.shape(0), tape.unknowns());
        std::vector<double> residual(tape.equations());
        const auto system = system_of<SparseTapeSystem>(tape, units, weights);
        system.linearize(numpy::view(point), residual, bordered_.jacobian());
        bordered_.factor(numpy::view(tangent));
    }

    double smallest_singular_value() { return bordered_.smallest_singular_value(); }

    nb::object solve(const Doubles& right) {
        check_unknowns("right", right.shape(0), static_cast<Index>(right_.size()));
        std::copy(right.data(), right.data() + right.shape(0), right_.begin());
        bordered_.solve(right_, solution_);
        numpy::Array<double> out({static_cast<Index>(solution_.size())});
        out.fill(solution_);
        return out.release();
    }

private:
    SparseBordered bordered_;
    std::vector<double> right_, solution_;
};

inline void bind_tape(nb::module_& module) {
    using nb::arg;
    nb::class_<FactoredTape>(module, "FactoredTape", "The sparse matrix [F'; t] at a point, factored.")
        .def(nb::init<const Tape&, const Doubles&, const Doubles&, const Doubles&, const Doubles&>(), arg("tape"),
             arg("units"), arg("weights"), arg("point"), arg("tangent"), nb::keep_alive<1, 2>())
        .def("smallest_singular_value", &FactoredTape::smallest_singular_value)
        .def("solve", &FactoredTape::solve, arg("right"));
    nb::class_<Tape>(module, "Tape", "A list of operations: equations as data.")
        .def("__init__", &make_tape, arg("unknowns"), arg("operations"), arg("operands"), arg("constants"),
             arg("outputs"))
        .def_prop_ro("unknowns", &Tape::unknowns)
        .def_prop_ro("equations", &Tape::equations)
        .def("residuals", &tape_values<double>, arg("points"))
        .def("complex_residuals", &tape_values<std::complex<double>>, arg("points"))
        .def("jacobians", &tape_jacobians<double>, arg("points"))
        .def("complex_jacobians", &tape_jacobians<std::complex<double>>, arg("points"))
        .def("hessian", &tape_hessian, arg("point"))
        .def("series", &tape_series, arg("curve"))
        .def("pattern", &tape_pattern)
        .def("entries", &tape_entries, arg("point"))
        .def("value_bounds", &tape_value_bounds, arg("low"), arg("high"))
        .def("jacobian_bounds", &tape_jacobian_bounds, arg("low"), arg("high"))
        .def("divide", &divide_boxes, arg("low"), arg("high"), arg("centers"), arg("radii"), arg("periods"),
             arg("smallest"), arg("most"))
        .def("course", &course_on_tape, arg("curve"), arg("centers"), arg("radii"), arg("periods"),
             arg("residual"), arg("shortest"), arg("most"))
        .def("march", &tape_march, arg("units"), arg("weights"), arg("start"), arg("tangent"), arg("order"),
             arg("tolerance"), arg("shortest"), arg("longest"), arg("count"), arg("closing"), arg("misclosure"),
             arg("anchor"), arg("within"), arg("periods"), arg("bounds"), arg("length"), arg("is_sparse"))
        .def("follow_paths", &tape_follow_paths, arg("starts"), arg("first"), arg("last"), arg("combinations"),
             arg("order"), arg("tolerance"), arg("most_steps"), arg("places"), arg("farthest"), arg("is_precise"),
             arg("ends_regular"), arg("seconds"))
        .def("project", &tape_project, arg("units"), arg("weights"), arg("starts"), arg("noise"), arg("iterations"),
             arg("is_sparse"))
        .def("project_to_sphere", &tape_project_to_sphere, arg("units"), arg("weights"), arg("starts"),
             arg("center"), arg("radius"), arg("iterations"))
        .def("valley_points_at_nodes", &tape_valley_points, arg("units"), arg("weights"), arg("start"), arg("heading"),
             arg("offsets"), arg("predictors"), arg("enough"), arg("most"));
}

}  // namespace bifurc::python
