// Boxes in which recorded equations have no solution, or a single arc: `bifurc.search.subdivision`.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

#include "bifurc/core/arrays.hpp"
#include "bifurc/core/balls.hpp"
#include "bifurc/core/interval.hpp"
#include "bifurc/core/inverse.hpp"
#include "bifurc/core/krawczyk.hpp"
#include "bifurc/core/tape.hpp"

namespace bifurc {

namespace boxes {
constexpr double wider = 4.0;  // times as wide as a box is where its arc may run: one that touches a corner, too
constexpr double thin = 1e4;  // times as wide as in the unknown along which F bends most: there a box is cut
constexpr std::array<double, 3> places = {-1.0, 0.0, 1.0};  // of the parameter, at which an arc is looked at
constexpr int newton_steps = 5;                             // to an arc from its chord
}  // namespace boxes

enum class Content { nothing, arc, open };

// The single arc in a box.
struct BoxedArc {
    IntervalBox box;
    IntervalBox room;             // in which it stays
    Matrix<double> points;        // (3, n) of the arc at `boxes::places` of the parameter, to rounding
    std::vector<char> is_steady;  // whether an unknown rises or falls all along it (n)
};

// What is in the box (n) that was taken last, and where to cut it. An arc may run where the box is some times as
// ``wide``.
class BoxTest {
public:
    BoxTest(const Tape& tape, double wider)
        : n_(tape.unknowns()),
          wider_(wider),
          sweep_(tape),
          point_sweep_(tape),
          frame_(n_),
          at_middle_(n_),
          wide_(n_),
          values_(n_ - 1),
          rates_(n_ - 1),
          middle_(n_),
          radii_(n_),
          bends_(n_),
          jacobian_(n_ - 1, n_),
          at_point_(n_ - 1, n_),
          inverse_(n_ - 1, n_ - 1),
          pivots_(n_ - 1) {}

    void take(const IntervalBox& box) {
        box_ = box;
        for (Index j = 0; j < n_; ++j) {
            middle_[j] = box[j].middle();
            at_middle_[j] = middle_[j];
            radii_[j] = (box[j] - at_middle_[j]).magnitude();
            bends_[j] = infinite;
        }
    }

    const IntervalBox& box() const { return box_; }
    Vector<const double> middle() const { return middle_; }
    Vector<const double> radii() const { return radii_; }

    // By bounds on F in the box; on F in its middle and F' in the box; and by Krawczyk's test in a box that is
    // wider but for the parameter.
    Content content() {
        evaluate(box_);
        const auto may_be_zero = [](const Interval& value) { return value.contains(0.0); };
        if (!std::all_of(values_.begin(), values_.end(), may_be_zero)) return Content::nothing;
        if (!linearize(box_)) return Content::open;
        if (!frame_.choose(jacobian_, radii_)) return Content::open;
        evaluate(at_middle_);
        frame_.take_values(values_);
        frame_.take_jacobian(jacobian_, radii_);
        if (frame_.leaves_out_zero()) return Content::nothing;
        for (Index j = 0; j < n_; ++j) bends_[j] = frame_.spread(j);
        // F' in the box itself says first whether the wider one is worth a look
        if (!frame_.reaches_less(1.0, wider_)) return Content::open;
        return has_single_arc() ? Content::arc : Content::open;
    }

    // Of a box that has a single arc.
    BoxedArc arc() {
        BoxedArc arc{box_, wide_, Matrix<double>(boxes::places.size(), n_), std::vector<char>(n_, true)};
        for (Index i = 0; i < arc.points.rows(); ++i) follow(boxes::places[i], arc.points.row(i));
        frame_.find_rates(rates_);
        for (Index i = 0; i + 1 < n_; ++i) arc.is_steady[frame_.pivot(i)] = !rates_[i].contains(0.0);
        return arc;
    }

    // Cuts the box twice where F bends most, and calls ``visit`` with its quarters. Cuts where F is steep, as Kearfott
    // and Novoa (1990) make them, leave needles about singular points.
    template <class Visitor>
    void quarter(Visitor visit) const {
        std::vector<double> radii = radii_, bends = bends_;
        const Index first = side_to_cut(radii, bends);
        radii[first] *= 0.5;
        bends[first] *= 0.5;
        const Index second = side_to_cut(radii, bends);
        for (const IntervalBox& half : halves(box_, first)) {
            for (const IntervalBox& quarter : halves(half, second)) visit(quarter);
        }
    }

private:
    static constexpr double infinite = std::numeric_limits<double>::infinity();

    void evaluate(Vector<const Interval> box) {
        sweep_.evaluate(box);
        for (Index row = 0; row + 1 < n_; ++row) values_[row] = sweep_.value(row);
    }

