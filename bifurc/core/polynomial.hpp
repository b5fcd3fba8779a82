// A polynomial of one coordinate, and the parts of an interval on which it is plain.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "bifurc/core/arrays.hpp"

namespace bifurc {

class Polynomial {
public:
    // From its coefficients, at least one, the constant one first.
    explicit Polynomial(std::vector<double> coefficients) : coefficients_(std::move(coefficients)) {}

    double operator()(double x) const {
        double value = 0.0;
        for (std::size_t k = coefficients_.size(); k-- > 0;) value = value * x + coefficients_[k];
        return value;
    }

    double slope(double x) const {
        double value = 0.0;
        for (std::size_t k = coefficients_.size(); k-- > 1;) value = value * x + static_cast<double>(k) * coefficients_[k];
        return value;
    }

    // A bound on its size up to ``reach`` from 0.
    double size(double reach) const {
        double total = 0.0;
        for (std::size_t k = coefficients_.size(); k-- > 0;) total = total * reach + std::abs(coefficients_[k]);
        return total;
    }

    // What it does between two coordinates: the value in the middle and how far others may be from
    // that; the slope there, in the share of the way from the middle to an end, and how far others
    // may be from that.
    struct Range {
        double middle, spread, slope, slope_spread;

        bool keeps_sign() const { return std::abs(middle) > spread; }
        bool is_monotone() const { return std::abs(slope) > slope_spread; }
        double largest() const { return std::abs(middle) + spread; }
    };

    // By its series about the middle.
    Range range(double begin, double end) const {
        const double middle = 0.5 * (begin + end), half = 0.5 * (end - begin);
        std::vector<double> series = coefficients_;
        for (std::size_t first = 0; first + 1 < series.size(); ++first) {
            for (std::size_t k = series.size() - 1; k-- > first;) series[k] += middle * series[k + 1];
        }
        Range range{series[0], 0.0, 0.0, 0.0};
        double power = half;
        for (std::size_t k = 1; k < series.size(); ++k) {
            const double term = std::abs(series[k]) * power;
            range.spread += term;
            if (k == 1) range.slope = series[1] * half;
            if (k > 1) range.slope_spread += static_cast<double>(k) * term;
            power *= half;
        }
        return range;
    }

private:
    std::vector<double> coefficients_;
};

// A part of an interval on which a polynomial keeps its sign, is monotone, or ``is_flat``: no larger
// than what is hidden.
struct PlainPart {
    double begin, end;
    bool is_flat;
};

constexpr double narrowest_part = 1e-15;  // of an interval, over its coordinates, that is divided no more

// The parts from ``begin`` to ``end`` on which a polynomial is plain, in order, until ``visit``, which
// takes each of them, is False. Sizes up to ``hidden`` are no more than rounding. No change of sign
// is overlooked: a part is halved until a bound on all of its values, or on all slopes, shows that
// there is none, or one. A polynomial that is not finite is one part.
template <class Visit>
bool visit_plain_parts(const Polynomial& polynomial, double begin, double end, double hidden, const Visit& visit) {
    const Polynomial::Range range = polynomial.range(begin, end);
    const bool is_flat = range.largest() <= hidden;
    const double narrowest = narrowest_part * std::max({1.0, std::abs(begin), std::abs(end)});
    const bool is_finite = std::isfinite(range.largest());
    const bool is_open = is_finite && !is_flat && !range.keeps_sign() && !range.is_monotone();
    if (!is_open || !(end - begin > narrowest)) return visit(PlainPart{begin, end, is_flat});
    const double middle = 0.5 * (begin + end);
    return visit_plain_parts(polynomial, begin, middle, hidden, visit) &&
           visit_plain_parts(polynomial, middle, end, hidden, visit);
}

}  // namespace bifurc
