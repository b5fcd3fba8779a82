// A traced curve, a polynomial on every piece: its values, and the feet of points on it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "bifurc/core/arrays.hpp"
#include "bifurc/core/interval.hpp"
#include "bifurc/core/periods.hpp"

namespace bifurc {

constexpr double arclength_rounding = 1e-9;  // of the length of a curve, by which an arclength may lie beyond its ends

struct Foot {
    double distance;
    double s;
};

// ``pieces`` (k * (order + 1), n) are the coefficients of all pieces in (s - center) / radius,
// ``breaks`` (k + 1) the arclengths at which they hand over, ``periods`` (n) those of the unknowns
// (infinite where there is none), ``travel`` (n) what a closed curve gains in one turn, empty for
// an open one.
struct CurveData {
    std::vector<double> breaks, centers, radii;
    Matrix<double> pieces;
    std::vector<double> periods, travel;
};

// A function of the unknowns: the coefficients (n) of `Curve::rate_of_height`.
struct Height {
    Vector<const double> weights, phases, angular, linear;
};

class Curve : private CurveData {
public:
    explicit Curve(CurveData data) : CurveData(std::move(data)) { take_samples(); }

    bool is_closed() const { return !travel.empty(); }
    double total() const { return breaks.back(); }
    Index count() const { return static_cast<Index>(radii.size()); }
    // The arclength at which a piece begins, the curve ends for the one after the last.
    double begin_of(Index number) const { return breaks[number]; }
    Index order() const { return count() ? pieces.rows() / count() - 1 : 0; }
    Index unknowns() const { return pieces.columns(); }
    View<const double> piece(Index number) const {
        const Index powers = order() + 1;
        return {&pieces(number * powers, 0), powers, pieces.columns()};
    }

    // Whether all arclengths (k) are numbers and on the curve, but for rounding; on a closed one any number is.
    bool has_all(Vector<const double> s) const {
        const double beyond = is_closed() ? std::numeric_limits<double>::max() : arclength_rounding * total();
        return std::all_of(s.begin(), s.end(), [&](double at) { return at >= -beyond && at - total() <= beyond; });
    }

    // u(s), or its derivative of the given order in s, (k, n) at arclengths (k).
    void evaluate(Vector<const double> s, int derivative, View<double> out) const {
        const std::vector<double> factors = factors_of(derivative);
        for (Index row = 0; row < out.rows; ++row) evaluate(s[row], derivative, factors, out.row(row));
    }

    // Where each piece begins and ends (2 * p, n), the begins first, or their derivatives in s.
    void evaluate_ends(int derivative, View<double> out) const {
        const std::vector<double> factors = factors_of(derivative);
        for (Index number = 0; number < count(); ++number) {
            for (Index end = 0; end < 2; ++end) {
                const double x = (breaks[number + end] - centers[number]) / radii[number];
                evaluate_on({0.0, number, x}, derivative, factors, out.row(end * count() + number));
            }
        }
    }

    // Bounds on u (n) all along from arclength ``begin`` to ``end`` of one piece: by the mean value.
    void enclose(Index number, double begin, double end, Vector<Interval> out) const {
        const View<const double> of = piece(number);
        const auto coordinate = [&](const Interval& s) { return (s - centers[number]) / Interval(radii[number]); };
        const Interval x = coordinate({begin, end}), middle = x.middle(), offset = x - middle;
        for (Index j = 0; j < unknowns(); ++j) {
            Interval value = 0.0, slope = 0.0;
            for (Index k = order(); k >= 1; --k) {
                value = value * middle + Interval(of(k, j));
                slope = slope * x + Interval(static_cast<double>(k)) * Interval(of(k, j));
            }
            out[j] = value * middle + Interval(of(0, j)) + slope * offset;
        }
    }

    // The rate in s of a height, the sum of ``weights`` (n) times ``linear`` (n) times u and cosines of
    // ``angular`` (n) times u less ``phases`` (n). ``room`` is that for a foot.
    double rate_of_height(const Height& height, double s, std::vector<double>& room) const {
        const std::size_t n = unknowns();
        const Jet jet{{room.data(), n}, {room.data() + n, n}, {room.data() + 2 * n, n}};
        fill(s, jet);
        double rate = 0.0;
        for (std::size_t j = 0; j < n; ++j) {
            const double angle = jet.value[j] * height.angular[j] - height.phases[j];
            const double gradient = height.linear[j] - height.angular[j] * std::sin(angle);
            rate += height.weights[j] * gradient * jet.slope[j];
        }
        return rate;
    }

    // Where a piece begins and ends, in its coordinate.
    struct Span {
        double begin, end;

        double reach() const { return std::max(std::abs(begin), std::abs(end)); }
    };

    Span span(Index number) const {
        return {(breaks[number] - centers[number]) / radii[number], (breaks[number + 1] - centers[number]) / radii[number]};
    }
    double radius(Index number) const { return radii[number]; }
    double arclength(Index number, double x) const { return centers[number] + x * radii[number]; }