    // F' in a box; false where it is not bounded.
    bool linearize(Vector<const Interval> box) {
        sweep_.linearize(box);
        sweep_.jacobian(jacobian_);
        for (Index row = 0; row + 1 < n_; ++row) {
            for (const Interval& entry : jacobian_.row(row)) {
                if (!entry.is_finite()) return false;
            }
        }
        return true;
    }

    bool has_single_arc() {
        for (Index j = 0; j < n_; ++j) {
            const double reach = wider_ * radii_[j];
            wide_[j] = at_middle_[j] + Interval(-reach, reach);
        }
        wide_[frame_.parameter()] = box_[frame_.parameter()];
        if (!linearize(wide_)) return false;
        frame_.take_jacobian(jacobian_, radii_);
        return frame_.reaches_less(wider_, wider_);
    }

    // The arc at one place of the parameter: Newton's method from its chord.
    void follow(double place, Vector<double> point) {
        const Index parameter = frame_.parameter();
        point[parameter] = middle_[parameter] + place * radii_[parameter];
        for (Index i = 0; i + 1 < n_; ++i) {
            const Index j = frame_.pivot(i);
            const double offset = frame_.gap(i).middle() + place * frame_.slope(i).middle();
            point[j] = middle_[j] - offset * radii_[j];
        }
        for (int step = 0; step < boxes::newton_steps; ++step) {
            if (!improve(point)) break;
        }
    }

    bool improve(Vector<double> point) {
        point_sweep_.linearize(point);
        point_sweep_.jacobian(at_point_);
        for (Index row = 0; row + 1 < n_; ++row) {
            for (Index i = 0; i + 1 < n_; ++i) inverse_(row, i) = at_point_(row, frame_.pivot(i));
        }
        if (invert(inverse_, pivots_) == 0.0) return false;
        for (Index i = 0; i + 1 < n_; ++i) {
            double step = 0.0;
            for (Index row = 0; row + 1 < n_; ++row) step += inverse_(i, row) * point_sweep_.value(row);
            if (!std::isfinite(step)) return false;
            point[frame_.pivot(i)] -= step;
        }
        return true;
    }

    // Where F bends most, or where the box is widest if that is not known or the box is thin there.
    static Index side_to_cut(const std::vector<double>& radii, const std::vector<double>& bends) {
        const auto most = std::max_element(bends.begin(), bends.end());
        const auto widest = std::max_element(radii.begin(), radii.end());
        const Index side = most - bends.begin();
        const bool is_known = *most > 0.0 && *most < infinite;
        const bool is_thin = boxes::thin * radii[side] < *widest;
        return is_known && !is_thin ? side : widest - radii.begin();
    }

    static std::array<IntervalBox, 2> halves(const IntervalBox& box, Index side) {
        std::array<IntervalBox, 2> halves = {box, box};
        halves[0][side].high = halves[1][side].low = box[side].middle();
        return halves;
    }

    Index n_;
    double wider_;
    Sweep<Interval> sweep_;
    Sweep<double> point_sweep_;
    Preconditioned frame_;
    IntervalBox box_, at_middle_, wide_, values_, rates_;
    std::vector<double> middle_, radii_, bends_;
    Matrix<Interval> jacobian_;
    Matrix<double> at_point_, inverse_;
    std::vector<Index> pivots_;
};

// What became of boxes (n).
struct Division {
    Index count = 0;                  // of boxes that were looked at
    std::deque<IntervalBox> waiting;  // that were not
    std::vector<IntervalBox> small;   // not settled, and smaller than asked for
    std::vector<BoxedArc> arcs;
};

// Looks at ``most`` boxes, those that are ``waiting`` and quarters of those that are not settled by a `BoxTest` and
// in no ball. Boxes are divided until all radii are below ``smallest``.
inline void divide(const Tape& tape, const Balls& balls, double smallest, Index most, Division& division) {
    BoxTest test(tape, boxes::wider);
    while (!division.waiting.empty() && division.count < most) {
        test.take(division.waiting.front());
        division.waiting.pop_front();
        ++division.count;
        if (balls.hold(test.middle(), length(test.radii()))) continue;
        const Content content = test.content();
        if (content == Content::nothing) continue;
        if (content == Content::arc) {
            division.arcs.push_back(test.arc());
        } else if (*std::max_element(test.radii().begin(), test.radii().end()) < smallest) {
            division.small.push_back(test.box());
        } else {
            test.quarter([&](const IntervalBox& quarter) { division.waiting.push_back(quarter); });
        }
    }
}

}  // namespace bifurc
