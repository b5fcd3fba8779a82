// Unknowns that come round.
#pragma once

#include <cmath>

#include "bifurc/core/arrays.hpp"

namespace bifurc {

// a - b, within half a period of 0; an infinite period is none.
inline double periodic_difference(double a, double b, double period) {
    const double apart = a - b;
    return std::abs(apart) <= 0.5 * period ? apart : apart - period * std::nearbyint(apart / period);
}

}  // namespace bifurc
