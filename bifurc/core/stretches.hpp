// Whether a traced curve is one of solutions all along: `bifurc.search.subdivision`.
#pragma once

#include <array>
#include <cmath>
#include <deque>

#include "bifurc/core/arrays.hpp"
#include "bifurc/core/balls.hpp"
#include "bifurc/core/boxes.hpp"
#include "bifurc/core/curve.hpp"
#include "bifurc/core/tape.hpp"

namespace bifurc {

namespace stretches {
// Of half a stretch: by how much the boxes about it are wider. A thin one keeps apart from what runs beside it, a thick
// one holds where F' is known too little for the thin one.
constexpr std::array<double, 3> margins = {1e-4, 1e-2, 1.0};
constexpr double wider = 2.0;  // times as wide as that box is where the arc may run
}  // namespace stretches

// |F| at a point (n).
inline double gap_at(const Tape& tape, Sweep<double>& sweep, Vector<const double> point) {
    sweep.evaluate(point);
    double square = 0.0;
    for (Index row = 0; row < tape.equations(); ++row) square += sweep.value(row) * sweep.value(row);
    return std::sqrt(square);
}

enum class Course : int {
    solved,
    missed,  // it solves nothing at an arclength
    open,    // it may solve nothing at one
};

struct CourseOutcome {
    Course course;
    double s;
};

struct CourseSettings {
    double residual;  // |F| of a solution, at most
    double shortest;  // half a stretch that is not divided any more
    Index most;       // stretches that are divided
};

// What is known of a curve: solved, if next to every stretch of it that is in no ball there
// runs one single arc.
inline CourseOutcome course_of(const Tape& tape, const Curve& curve, const Balls& balls,
                               const CourseSettings& settings) {
    struct Stretch {
        Index piece;
        double begin, end;
    };
    std::deque<Stretch> waiting;
    for (Index piece = 0; piece < curve.count(); ++piece) {
        waiting.push_back({piece, curve.begin_of(piece), curve.begin_of(piece + 1)});
    }
    BoxTest test(tape, stretches::wider);
    Sweep<double> sweep(tape);
    Matrix<double> middle(1, tape.unknowns());
    IntervalBox box(tape.unknowns());
    CourseOutcome outcome{Course::solved, 0.0};
    Index count = 0;
    while (!waiting.empty()) {
        const auto [piece, begin, end] = waiting.front();
        waiting.pop_front();
        ++count;
        const double s = 0.5 * (begin + end), half = 0.5 * (end - begin);
        curve.evaluate({&s, 1}, 0, middle);
        if (balls.hold(middle.row(0), half)) continue;
        if (!(gap_at(tape, sweep, middle.row(0)) <= settings.residual)) return {Course::missed, s};
        Content content = Content::open;
        for (double margin : stretches::margins) {
            if (content == Content::arc) break;
            curve.enclose(piece, begin, end, box);
            for (Interval& side : box) side += Interval(-margin * half, margin * half);
            test.take(box);
            content = test.content();
        }
        if (content == Content::nothing) return {Course::missed, s};
        if (content == Content::arc || outcome.course == Course::open) continue;
        if (half < settings.shortest || count > settings.most) {
            outcome = {Course::open, s};
        } else {
            waiting.push_back({piece, begin, s});
            waiting.push_back({piece, s, end});
        }
    }
    return outcome;
}

}  // namespace bifurc