    // The derivative of an unknown in s.
    double rate(double s, Index unknown) const {
        const Place place = place_of(s);
        const View<const double> of = piece(place.piece);
        double sum = 0.0;
        for (Index k = order(); k >= 1; --k) sum = sum * place.x + static_cast<double>(k) * of(k, unknown);
        return sum / radii[place.piece];
    }

    std::size_t room_for_a_foot() const { return 3 * unknowns(); }

    // The foot of a point (n) on the curve, distances modulo the periods; an infinite distance where
    // it is ``within`` or more.
    //
    // Every piece lies in a ball about its middle of half its length. Pieces are looked at in the
    // order of the distance of these balls, samples on them in the order of the curve: Newton's
    // method starts at those that are nearer than their neighbours, unless they are too far away to
    // lead to a nearer foot.
    Foot nearest(Vector<const double> point, double within, std::vector<double>& room) const {
        Foot best{within, 0.0};
        std::vector<std::pair<double, Index>> order_of_visit;
        for (Index number = 0; number < count(); ++number) {
            const double half = 0.5 * (breaks[number + 1] - breaks[number]);
            const double bound = std::sqrt(squared_distance(middles_.row(number), point)) - half;
            if (bound < within) order_of_visit.emplace_back(bound, number);
        }
        std::sort(order_of_visit.begin(), order_of_visit.end());
        for (const auto& [bound, number] : order_of_visit) {
            if (bound >= best.distance) break;
            look_at(number, point, best, room);
        }
        if (!(best.distance < within)) best.distance = std::numeric_limits<double>::infinity();
        return best;
    }

    // All arclengths at which the curve passes a point (n) at a distance below ``within``, in order;
    // feet no farther apart than ``same`` are one.
    std::vector<double> passes(Vector<const double> point, double within, double same) const {
        std::vector<double> room(room_for_a_foot()), found, distinct;
        const double reach = 2.5 * spacing_ + within;
        for (Index i = 0; i < static_cast<Index>(arclengths_.size()); ++i) {
            if (squared_distance(samples_.row(i), point) > reach * reach) continue;
            const Foot foot = foot_from(arclengths_[i], point, spacing_, room);
            if (foot.distance < within) found.push_back(foot.s);
        }
        std::sort(found.begin(), found.end());
        double before = -std::numeric_limits<double>::infinity();
        if (is_closed() && found.size() > 1) before = found.back() - total();
        for (double s : found) {
            if (s - before > same) distinct.push_back(s);
            before = s;
        }
        return distinct;
    }

private:
    // Samples of every piece, from which feet are looked for.
    void take_samples() {
        const Index n = unknowns();
        std::vector<double> factors(order() + 1, 1.0);
        arclengths_.clear();
        for (Index number = 0; number < count(); ++number) {
            const double step = (breaks[number + 1] - breaks[number]) / samples_of_piece;
            for (Index i = 0; i < samples_of_piece; ++i) {
                arclengths_.push_back(breaks[number] + static_cast<double>(i) * step);
            }
        }
        if (count()) arclengths_.push_back(total());
        samples_ = Matrix<double>(static_cast<Index>(arclengths_.size()), n);
        spacing_ = 0.0;
        for (Index i = 0; i < samples_.rows(); ++i) {
            evaluate(arclengths_[i], 0, factors, samples_.row(i));
            if (i) spacing_ = std::max(spacing_, arclengths_[i] - arclengths_[i - 1]);
        }
        middles_ = Matrix<double>(count(), n);
        for (Index number = 0; number < count(); ++number) {
            evaluate(0.5 * (breaks[number] + breaks[number + 1]), 0, factors, middles_.row(number));
        }
    }

    static constexpr Index samples_of_piece = 12;
    static constexpr int foot_steps = 10;          // of Newton's method
    static constexpr double standing = 1e-15;      // a step, over the length, after which none follows

    struct Place {
        double turns;  // of the closed curve before it
        Index piece;
        double x;  // the coordinate on that piece
    };

    Place place_of(double s) const {
        const double turns = is_closed() ? std::floor(s / total()) : 0.0;
        const double local = s - turns * total();
        const auto after = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, local);
        const Index number = after - breaks.begin() - 1;
        return {turns, number, (local - centers[number]) / radii[number]};
    }

    // k (k - 1) ... of a derivative of x^k.
    std::vector<double> factors_of(int derivative) const {
        std::vector<double> factors(order() + 1, 1.0);
        for (int j = 0; j < derivative; ++j) {
            for (Index k = 0; k <= order(); ++k) factors[k] *= std::max<double>(static_cast<double>(k) - j, 0.0);
        }
        return factors;
    }

    void evaluate(double s, int derivative, Vector<const double> factors, Vector<double> out) const {
        evaluate_on(place_of(s), derivative, factors, out);
    }

