// Intervals of real numbers, rounded outwards.
//
// Sums, products, quotients and square roots are rounded to the next double on either side. The
// other functions are those of the C library, taken to be right to `library_ulps` units in the
// last place. What is not defined somewhere on an interval, or not bounded, is the whole line.
#pragma once

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <vector>

namespace bifurc {

struct Interval {
    double low = 0.0;
    double high = 0.0;

    Interval() = default;
    Interval(double value) : low(value), high(value) {}
    Interval(double low, double high) : low(low), high(high) {}

    bool contains(double value) const { return low <= value && value <= high; }
    bool is_finite() const { return std::isfinite(low) && std::isfinite(high); }
    double middle() const { return 0.5 * low + 0.5 * high; }
    // The largest absolute value.
    double magnitude() const { return std::max(std::abs(low), std::abs(high)); }
};

using IntervalBox = std::vector<Interval>;

namespace intervals {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int library_ulps = 4;

inline Interval whole() { return {-infinity, infinity}; }

// More than half the distance to the next double, and less than the whole of it: a sum with it is rounded to
// the next double (Rump, Zimmermann, Boldo and Melquiond 2009).
inline double beyond_half(double value) {
    constexpr double half_ulp = 0.5 * std::numeric_limits<double>::epsilon() * (1.0 + std::numeric_limits<double>::epsilon());
    return half_ulp * std::abs(value) + std::numeric_limits<double>::denorm_min();
}

// The interval one double wider on either side, ``ulps`` times.
inline Interval widened(double low, double high, int ulps = 1) {
    if (std::isnan(low) || std::isnan(high)) return whole();
    low = std::min(low, std::numeric_limits<double>::max());
    high = std::max(high, std::numeric_limits<double>::lowest());
    for (int i = 0; i < ulps; ++i) {
        low -= beyond_half(low);
        high += beyond_half(high);
    }
    return {low, high};
}

inline Interval hull(std::initializer_list<double> values) {
    for (double value : values) {
        if (std::isnan(value)) return whole();
    }
    return widened(std::min(values), std::max(values));
}

// The image under a function of the C library that rises all over ``domain``.
template <class Function>
Interval rising(Function function, const Interval& x, const Interval& domain = whole()) {
    if (!(x.low >= domain.low && x.high <= domain.high)) return whole();
    return widened(function(x.low), function(x.high), library_ulps);
}

// A product of ends, in which nothing times infinity is nothing.
inline double times(double a, double b) { return a == 0.0 || b == 0.0 ? 0.0 : a * b; }

}  // namespace intervals

inline Interval operator+(const Interval& a, const Interval& b) {
    return intervals::widened(a.low + b.low, a.high + b.high);
}
inline Interval operator-(const Interval& a, const Interval& b) {
    return intervals::widened(a.low - b.high, a.high - b.low);
}
inline Interval operator-(const Interval& a) { return {-a.high, -a.low}; }
inline Interval operator*(const Interval& a, const Interval& b) {
    using intervals::times;
    return intervals::hull(
        {times(a.low, b.low), times(a.low, b.high), times(a.high, b.low), times(a.high, b.high)});
}
inline Interval operator/(const Interval& a, const Interval& b) {
    if (b.contains(0.0)) return intervals::whole();
    return intervals::hull({a.low / b.low, a.low / b.high, a.high / b.low, a.high / b.high});
}
inline Interval& operator+=(Interval& a, const Interval& b) { return a = a + b; }
inline Interval& operator-=(Interval& a, const Interval& b) { return a = a - b; }

inline Interval square(const Interval& x) {
    const double low = std::min(std::abs(x.low), std::abs(x.high));
    const double high = std::max(std::abs(x.low), std::abs(x.high));
    const Interval image = intervals::widened(x.contains(0.0) ? 0.0 : low * low, high * high);
    return {std::max(image.low, 0.0), image.high};
}

inline Interval exp(const Interval& x) {
    const Interval image = intervals::rising([](double v) { return std::exp(v); }, x);
    return {std::max(image.low, 0.0), image.high};
}
inline Interval expm1(const Interval& x) {
    return intervals::rising([](double v) { return std::expm1(v); }, x);
}
inline Interval log(const Interval& x) {
    return intervals::rising([](double v) { return std::log(v); }, x, {0.0, intervals::infinity});
}
inline Interval log1p(const Interval& x) {
    return intervals::rising([](double v) { return std::log1p(v); }, x, {-1.0, intervals::infinity});
}
inline Interval sqrt(const Interval& x) {
    if (x.low < 0.0) return intervals::whole();
    const Interval image = intervals::widened(std::sqrt(x.low), std::sqrt(x.high));
    return {std::max(image.low, 0.0), image.high};
}
inline Interval cbrt(const Interval& x) {
    return intervals::rising([](double v) { return std::cbrt(v); }, x);
}
inline Interval sinh(const Interval& x) {
    return intervals::rising([](double v) { return std::sinh(v); }, x);
}
inline Interval cosh(const Interval& x) {
    const double low = std::min(std::abs(x.low), std::abs(x.high));
    const double high = std::max(std::abs(x.low), std::abs(x.high));
    const Interval image = intervals::widened(x.contains(0.0) ? 1.0 : std::cosh(low), std::cosh(high),
                                              intervals::library_ulps);
    return {std::max(image.low, 1.0), image.high};
}
inline Interval tanh(const Interval& x) {
    const Interval image = intervals::rising([](double v) { return std::tanh(v); }, x);
    return {std::max(image.low, -1.0), std::min(image.high, 1.0)};
}
inline Interval asin(const Interval& x) {
    return intervals::rising([](double v) { return std::asin(v); }, x, {-1.0, 1.0});
}
inline Interval acos(const Interval& x) {
    return -intervals::rising([](double v) { return -std::acos(v); }, x, {-1.0, 1.0});
}
inline Interval atan(const Interval& x) {
    return intervals::rising([](double v) { return std::atan(v); }, x);
}
inline Interval asinh(const Interval& x) {
    return intervals::rising([](double v) { return std::asinh(v); }, x);
}
inline Interval acosh(const Interval& x) {
    return intervals::rising([](double v) { return std::acosh(v); }, x, {1.0, intervals::infinity});
}
inline Interval atanh(const Interval& x) {
    return intervals::rising([](double v) { return std::atanh(v); }, x, {-1.0, 1.0});
}

namespace intervals {

constexpr double farthest = 1e6;  // from there on the zeros of sine and cosine are not placed well enough

// Whether ``first`` + 2 pi k lies within ``x``, or so near to it that doubles do not tell.
inline bool meets(const Interval& x, double first) {
    const double turn = 2.0 * std::numbers::pi;
    const double slack = 1e-15 * (1.0 + std::max(std::abs(x.low), std::abs(x.high)));
    const double next = first + turn * std::ceil((x.low - slack - first) / turn);
    return next <= x.high + slack;
}

// The image under a function of period 2 pi with values from -1 to 1, which it takes at
// ``lowest`` and ``highest``.
template <class Function>
Interval wave(Function function, const Interval& x, double lowest, double highest) {
    if (!(x.low >= -farthest && x.high <= farthest)) return {-1.0, 1.0};
    const double left = function(x.low), right = function(x.high);
    const Interval image = widened(std::min(left, right), std::max(left, right), library_ulps);
    return {meets(x, lowest) ? -1.0 : std::max(image.low, -1.0),
            meets(x, highest) ? 1.0 : std::min(image.high, 1.0)};
}

}  // namespace intervals

inline Interval sin(const Interval& x) {
    const double quarter = 0.5 * std::numbers::pi;
    return intervals::wave([](double v) { return std::sin(v); }, x, -quarter, quarter);
}
inline Interval cos(const Interval& x) {
    return intervals::wave([](double v) { return std::cos(v); }, x, std::numbers::pi, 0.0);
}
inline Interval tan(const Interval& x) {
    const double quarter = 0.5 * std::numbers::pi;
    const bool is_placed = x.low >= -intervals::farthest && x.high <= intervals::farthest;
    if (!is_placed || intervals::meets(x, quarter) || intervals::meets(x, -quarter)) return intervals::whole();
    return intervals::rising([](double v) { return std::tan(v); }, x);
}
inline Interval pow(const Interval& x, double exponent) {
    if (x.low < 0.0 || (x.low == 0.0 && exponent < 0.0)) return intervals::whole();
    const double low = std::pow(x.low, exponent), high = std::pow(x.high, exponent);
    const Interval image = intervals::widened(std::min(low, high), std::max(low, high), intervals::library_ulps);
    return {std::max(image.low, 0.0), image.high};
}
// The angle of the vector (x, y).
inline Interval atan2(const Interval& y, const Interval& x) {
    const bool crosses_cut = x.low <= 0.0 && y.contains(0.0);
    if (crosses_cut) return {-3.1415926535897936, 3.1415926535897936};
    const std::initializer_list<double> corners = {std::atan2(y.low, x.low), std::atan2(y.low, x.high),
                                                   std::atan2(y.high, x.low), std::atan2(y.high, x.high)};
    return intervals::widened(std::min(corners), std::max(corners), intervals::library_ulps);
}

}  // namespace bifurc
