// The pieces of a curve while it is followed.
#pragma once

#include "bifurc/core/arrays.hpp"

namespace bifurc {

// A curve while it is followed: the coefficients of its k pieces (k * (order + 1), n) in
// (s - centre) / radius, each trusted from -1 to 1, and the periods (n) of the unknowns.
struct Trail {
    View<const double> pieces;
    Vector<const double> centers, radii, periods;

    Index count() const { return static_cast<Index>(radii.size()); }
    View<const double> piece(Index number) const {
        const Index powers = pieces.rows / count();
        return {pieces.data + number * powers * pieces.columns, powers, pieces.columns};
    }
};

}  // namespace bifurc
