// A traced curve, a polynomial on every piece: evaluated, and the feet of points on it.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "bifurc/core/arrays.hpp"

namespace bifurc {

// ``pieces`` (k * (order + 1), n) are the coefficients of all pieces in (s - center) / radius,
// ``breaks`` (k + 1) the arclengths at which they hand over, ``travel`` (n) what a closed curve
// gains in one turn, empty for an open one.
struct Curve {
    Vector<const double> breaks;
    Vector<const double> centers;
    Vector<const double> radii;
    View<const double> pieces;
    Vector<const double> travel;

    bool is_closed() const { return !travel.empty(); }
    double total() const { return breaks.back(); }
    Index order() const { return pieces.rows / static_cast<Index>(radii.size()) - 1; }
    Index unknowns() const { return pieces.columns; }
    View<const double> piece(Index number) const {
        const Index powers = order() + 1;
        return {pieces.data + number * powers * pieces.columns, powers, pieces.columns};
    }

    struct Place {
        double turns;  // of the closed curve before it
        Index piece;
        double x;  // the coordinate on that piece
    };

    Place place_of(double s) const {
        const double turns = is_closed() ? std::floor(s / total()) : 0.0;
        const double local = s - turns * total();
        const auto inner = breaks.subspan(1, radii.size() - 1);
        const auto after = std::upper_bound(inner.begin(), inner.end(), local);
        const Index number = after - inner.begin();
        return {turns, number, (local - centers[number]) / radii[number]};
    }
};

// u(s), or its derivative of the given order in s, at one arclength.
inline void evaluate(const Curve& curve, double s, int derivative, Vector<const double> factors,
                     Vector<double> out) {
    const Curve::Place place = curve.place_of(s);
    const View<const double> piece = curve.piece(place.piece);
    const double scale = std::pow(curve.radii[place.piece], derivative);
    for (Index j = 0; j < curve.unknowns(); ++j) {
        double total = 0.0;
        for (Index k = curve.order(); k >= derivative; --k) total = total * place.x + factors[k] * piece(k, j);
        out[j] = total / scale;
        if (derivative == 0 && curve.is_closed()) out[j] += place.turns * curve.travel[j];
    }
}

// u(s), or its derivative of the given order in s, (k, n) at arclengths (k).
inline void evaluate(const Curve& curve, Vector<const double> s, int derivative, View<double> out) {
    std::vector<double> factors(curve.order() + 1, 1.0);  // k (k - 1) ... of the derivative of x^k
    for (int j = 0; j < derivative; ++j) {
        for (Index k = 0; k <= curve.order(); ++k) factors[k] *= std::max<double>(k - j, 0);
    }
    for (Index row = 0; row < out.rows; ++row) evaluate(curve, s[row], derivative, factors, out.row(row));
}

// u(s) and du/ds at one arclength.
inline void value_and_slope(const Curve& curve, double s, Vector<double> value, Vector<double> slope) {
    const Curve::Place place = curve.place_of(s);
    const View<const double> piece = curve.piece(place.piece);
    for (Index j = 0; j < curve.unknowns(); ++j) {
        double total = piece(curve.order(), j), rate = 0.0;
        for (Index k = curve.order() - 1; k >= 0; --k) {
            rate = rate * place.x + total;
            total = total * place.x + piece(k, j);
        }
        value[j] = total;
        slope[j] = rate / curve.radii[place.piece];
        if (curve.is_closed()) value[j] += place.turns * curve.travel[j];
    }
}

// What is left of ``value`` after division by ``total``, of the sign of ``total``.
inline double remainder_of(double value, double total) {
    const double rest = std::fmod(value, total);
    return rest < 0.0 ? rest + total : rest;
}

// Arclengths ``at`` (k), near which the curve is nearest to points (k, n), moved there, and the
// distances (k): Newton's method with steps of at most ``reach``, distances modulo ``periods``.
inline void feet(const Curve& curve, View<const double> points, Vector<double> at, Vector<double> distances,
                 double reach, Vector<const double> periods, int iterations) {
    const Index n = curve.unknowns();
    std::vector<double> value(n), slope(n);
    for (Index row = 0; row < points.rows; ++row) {
        double& s = at[row];
        for (int iteration = 0; iteration <= iterations; ++iteration) {
            value_and_slope(curve, s, value, slope);
            double along = 0.0, speed = 0.0, square = 0.0;
            for (Index j = 0; j < n; ++j) {
                double gap = value[j] - points(row, j);
                if (std::isfinite(periods[j])) gap -= periods[j] * std::nearbyint(gap / periods[j]);
                along += gap * slope[j];
                speed += slope[j] * slope[j];
                square += gap * gap;
            }
            distances[row] = std::sqrt(square);
            if (iteration == iterations) break;
            s -= std::clamp(along / speed, -reach, reach);
            s = curve.is_closed() ? remainder_of(s, curve.total()) : std::clamp(s, 0.0, curve.total());
        }
    }
}

}  // namespace bifurc
