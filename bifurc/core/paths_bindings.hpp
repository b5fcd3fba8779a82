// Paths of solutions handed over to Python.
#pragma once

#include <complex>
#include <cstdint>
#include <optional>

#include "bifurc/core/bindings.hpp"
#include "bifurc/core/deadline.hpp"
#include "bifurc/core/mixed_cells.hpp"
#include "bifurc/core/paths.hpp"

namespace bifurc::python {

using ComplexMatrix = numpy::MatrixIn<std::complex<double>>;

// (points (k, n), rests (k), `PathEnd` numbers (k), windings (k), steps (k)) of paths from solutions (k, n)
// at the parameters ``first`` (k, q) to ``last`` (k, q). ``combinations`` (n, m) of the equations are solved, or,
// where it has no rows, the equations themselves. The first unknowns are homogeneous coordinates of so many
// ``places``, and what is farther away than ``farthest`` is of no interest.
// ``is_precise``: residuals are computed with twice the digits of doubles. ``ends_regular``: so are known to be all
// ends.
inline nb::tuple tape_follow_paths(const Tape& tape, const ComplexMatrix& starts, const ComplexMatrix& first,
                                   const ComplexMatrix& last, const ComplexMatrix& combinations, Index order,
                                   double tolerance, int most_steps, Index places, double farthest,
                                   bool is_precise, bool ends_regular, double seconds) {
    const auto count = static_cast<Index>(starts.shape(0)), n = static_cast<Index>(starts.shape(1));
    for (const ComplexMatrix& parameters : {first, last}) {
        check_unknowns("parameters", parameters.shape(1), tape.unknowns() - n);
        if (parameters.shape(0) != starts.shape(0)) throw nb::value_error("parameters must have a row for each start");
    }
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
        PathSystem system(tape, n, numpy::view(combinations), order);
        PathTracker tracker(system, {order, tolerance, most_steps, places, farthest, is_precise, ends_regular});
        for (Index k = 0; k < count; ++k) {
            PathTracker::Outcome outcome{{from.row(k).begin(), from.row(k).end()}};
            outcome.end = PathEnd::out_of_time;
            if (!deadline.has_passed()) {
                system.set_line(numpy::view(first).row(k), numpy::view(last).row(k));
                outcome = tracker.follow(from.row(k));
            }
            std::copy(outcome.point.begin(), outcome.point.end(), points.matrix().row(k).begin());
            rests.data()[k] = outcome.rest;
            ends.data()[k] = static_cast<std::int64_t>(outcome.end);
            windings.data()[k] = outcome.winding;
            steps.data()[k] = outcome.steps;
        }
    }
    return nb::make_tuple(points.release(), rests.release(), ends.release(), windings.release(), steps.release());
}

// (`CellsEnd`, first points (c, n), second points (c, n), inverses times volumes (c, n, n), volumes (c),
// heights (c, t)) of the mixed cells of supports, as `MixedCells` takes them.
inline nb::tuple mixed_cells(const numpy::MatrixIn<std::int64_t>& exponents, const numpy::VectorIn<std::int64_t>& sizes,
                             const numpy::VectorIn<double>& lifts, std::int64_t most, double seconds) {
    const auto points = static_cast<Index>(exponents.shape(0)), n = static_cast<Index>(exponents.shape(1));
    std::int64_t total = 0;
    for (std::int64_t size : numpy::view(sizes)) total += size;
    check_unknowns("sizes", sizes.shape(0), n);
    check_unknowns("exponents", exponents.shape(0), total);
    check_unknowns("lifts", lifts.shape(0), points + n * (n + 1));
    std::optional<MixedCells> cells;
    {
        nb::gil_scoped_release release;
        Deadline deadline(seconds, raise_signals);
        cells.emplace(numpy::view(exponents), numpy::view(sizes), numpy::view(lifts), most, deadline);
    }
    const auto count = cells->end() == CellsEnd::all ? static_cast<Index>(cells->cells().size()) : 0;
    numpy::Array<std::int64_t> first({count, n}), second({count, n}), inverses({count, n, n}), volumes({count});
    numpy::Array<double> heights({count, points});
    for (Index k = 0; k < count; ++k) {
        const MixedCell& cell = cells->cells()[k];
        std::copy(cell.first.begin(), cell.first.end(), first.matrix().row(k).begin());
        std::copy(cell.second.begin(), cell.second.end(), second.matrix().row(k).begin());
        const View<const std::int64_t> inverse = cell.inverse;
        std::copy_n(inverse.data, n * n, inverses.entry(k).data);
        volumes.data()[k] = cell.volume;
        cells->heights(cell, heights.matrix().row(k));
    }
    return nb::make_tuple(static_cast<int>(cells->end()), first.release(), second.release(), inverses.release(),
                          volumes.release(), heights.release());
}

}  // namespace bifurc::python
