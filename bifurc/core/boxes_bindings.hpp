// Divided boxes handed over to Python.
#pragma once

#include <nanobind/nanobind.h>

#include <algorithm>

#include "bifurc/core/bindings.hpp"
#include "bifurc/core/boxes.hpp"
#include "bifurc/core/stretches.hpp"

namespace bifurc::python {

inline std::vector<Interval> intervals_of(Vector<const double> low, Vector<const double> high) {
    std::vector<Interval> box(low.size());
    for (std::size_t j = 0; j < box.size(); ++j) box[j] = Interval(low[j], high[j]);
    return box;
}

// (low (k, n), high (k, n)) of some boxes.
template <class Boxes>
nb::tuple ends_of_boxes(const Boxes& boxes, Index n) {
    numpy::Array<double> low({static_cast<Index>(boxes.size()), n}), high({static_cast<Index>(boxes.size()), n});
    Index row = 0;
    for (const IntervalBox& box : boxes) {
        for (Index j = 0; j < n; ++j) {
            low.matrix()(row, j) = box[j].low;
            high.matrix()(row, j) = box[j].high;
        }
        ++row;
    }
    return nb::make_tuple(low.release(), high.release());
}

inline void check_division(const Tape& tape, const Table& centers, const Doubles& radii, const Doubles& periods) {
    if (tape.equations() + 1 != tape.unknowns()) {
        throw nb::value_error("there must be one equation fewer than unknowns");
    }
    check_unknowns("centers", centers.shape(1), tape.unknowns());
    check_unknowns("periods", periods.shape(0), tape.unknowns());
    if (radii.shape(0) != centers.shape(0)) throw nb::value_error("radii: there must be one for each center");
}

// (count, (low, high) of boxes that were not looked at, (low, high) of small ones, (low, high) of those with an arc,
// (low, high) of where the arcs stay, points (a, 3, n), is_steady (a, n)) of boxes (k, n): `divide`.
inline nb::tuple divide_boxes(const Tape& tape, const Table& low, const Table& high, const Table& centers,
                              const Doubles& radii, const Doubles& periods, double smallest, Index most) {
    const Index n = tape.unknowns();
    check_division(tape, centers, radii, periods);
    check_unknowns("low", low.shape(1), n);
    check_unknowns("high", high.shape(1), n);
    if (high.shape(0) != low.shape(0)) throw nb::value_error("high: there must be a row for each row of low");
    Division division;
    {
        nb::gil_scoped_release release;
        for (Index row = 0; row < static_cast<Index>(low.shape(0)); ++row) {
            division.waiting.push_back(intervals_of(numpy::view(low).row(row), numpy::view(high).row(row)));
        }
        const Balls balls{numpy::view(centers), numpy::view(radii), numpy::view(periods)};
        divide(tape, balls, smallest, most, division);
    }
    const auto count = static_cast<Index>(division.arcs.size());
    const Index places = boxes::places.size();
    std::vector<IntervalBox> with_arcs, rooms;
    numpy::Array<double> points({count, places, n});
    numpy::Array<bool> is_steady({count, n});
    for (Index row = 0; row < count; ++row) {
        const BoxedArc& arc = division.arcs[row];
        with_arcs.push_back(arc.box);
        rooms.push_back(arc.room);
        std::copy_n(arc.points.view().data, places * n, points.entry(row).data);
        std::copy(arc.is_steady.begin(), arc.is_steady.end(), is_steady.matrix().row(row).begin());
    }
    return nb::make_tuple(division.count, ends_of_boxes(division.waiting, n), ends_of_boxes(division.small, n),
                          ends_of_boxes(with_arcs, n), ends_of_boxes(rooms, n), points.release(), is_steady.release());
}

// (course, s): `course_of`.
inline nb::tuple course_on_tape(const Tape& tape, const Curve& curve, const Table& centers,
                                const Doubles& radii, const Doubles& periods, double residual, double shortest,
                                Index most) {
    check_division(tape, centers, radii, periods);
    check_unknowns("curve", curve.unknowns(), tape.unknowns());
    CourseOutcome outcome;
    {
        nb::gil_scoped_release release;
        const Balls balls{numpy::view(centers), numpy::view(radii), numpy::view(periods)};
        outcome = course_of(tape, curve, balls, {residual, shortest, most});
    }
    return nb::make_tuple(static_cast<int>(outcome.course), outcome.s);
}

}  // namespace bifurc::python
