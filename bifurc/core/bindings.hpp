// What the modules of bifurc and linkages hand over to Python of any system.
#pragma once

#include <string>
#include <vector>

#include "bifurc/core/march.hpp"
#include "bifurc/core/numpy.hpp"
#include "bifurc/core/projection.hpp"

namespace bifurc::python {

namespace nb = nanobind;
using Doubles = numpy::VectorIn<double>;
using Table = numpy::MatrixIn<double>;

inline void check_unknowns(const char* name, Index given, Index needed) {
    if (given == needed) return;
    const std::string text = std::string(name) + ": " + std::to_string(given) + " unknowns are not allowed; there must be " +
                             std::to_string(needed);
    throw nb::value_error(text.c_str());
}

// Lets Ctrl-C through from a computation that does not hold the lock of the interpreter: for
// `Deadline`.
inline void raise_signals() {
    nb::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

// Says nothing of what is alive when the interpreter ends. The bindings hold no reference of their own
// (`tests/bifurc/test_core.py` counts them); but a daemon thread that still runs then, such as that
// of a test runner's worker, keeps what its frames refer to, and nanobind would list that as leaked.
inline void leave_what_threads_hold() { nb::set_leak_warnings(false); }

template <System S>
nb::object residuals(const S& system, const Table& points) {
    check_unknowns("points", points.shape(1), system.unknowns());
    const View<const double> at = numpy::view(points);
    numpy::Array<double> out({at.rows, system.equations()});
    for (Index i = 0; i < at.rows; ++i) system.residual(at.row(i), out.matrix().row(i));
    return out.release();
}

template <DenseSystem S>
nb::object jacobians(const S& system, const Table& points) {
    check_unknowns("points", points.shape(1), system.unknowns());
    const View<const double> at = numpy::view(points);
    numpy::Array<double> out({at.rows, system.equations(), system.unknowns()});
    std::vector<double> residual(system.equations());
    for (Index i = 0; i < at.rows; ++i) system.linearize(at.row(i), residual, out.entry(i));
    return out.release();
}

// (status, pieces (k, order + 1, n), steps (k), radii (k), residuals (k), sigmas (k)) as `bifurc.problem.March`
// has them: the pieces in the variable (s - centre) / radius.
inline nb::tuple arrays_of(const MarchOutcome& outcome, Index order, Index n) {
    const auto count = static_cast<Index>(outcome.pieces.size());
    const bool is_open = outcome.status == MarchStatus::open;
    numpy::Array<double> pieces({count, order + 1, n}), steps({count}), radii({count});
    numpy::Array<double> residuals({is_open ? 1 : count}), sigmas({count});
    if (is_open) residuals.data()[0] = outcome.gap;
    for (Index i = 0; i < count; ++i) {
        const TaylorPiece& piece = outcome.pieces[i];
        steps.data()[i] = piece.step;
        radii.data()[i] = piece.radius;
        residuals.data()[i] = piece.residual;
        sigmas.data()[i] = piece.sigma;
        const View<double> scaled = pieces.entry(i);
        double power = 1.0;
        for (Index k = 0; k <= order; ++k) {
            for (Index j = 0; j < n; ++j) scaled(k, j) = power * piece.coefficients(k, j);
            power *= piece.radius;
        }
    }
    return nb::make_tuple(static_cast<int>(outcome.status), pieces.release(), steps.release(), radii.release(),
                          residuals.release(), sigmas.release());
}

// Where a march may stop early, as Python has it: an anchor (2, n) of a point and a direction, empty
// where there is none.
inline std::optional<Region> region_of(const Table& anchor, double within, const Doubles& periods,
                                       const Table& bounds, double length) {
    if (anchor.shape(0) == 0) return {};
    const View<const double> place = numpy::view(anchor);
    return Region{place.row(0), place.row(1), within, numpy::view(periods), numpy::view(bounds), length};
}

template <System S>
nb::tuple march(const S& system, const Doubles& start, const Doubles& tangent, const MarchSettings& settings,
                const std::optional<Region>& region = {}) {
    check_unknowns("start", start.shape(0), system.unknowns());
    check_unknowns("tangent", tangent.shape(0), system.unknowns());
    MarchOutcome outcome;
    {
        nb::gil_scoped_release release;
        outcome = Marcher(system, settings).run(numpy::view(start), numpy::view(tangent), region);
    }
    return arrays_of(outcome, settings.order, system.unknowns());
}

// (points (k, n), gaps (k))
template <System S>
nb::tuple project(const S& system, const Table& starts, double noise, int iterations) {
    check_unknowns("starts", starts.shape(1), system.unknowns());
    const auto count = static_cast<Index>(starts.shape(0));
    numpy::Array<double> points({count, system.unknowns()}), gaps({count});
    points.fill({starts.data(), starts.size()});
    {
        nb::gil_scoped_release release;
        bifurc::project(system, points.matrix(), gaps.vector(), noise, iterations);
    }
    return nb::make_tuple(points.release(), gaps.release());
}

// (points (k, n), gaps (k), last steps (k))
template <DenseSystem S>
nb::tuple project_to_sphere(const S& system, const Table& starts, const Doubles& center, double radius,
                            int iterations) {
    check_unknowns("starts", starts.shape(1), system.unknowns());
    check_unknowns("center", center.shape(0), system.unknowns());
    const auto count = static_cast<Index>(starts.shape(0));
    numpy::Array<double> points({count, system.unknowns()}), gaps({count}), last_steps({count});
    points.fill({starts.data(), starts.size()});
    {
        nb::gil_scoped_release release;
        bifurc::project_to_sphere(system, points.matrix(), numpy::view(center), radius, iterations, gaps.vector(),
                                  last_steps.vector());
    }
    return nb::make_tuple(points.release(), gaps.release(), last_steps.release());
}

}  // namespace bifurc::python
