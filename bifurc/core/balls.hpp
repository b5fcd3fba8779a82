// Balls about points, modulo the periods of the unknowns.
#pragma once

#include <cmath>

#include "bifurc/core/arrays.hpp"
#include "bifurc/core/periods.hpp"

namespace bifurc {

struct Balls {
    View<const double> centers;    // (k, n)
    Vector<const double> radii;    // (k)
    Vector<const double> periods;  // (n), infinite where there is none

    // Whether one of them holds the ball of this ``radius`` about a point (n).
    bool hold(Vector<const double> point, double radius) const {
        for (Index ball = 0; ball < centers.rows; ++ball) {
            if (radius >= radii[ball]) continue;
            double square = 0.0;
            for (Index j = 0; j < centers.columns; ++j) {
                const double apart = periodic_difference(point[j], centers(ball, j), periods[j]);
                square += apart * apart;
            }
            if (std::sqrt(square) + radius < radii[ball]) return true;
        }
        return false;
    }
};

}  // namespace bifurc
