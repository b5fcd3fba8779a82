// Where a curve leaves its bounds.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "bifurc/core/arrays.hpp"
#include "bifurc/core/brackets.hpp"
#include "bifurc/core/trail.hpp"

namespace bifurc {

namespace exits {
constexpr Index places = 32;         // on a piece, beside its begin, at which it is held against the bounds
constexpr double tolerance = 1e-15;  // of the coordinate of an exit
constexpr int steps = 100;           // to it
}  // namespace exits

// The bounds that one piece (order + 1, n) may leave, as its coefficients say.
class NearBounds {
public:
    // Of the ``bounds`` (n, 2), for coordinates of no larger size than ``reach``.
    NearBounds(View<const double> piece, View<const double> bounds, double reach) : piece_(piece) {
        for (Index j = 0; j < piece.columns; ++j) {
            double spread = 0.0;
            for (Index k = piece.rows - 1; k >= 1; --k) spread = (spread + std::abs(piece(k, j))) * reach;
            const double middle = piece(0, j);
            if (!(middle - spread >= bounds(j, 0))) ends_.push_back({j, -1.0, bounds(j, 0)});
            if (!(middle + spread <= bounds(j, 1))) ends_.push_back({j, 1.0, bounds(j, 1)});
        }
    }

    bool empty() const { return ends_.empty(); }

    // The coordinate between two at which the piece leaves them, if it is outside by more than
    // ``slack`` at some place there. A piece that runs in one bound leaves where it crosses another.
    std::optional<double> exit_between(double begin, double end, double slack) const {
        double before = begin;
        for (Index place = 0; place <= exits::places; ++place) {
            const double x = begin + (end - begin) * static_cast<double>(place) / exits::places;
            std::optional<double> first;
            for (const End& one : ends_) {
                if (!(excess(one, x) > slack)) continue;
                const double exit = crossing(one, before, x, slack);
                first = first ? std::min(*first, exit) : exit;
            }
            if (first) return first;
            before = x;
        }
        return {};
    }

private:
    struct End {
        Index unknown;
        double side;  // -1 for the lower one, 1 for the upper
        double bound;
    };

    // How far the piece lies outside one end at a coordinate; negative inside.
    double excess(const End& end, double x) const {
        double value = 0.0;
        for (Index k = piece_.rows - 1; k >= 0; --k) value = value * x + piece_(k, end.unknown);
        return end.side * (value - end.bound);
    }

    // How fast that grows.
    double growth(const End& end, double x) const {
        double slope = 0.0;
        for (Index k = piece_.rows - 1; k >= 1; --k) slope = slope * x + static_cast<double>(k) * piece_(k, end.unknown);
        return end.side * slope;
    }

    // Where the piece crosses one end, ``before`` a coordinate at which it is outside by more than the
    // ``slack``. From a place on the end, give or take rounding, it may run along it for a while: then
    // it is left where the tangent crosses it at the first place outside by the slack.
    double crossing(const End& end, double before, double after, double slack) const {
        const double already = excess(end, before);
        if (already > slack) return before;
        const double level = already < 0.0 ? 0.0 : slack;
        const auto outside = [&](double x) { return excess(end, x) - level; };
        const double x = root_between(outside, before, after, exits::tolerance, exits::steps);
        const double rate = growth(end, x);
        return rate > 0.0 ? std::max(before, x - level / rate) : x;
    }

    View<const double> piece_;
    std::vector<End> ends_;
};

// The arclength at which a curve, from piece number ``first`` on, first leaves the ``bounds`` (n, 2):
// where a piece is outside by more than ``slack`` at some of its places, the exit is between that
// place and the one before. Neighbouring pieces hand over at equal shares of their radii; the first
// piece is looked at from arclength 0 on, the last one as far as it is trusted.
inline std::optional<double> exit_of_bounds(const Trail& trail, Index first, View<const double> bounds, double slack) {
    const Index count = trail.count();
    const auto handover = [&](Index number) {  // from a piece to the next one
        const double before = trail.centers[number], radius = trail.radii[number];
        return before + radius / (radius + trail.radii[number + 1]) * (trail.centers[number + 1] - before);
    };
    double s = first > 0 && first < count ? handover(first - 1) : 0.0;
    for (Index number = first; number < count; ++number) {
        const double center = trail.centers[number], radius = trail.radii[number];
        const double stop = number + 1 < count ? handover(number) : center + radius;
        const double begin = (s - center) / radius, end = (stop - center) / radius;
        s = stop;
        const NearBounds near(trail.piece(number), bounds, std::max(std::abs(begin), std::abs(end)));
        if (near.empty()) continue;
        const std::optional<double> x = near.exit_between(begin, end, slack);
        if (x) return center + *x * radius;
    }
    return {};
}

}  // namespace bifurc
