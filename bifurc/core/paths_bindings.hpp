// Paths of solutions handed over to Python.
#pragma once

#include <complex>
#include <cstdint>

#include "bifurc/core/bindings.hpp"
#include "bifurc/core/deadline.hpp"
#include "bifurc/core/paths.hpp"

namespace bifurc::python {

using ComplexVector = numpy::VectorIn<std::complex<double>>;
using ComplexMatrix = numpy::MatrixIn<std::complex<double>>;

// (points (k, n), rests (k), `PathEnd` numbers (k), windings (k), steps (k)) of paths from solutions (k, n)
// at the parameters ``first`` (q) to ``last`` (q). ``combinations`` (n, m) of the equations are solved, or,
// where it has no rows, the equations themselves. The first unknowns are homogeneous coordinates of so many
// ``places``, and what is farther away than ``farthest`` is of no interest.
// ``is_precise``: residuals are computed with twice the digits of doubles.
inline nb::tuple tape_follow_paths(const Tape& tape, const ComplexMatrix& starts, const ComplexVector& first,
                                   const ComplexVector& last, const ComplexMatrix& combinations, Index order,
                                   double tolerance, int most_steps, Index places, double farthest,
                                   bool is_precise, double seconds) {
    const auto count = static_cast<Index>(starts.shape(0)), n = static_cast<Index>(starts.shape(1));
    check_unknowns("first", first.shape(0), tape.unknowns() - n);
    check_unknowns("last", last.shape(0), tape.unknowns() - n);
    if (combinations.shape(0)) {
        check_unknowns("combinations", combinations.shape(0), n);
        check_unknowns("combinations", combinations.shape(1), tape.equations());
    } else {
        check_unknowns("starts", n, tape.equations());
    }
    if (places < 0 || places > n) throw nb::value_error("places must be from 0 to the number of unknowns");
    if (order < 8) throw nb::value_error("order must be 8 or more");
    const auto from = numpy::view(starts);
    numpy::Array<std::complex<double>> points({count, n});
    numpy::Array<double> rests({count});
    numpy::Array<std::int64_t> ends({count}), windings({count}), steps({count});
    {
        nb::gil_scoped_release release;
        Deadline deadline(seconds, raise_signals);
        PathSystem system(tape, n, numpy::view(combinations), numpy::view(first), numpy::view(last), order);
        PathTracker tracker(system, {order, tolerance, most_steps, places, farthest, is_precise});
        for (Index k = 0; k < count; ++k) {
            PathTracker::Outcome outcome{{from.row(k).begin(), from.row(k).end()}};
            outcome.end = PathEnd::out_of_time;
            if (!deadline.has_passed()) outcome = tracker.follow(from.row(k));
            std::copy(outcome.point.begin(), outcome.point.end(), points.matrix().row(k).begin());
            rests.data()[k] = outcome.rest;
            ends.data()[k] = static_cast<std::int64_t>(outcome.end);
            windings.data()[k] = outcome.winding;
            steps.data()[k] = outcome.steps;
        }
    }
    return nb::make_tuple(points.release(), rests.release(), ends.release(), windings.release(), steps.release());
}

}  // namespace bifurc::python
