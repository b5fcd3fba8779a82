// Where a curve passes a place again that it has been at.
#pragma once

#include <cmath>
#include <vector>

#include "bifurc/core/march.hpp"
#include "bifurc/core/periods.hpp"
#include "bifurc/core/trail.hpp"

namespace bifurc {

// Where a curve is near a place again: the arclength, the offset (n) from the place and its length,
// and the slope of its piece there: the part along the tangent of the place, and its size.
struct Return {
    double s, distance, forward, speed;
    std::vector<double> offset;
};

namespace returns {
constexpr double reach = 1.1;   // of a piece, over its radius, within which it is looked at
constexpr double margin = 1.02;  // of a piece, over its radius, within which it counts
constexpr double apart = 0.5;   // of the radius: so far on a return begins
}  // namespace returns

// The returns, on the pieces from number ``first`` on, to the place at arclength ``s`` on piece
// ``number``.
inline std::vector<Return> returns_to(const Trail& trail, Index number, double s, Index first) {
    const std::size_t n = trail.pieces.columns;
    std::vector<double> point(n), tangent(n), offset(n), slope(n);
    evaluate(trail.piece(number), (s - trail.centers[number]) / trail.radii[number], point, tangent);
    const double speed = length(tangent);
    const double beyond = s + returns::apart * trail.radii[number];
    std::vector<Return> found;
    for (Index i = first; i < trail.count(); ++i) {
        const View<const double> piece = trail.piece(i);
        for (std::size_t j = 0; j < n; ++j) {
            offset[j] = periodic_difference(piece(0, static_cast<Index>(j)), point[j], trail.periods[j]);
        }
        if (!(length(offset) < returns::reach * trail.radii[i])) continue;
        const FootOnPiece foot = foot_on_piece(piece, 1.0, point, trail.periods, offset, slope);
        const double at = trail.centers[i] + foot.s * trail.radii[i];
        if (std::abs(foot.s) > returns::margin || !(at > beyond)) continue;
        double forward = 0.0;
        for (std::size_t j = 0; j < n; ++j) forward += slope[j] * tangent[j] / speed;
        found.push_back({at, length(offset), forward, length(slope), offset});
    }
    return found;
}

}  // namespace bifurc
