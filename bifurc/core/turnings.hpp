// Where an unknown turns back along a curve.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "bifurc/core/brackets.hpp"
#include "bifurc/core/curve.hpp"
#include "bifurc/core/polynomial.hpp"

namespace bifurc {

// A place at which the rate of an unknown vanishes, at arclength ``s``; from ``low`` to ``high``
// nothing but rounding is left of it. Its sign ``before`` that and ``after`` it; 0 beyond the ends of
// an open curve.
struct Turning {
    double s, low, high, before, after;
};

// What hides a rate: less than ``share`` of the largest one on the curve, or than ``jump`` times what
// two neighbouring pieces differ by where they meet.
struct Hiding {
    double share, jump;
};

// The rate of one unknown along a curve, a polynomial on every piece, and its changes of sign: all of
// them, but for those on a stretch on which the rate stays hidden.
class UnknownRate {
public:
    UnknownRate(const Curve& curve, Index unknown, const Hiding& hiding) : curve_(curve), unknown_(unknown) {
        const Index count = curve.count();
        double largest = 0.0;
        std::vector<double> sizes;
        for (Index number = 0; number < count; ++number) {
            rates_.push_back(rate_on(number));
            sizes.push_back(rates_.back().size(curve.span(number).reach()));
            largest = std::max(largest, sizes.back());
        }
        for (Index number = 0; number < count; ++number) {
            const double jump = std::max(jump_before(number), jump_before(number + 1));
            hidden_.push_back(std::max({hiding.share * largest, hiding.jump * jump, rounding * sizes[number]}));
        }
    }

    // Where the rate changes its sign, and where it is hidden at an end of an open curve.
    std::vector<Turning> turnings() const {
        const std::vector<Knot> knots = curve_.is_closed() ? knots_round_about() : knots_along();
        std::vector<Turning> found;
        Gap gap;
        const auto close = [&] {
            if (const std::optional<Turning> one = turning_in(gap)) found.push_back(*one);
        };
        for (const Knot& knot : knots) {
            if (knot.sign == 0.0) {
                gap.add(knot);
                continue;
            }
            gap.after = knot;
            close();
            gap = {knot, {}, {}, {}};
        }
        close();
        std::sort(found.begin(), found.end(), [](const Turning& one, const Turning& other) { return one.s < other.s; });
        return found;
    }

private:
    static constexpr double rounding = 1e-15;  // of the size of the terms of a rate
    static constexpr double tolerance = 1e-15;  // of a place, over the length
    static constexpr int most_steps = 100;      // to it

    // The sign of the rate at a place, 0 where it is ``hidden``.
    struct Knot {
        double s, sign, hidden;
    };

    // What lies between two signs: a stretch on which the rate is hidden, or nothing.
    struct Gap {
        std::optional<Knot> before, first_hidden, last_hidden, after;

        void add(const Knot& knot) {
            if (!first_hidden) first_hidden = knot;
            last_hidden = knot;
        }
    };

    Polynomial rate_on(Index number) const {
        const View<const double> piece = curve_.piece(number);
        std::vector<double> rate(std::max<Index>(piece.rows - 1, 1), 0.0);
        for (Index k = 1; k < piece.rows; ++k) {
            rate[k - 1] = static_cast<double>(k) * piece(k, unknown_) / curve_.radius(number);
        }
        return Polynomial(std::move(rate));
    }

    // What a piece and the one before it differ by where they meet.
    double jump_before(Index number) const {
        const bool is_end = number == 0 || number == curve_.count();
        if (is_end && !curve_.is_closed()) return 0.0;
        const Index before = number == 0 ? curve_.count() - 1 : number - 1;
        const Index after = number == curve_.count() ? 0 : number;
        const double left = rates_[before](curve_.span(before).end);
        const double right = rates_[after](curve_.span(after).begin);
        return std::abs(left - right);
    }

    // The signs at the ends of the parts on which the rate is plain.
    std::vector<Knot> knots_along() const {
        std::vector<Knot> knots;
        for (Index number = 0; number < curve_.count(); ++number) {
            const Polynomial& rate = rates_[number];
            const Curve::Span span = curve_.span(number);
            const double hidden = hidden_[number];
            const auto add = [&](double x) {
                const double value = rate(x);
                const double sign = std::abs(value) > hidden ? std::copysign(1.0, value) : 0.0;
                knots.push_back({curve_.arclength(number, x), sign, hidden});
            };
            visit_plain_parts(rate, span.begin, span.end, hidden, [&](const PlainPart& part) {
                add(part.begin);
                add(part.end);
                return true;
            });
        }
        return knots;
    }

    // Those of a closed curve from the first with a sign round to this one; none where there is no sign.
    std::vector<Knot> knots_round_about() const {
        std::vector<Knot> knots = knots_along();
        const auto first = std::find_if(knots.begin(), knots.end(), [](const Knot& knot) { return knot.sign != 0.0; });
        if (first == knots.end()) return {};
        const auto place = first - knots.begin();
        for (std::ptrdiff_t k = 0; k <= place; ++k) {
            const Knot again{knots[k].s + curve_.total(), knots[k].sign, knots[k].hidden};
            knots.push_back(again);
        }
        knots.erase(knots.begin(), knots.begin() + place);
        return knots;
    }

    // What the unknown does in a gap, if it turns back there or is at rest where the curve ends.
    std::optional<Turning> turning_in(const Gap& gap) const {
        if (gap.before && gap.after) {
            if (gap.before->sign == gap.after->sign) return {};
            return turning_between(*gap.before, *gap.after);
        }
        if (!gap.first_hidden) return {};
        if (gap.after) return Turning{0.0, 0.0, edge(*gap.after, gap.last_hidden->s), 0.0, gap.after->sign};
        if (!gap.before) return {};
        const double end = curve_.total();
        return Turning{end, edge(*gap.before, gap.first_hidden->s), end, gap.before->sign, 0.0};
    }

    Turning turning_between(const Knot& before, const Knot& after) const {
        const double s = root(before.s, after.s);
        const double turn = curve_.is_closed() && s >= curve_.total() ? curve_.total() : 0.0;
        return {s - turn, edge(before, s) - turn, edge(after, s) - turn, before.sign, after.sign};
    }

    double root(double low, double high) const {
        const auto rate = [&](double s) { return curve_.rate(s, unknown_); };
        return root_between(rate, low, high, tolerance * curve_.total(), most_steps);
    }

    // How far what hides the rate at ``inner`` reaches towards a knot with a sign.
    double edge(const Knot& knot, double inner) const {
        const auto excess = [&](double s) { return std::abs(curve_.rate(s, unknown_)) - knot.hidden; };
        if (!(excess(inner) < 0.0) || !(excess(knot.s) > 0.0)) return inner;
        return root_between(excess, knot.s, inner, tolerance * curve_.total(), most_steps);
    }

    const Curve& curve_;
    const Index unknown_;
    std::vector<Polynomial> rates_;
    std::vector<double> hidden_;  // on each piece
};

}  // namespace bifurc
