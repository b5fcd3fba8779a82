// Where a curve leaves its bounds.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "bifurc/core/arrays.hpp"
#include "bifurc/core/brackets.hpp"
#include "bifurc/core/polynomial.hpp"
#include "bifurc/core/trail.hpp"

namespace bifurc {

namespace exits {
constexpr double tolerance = 1e-15;  // of the coordinate of an exit
constexpr int steps = 100;           // to it
constexpr double rounding = 1e-15;   // of the size of the terms of a piece
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

    // The first coordinate between two at which the piece leaves them, if it is outside by more than
    // ``slack`` anywhere there. A piece that runs in one bound leaves where it crosses another.
    std::optional<double> exit_between(double begin, double end, double slack) const {
        std::optional<double> first;
        for (const End& one : ends_) {
            const std::optional<double> exit = exit_by(one, begin, end, slack);
            if (exit) first = first ? std::min(*first, *exit) : exit;
        }
        return first;
    }

private:
    struct End {
        Index unknown;
        double side;  // -1 for the lower one, 1 for the upper
        double bound;
    };

    // The same by one end.
    std::optional<double> exit_by(const End& one, double begin, double end, double slack) const {
        const Polynomial outside = excess(one, 0.0), beyond = excess(one, slack);
        const double hidden = exits::rounding * beyond.size(std::max(std::abs(begin), std::abs(end)));
        std::optional<double> inside, exit;
        visit_plain_parts(beyond, begin, end, hidden, [&](const PlainPart& part) {
            for (double x : {part.begin, part.end}) {
                if (!part.is_flat && beyond(x) > 0.0) {
                    exit = inside ? crossing(outside, *inside, x) : crossing_along(outside, part.begin, x, slack);
                    return false;
                }
                if (outside(x) < -slack) inside = x;
            }
            return true;
        });
        return exit ? std::optional(std::max(begin, *exit)) : exit;
    }

    // How far the piece lies outside one end by more than the ``slack``; negative inside.
    Polynomial excess(const End& end, double slack) const {
        std::vector<double> series(piece_.rows);
        for (Index k = 0; k < piece_.rows; ++k) series[k] = end.side * piece_(k, end.unknown);
        series[0] -= end.side * end.bound + slack;
        return Polynomial(std::move(series));
    }

    // Where a piece crosses an end, from a coordinate ``inside`` to one ``outside``.
    static double crossing(const Polynomial& excess, double inside, double outside) {
        return root_between(excess, inside, outside, exits::tolerance, exits::steps);
    }

    // The same from a coordinate ``before`` at which it is on the end, give or take the ``slack``. It
    // may run along it for a while: it is left where the tangent crosses it at the first place
    // outside by the slack.
    static double crossing_along(const Polynomial& excess, double before, double outside, double slack) {
        if (excess(before) > slack) return before;
        const auto beyond = [&](double x) { return excess(x) - slack; };
        const double x = root_between(beyond, before, outside, exits::tolerance, exits::steps);
        const double rate = excess.slope(x);
        return rate > 0.0 ? x - slack / rate : x;
    }

    View<const double> piece_;
    std::vector<End> ends_;
};

// The arclength at which a curve, from piece number ``first`` on, first leaves the ``bounds`` (n, 2),
// on its way to where it is outside by more than ``slack``. Neighbouring pieces hand over at equal shares of their radii; the first
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
