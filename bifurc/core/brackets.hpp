// Bracketed roots of a function, one or many at once.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "bifurc/core/arrays.hpp"

namespace bifurc {

// A bracket that closes in on a root, by Chandrupatla's method (1997): inverse quadratic interpolation
// where that is safe, else bisection. Whoever owns it evaluates the function.
class Bracket {
public:
    // From the ends and the values there, which have opposite signs.
    Bracket(double low, double high, double at_low, double at_high) : a(low), b(high), fa(at_low), fb(at_high) {}

    // Where the function is wanted next.
    double next() const { return a + share * (b - a); }

    // Narrows the bracket by the ``value`` there; whether it is narrow enough.
    bool narrow(double value, double tolerance) {
        const double x = next();
        double c = b, fc = fb;  // the end before the newest one
        const bool is_beyond = sign(value) == sign(fa);  // of the root, seen from b
        if (is_beyond) {
            c = a;
            fc = fa;
        } else {
            b = a;
            fb = fa;
        }
        a = x;
        fa = value;
        const double enough = rounding * std::abs(a) + tolerance;
        const double width = std::abs(b - a);
        share = next_share(c, fc, std::min(enough / width, half));
        return width <= 2.0 * enough || fa * fb == 0.0;
    }

    // The better end.
    double root() const { return std::abs(fa) <= std::abs(fb) ? a : b; }

private:
    static constexpr double half = 0.5;
    static constexpr double rounding = 4e-16;  // of a root, as a share of it

    // By inverse quadratic interpolation where its parabola is monotonic in the bracket, else half
    // way; a share ``least`` away from either end.
    double next_share(double c, double fc, double least) const {
        const double xi = (a - b) / (c - b);
        const double phi = (fa - fb) / (fc - fb);
        const bool is_monotonic = phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;
        const double weight_b = fa / (fb - fa) * fc / (fb - fc);
        const double distance_c = (c - a) / (b - a);
        const double weighted_c = distance_c * fa / (fc - fa) * fb / (fc - fb);
        const double inverse = weight_b + weighted_c;
        if (!is_monotonic || !std::isfinite(inverse)) return half;
        return std::clamp(inverse, least, 1.0 - least);
    }

    static int sign(double value) { return (value > 0.0) - (value < 0.0); }

    double a, b, fa, fb;  // the newest point, the other end, and the values there
    double share = half;  // how far from a to b the next point lies
};

// The root of a function between ``low`` and ``high``, where it has opposite signs, to ``tolerance``
// and to rounding, in ``steps`` at most.
template <class Function>
double root_between(const Function& function, double low, double high, double tolerance, int steps) {
    Bracket bracket(low, high, function(low), function(high));
    for (int step = 0; step < steps; ++step) {
        if (bracket.narrow(function(bracket.next()), tolerance)) break;
    }
    return bracket.root();
}

// Many brackets at once, of one function.
class Brackets {
public:
    Brackets(Vector<const double> low, Vector<const double> high, Vector<const double> at_low,
             Vector<const double> at_high, double tolerance)
        : tolerance_(tolerance) {
        for (std::size_t i = 0; i < low.size(); ++i) brackets_.emplace_back(low[i], high[i], at_low[i], at_high[i]);
    }

    Index count() const { return static_cast<Index>(brackets_.size()); }

    void points(Vector<double> out) const {
        for (std::size_t i = 0; i < brackets_.size(); ++i) out[i] = brackets_[i].next();
    }

    // Whether all of them are narrow enough.
    bool narrow(Vector<const double> values) {
        bool is_done = true;
        for (std::size_t i = 0; i < brackets_.size(); ++i) is_done = brackets_[i].narrow(values[i], tolerance_) && is_done;
        return is_done;
    }

    void roots(Vector<double> out) const {
        for (std::size_t i = 0; i < brackets_.size(); ++i) out[i] = brackets_[i].root();
    }

private:
    std::vector<Bracket> brackets_;
    double tolerance_;
};

// Roots of a ``function`` of a number, one in each bracket; fills ``roots`` (k).
template <class Function>
void find_roots(Function function, Vector<const double> low, Vector<const double> high, double tolerance,
                Vector<double> roots) {
    constexpr int most_steps = 100;
    std::vector<double> points(low.begin(), low.end()), values(low.size()), at_low(low.size());
    const auto evaluate = [&](Vector<const double> at, Vector<double> out) {
        for (std::size_t i = 0; i < at.size(); ++i) out[i] = function(at[i]);
    };
    evaluate(low, at_low);
    evaluate(high, values);
    Brackets brackets(low, high, at_low, values, tolerance);
    for (int step = 0; step < most_steps; ++step) {
        brackets.points(points);
        evaluate(points, values);
        if (brackets.narrow(values)) break;
    }
    brackets.roots(roots);
}

}  // namespace bifurc
