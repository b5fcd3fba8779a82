// Whether a traced curve is one of solutions all along: `bifurc.search.stretches`.
#pragma once

#include <cmath>
#include <deque>

#include "bifurc/core/arrays.hpp"
#include "bifurc/core/balls.hpp"
#include "bifurc/core/boxes.hpp"
#include "bifurc/core/curve.hpp"
#include "bifurc/core/tape.hpp"

namespace bifurc {

namespace stretches {
constexpr double arclength = 1.001;  // times the distance from the middle, at most, that s is off it
constexpr double wider = 2.0;        // times as wide as a stretch is where its arc may run
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

// What is known of a curve with ``breaks`` (k + 1): solved, if next to every stretch of it that is in no ball there
// runs one single arc.
inline CourseOutcome course_of(const Tape& tape, const Curve& curve, Vector<const double> breaks, const Balls& balls,
                               const CourseSettings& settings) {
    struct Stretch {
        double begin, end;
    };
    std::deque<Stretch> waiting;
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k) waiting.push_back({breaks[k], breaks[k + 1]});
    BoxTest test(tape, stretches::wider);
    Sweep<double> sweep(tape);
    Matrix<double> middle(1, tape.unknowns());
    IntervalBox box(tape.unknowns());
    CourseOutcome outcome{Course::solved, 0.0};
    Index count = 0;
    while (!waiting.empty()) {
        const auto [begin, end] = waiting.front();
        waiting.pop_front();
        ++count;
        const double s = 0.5 * (begin + end), half = 0.5 * (end - begin), reach = stretches::arclength * half;
        curve.evaluate({&s, 1}, 0, middle);
        if (balls.hold(middle.row(0), half)) continue;
        for (Index j = 0; j < tape.unknowns(); ++j) box[j] = Interval(middle(0, j)) + Interval(-reach, reach);
        test.take(box);
        const Content content = test.content();
        if (content == Content::nothing || !(gap_at(tape, sweep, middle.row(0)) <= settings.residual)) return {Course::missed, s};
        if (content == Content::arc || outcome.course == Course::open) continue;
        if (half < settings.shortest || count > settings.most) {
            outcome = {Course::open, s};
        } else {
            waiting.push_back({begin, s});
            waiting.push_back({s, end});
        }
    }
    return outcome;
}

}  // namespace bifurc