    void evaluate_on(const Place& place, int derivative, Vector<const double> factors, Vector<double> out) const {
        const View<const double> of = piece(place.piece);
        double scale = 1.0;
        for (int i = 0; i < derivative; ++i) scale *= radii[place.piece];
        in_parts([&]<Index width>(Index first) {
            std::array<double, width> sums{};
            for (Index k = order(); k >= derivative; --k) {
                for (Index j = 0; j < width; ++j) sums[j] = sums[j] * place.x + factors[k] * of(k, first + j);
            }
            std::copy(sums.begin(), sums.end(), out.begin() + first);
        });
        for (Index j = 0; j < unknowns(); ++j) {
            out[j] /= scale;
            if (derivative == 0 && is_closed()) out[j] += place.turns * travel[j];
        }
    }

    // Some unknowns at a time, from ``first`` on: sums of as many as are known beforehand stay in registers.
    template <class F>
    void in_parts(F sum) const {
        Index first = 0;
        for (; first + 4 <= unknowns(); first += 4) sum.template operator()<4>(first);
        for (; first + 2 <= unknowns(); first += 2) sum.template operator()<2>(first);
        if (first < unknowns()) sum.template operator()<1>(first);
    }

    // u, du/ds and d2u/ds2 at one arclength.
    struct Jet {
        Vector<double> value, slope, bend;
    };

    void fill(double s, const Jet& jet) const {
        const Place place = place_of(s);
        const View<const double> of = piece(place.piece);
        const double radius = radii[place.piece];
        in_parts([&]<Index width>(Index first) {
            std::array<double, width> value, slope{}, bend{};
            for (Index j = 0; j < width; ++j) value[j] = of(order(), first + j);
            for (Index k = order() - 1; k >= 0; --k) {
                for (Index j = 0; j < width; ++j) {
                    bend[j] = bend[j] * place.x + slope[j];
                    slope[j] = slope[j] * place.x + value[j];
                    value[j] = value[j] * place.x + of(k, first + j);
                }
            }
            std::copy(value.begin(), value.end(), jet.value.begin() + first);
            std::copy(slope.begin(), slope.end(), jet.slope.begin() + first);
            std::copy(bend.begin(), bend.end(), jet.bend.begin() + first);
        });
        for (Index j = 0; j < unknowns(); ++j) {
            if (is_closed()) jet.value[j] += place.turns * travel[j];
            jet.slope[j] /= radius;
            jet.bend[j] = 2.0 * jet.bend[j] / (radius * radius);
        }
    }

    double gap(double a, double b, Index j) const { return periodic_difference(a, b, periods[j]); }

    double squared_distance(Vector<const double> a, Vector<const double> b) const {
        double total = 0.0;
        for (Index j = 0; j < unknowns(); ++j) {
            const double apart = gap(a[j], b[j], j);
            total += apart * apart;
        }
        return total;
    }

    // The foot of a point near arclength ``s``: Newton's method on half the squared distance, with
    // steps of at most ``reach``, downhill.
    Foot foot_from(double s, Vector<const double> point, double reach, std::vector<double>& room) const {
        const std::size_t n = unknowns();
        const Jet jet{{room.data(), n}, {room.data() + n, n}, {room.data() + 2 * n, n}};
        Foot best{std::numeric_limits<double>::infinity(), s};
        for (int step_number = 0; step_number <= foot_steps; ++step_number) {
            fill(s, jet);
            double fall = 0.0, speed = 0.0, curvature = 0.0, square = 0.0;
            for (Index j = 0; j < unknowns(); ++j) {
                const double apart = gap(jet.value[j], point[j], j);
                fall += apart * jet.slope[j];
                speed += jet.slope[j] * jet.slope[j];
                curvature += apart * jet.bend[j];
                square += apart * apart;
            }
            const double distance = std::sqrt(square);
            if (distance < best.distance) best = {distance, s};
            const double rise = speed + curvature > 0.1 * speed ? speed + curvature : speed;
            const double step = std::clamp(fall / rise, -reach, reach);
            if (!(std::abs(step) > standing * total())) break;
            s = is_closed() ? remainder_of(s - step) : std::clamp(s - step, 0.0, total());
        }
        return best;
    }

    // An arclength modulo the length.
    double remainder_of(double s) const {
        const double rest = std::fmod(s, total());
        return rest < 0.0 ? rest + total() : rest;
    }

    // Feet that start from the samples of one piece.
    void look_at(Index number, Vector<const double> point, Foot& best, std::vector<double>& room) const {
        const Index first = number * samples_of_piece;
        double before = std::numeric_limits<double>::infinity();
        double here = std::sqrt(squared_distance(samples_.row(first), point));
        for (Index i = 0; i <= samples_of_piece; ++i) {
            double after = std::numeric_limits<double>::infinity();
            if (i < samples_of_piece) after = std::sqrt(squared_distance(samples_.row(first + i + 1), point));
            const bool is_lowest = here <= before && here <= after;
            if (is_lowest && here - spacing_ < best.distance) {
                const Foot foot = foot_from(arclengths_[first + i], point, 2.0 * spacing_, room);
                if (foot.distance < best.distance) best = foot;
            }
            before = here;
            here = after;
        }
    }

    std::vector<double> arclengths_;
    Matrix<double> samples_{0, 0}, middles_{0, 0};
    double spacing_ = 0.0;
};

}  // namespace bifurc
