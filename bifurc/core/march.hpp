// Taylor pieces of a solution curve, one after the other.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "bifurc/core/periods.hpp"
#include "bifurc/core/system.hpp"

namespace bifurc {

enum class MarchStatus { ran = 0, stalled = 1, open = 2 };  // as in `bifurc.problem`

struct MarchSettings {
    Index order;        // of the pieces
    double tolerance;   // to which they meet the curve
    double shortest;    // trusted radius
    double longest;     // trusted radius
    Index count;        // of pieces, at most
    double closing;     // there is no curve where the least residual across it is larger
    double misclosure;  // how large that is known to be elsewhere on the curve
};

// Where a march may stop early: it passes ``anchor`` (n), modulo the ``periods`` (n), at a distance
// below ``within`` in the direction ``heading`` (n), leaves the ``bounds`` (n, 2), or reaches
// ``length`` of arclength.
struct Region {
    Vector<const double> anchor;
    Vector<const double> heading;
    double within;
    Vector<const double> periods;
    View<const double> bounds;
    double length;
};

// How a march is made. No count, kind or word hangs on these: a march that goes wrong by them is
// found out by the certificate, and made again with shorter pieces.
namespace march {
constexpr double rounding = 1e-15;     // a residual that nothing brings down
constexpr double handover = 20.0;      // distance of two pieces where one hands over, over the blur
constexpr double same_way = 0.9;       // cosine of the angle there, at least
constexpr double most_blurred = 1e-3;  // the largest distance to which a point may be known
constexpr double farthest_correction = 1e-2;  // of a new centre, over the radius before it
constexpr double shrink = 0.85;        // of a radius that is too long
constexpr int shrinks = 20;
constexpr int corrections = 6;
// Of the new centre beyond the radius, over it. The last one is a step back: from another
// distance to a bifurcation a piece may reach across.
constexpr std::array hops = {0.9, 0.5, 0.2, 0.0, -0.5};
constexpr double steep_fall = 0.1;  // of the smallest regular singular value from piece to piece
constexpr double progress = 1.1;    // of a piece after a step back, beyond the one before
constexpr int places = 8;           // on either side of a centre, from which a foot is looked for
constexpr int foot_steps = 6;       // of Newton's method from there
constexpr double standing = 1e-15;  // a step, over the radius, after which none follows
constexpr std::array samples = {-1.0, -0.5, 0.0, 0.5, 1.0};  // where a piece is held against the bounds
// where a piece is checked, that where it is worst as a rule before the others
constexpr std::array probes = {1.0, -1.0, 0.8, -0.8, 0.45, -0.45};
}  // namespace march

// Value and slope of a series (order + 1, n) at ``s``.
inline void evaluate(View<const double> coefficients, double s, Vector<double> value, Vector<double> slope) {
    const Index order = coefficients.rows - 1;
    for (Index j = 0; j < coefficients.columns; ++j) {
        value[j] = coefficients(order, j);
        slope[j] = 0.0;
    }
    for (Index k = order - 1; k >= 0; --k) {
        for (Index j = 0; j < coefficients.columns; ++j) {
            slope[j] = slope[j] * s + value[j];
            value[j] = value[j] * s + coefficients(k, j);
        }
    }
}

// Where a curve is nearest to a point: the arclength from the centre of a piece, the offset from
// the point and the slope there.
struct FootOnPiece {
    double s;
    Vector<double> offset, slope;
};

// One piece: the series of u(s) about a point of the curve that lies ``step`` of arclength
// beyond the centre of the piece before it, trusted within ``radius`` on either side.
struct TaylorPiece {
    Matrix<double> coefficients;
    double step = 0.0;
    double radius = 0.0;
    double residual = 0.0;  // the largest one seen on the piece
    double sigma = 0.0;     // the smallest regular singular value at the centre, about
};

struct MarchOutcome {
    MarchStatus status;
    double gap;  // the residual at the start
    std::vector<TaylorPiece> pieces;
};

// The foot of a point (n) on the series (order + 1, n) of a piece, distances modulo the periods:
// from the nearest of some places within its radius by Newton's method. ``offset`` and ``slope`` (n)
// take what it returns.
inline FootOnPiece foot_on_piece(View<const double> coefficients, double radius, Vector<const double> point,
                                 Vector<const double> periods, Vector<double> offset, Vector<double> slope) {
    const Index n = coefficients.columns;
    const auto look = [&](double s) {
        evaluate(coefficients, s, offset, slope);
        for (Index j = 0; j < n; ++j) offset[j] = periodic_difference(offset[j], point[j], periods[j]);
        return squared_length(offset);
    };
    double s = 0.0, nearest = std::numeric_limits<double>::infinity();
    for (int place = -march::places; place <= march::places; ++place) {
        const double there = radius * place / march::places;
        const double square = look(there);
        if (square < nearest) {
            nearest = square;
            s = there;
        }
    }
    for (int iteration = 0;; ++iteration) {
        look(s);
        double along = 0.0;
        for (Index j = 0; j < n; ++j) along += offset[j] * slope[j];
        const double step = along / squared_length(slope);
        if (iteration == march::foot_steps || !(std::abs(step) > march::standing * radius)) break;
        s -= step;
    }
    return {s, offset, slope};
}

// Marches along the curves of one system. A piece is trusted on both sides of its centre, so
// the next centre lies almost two radii on. Near a bifurcation at distance d the radius is about
// d and somewhat more: a centre on either side covers the crossing, and a centre that would land
// too near it is refused because its piece does not reach back.
template <System S>
class Marcher {
public:
    Marcher(const S& system, const MarchSettings& settings)
        : system_(system),
          settings_(settings),
          n_(system.unknowns()),
          m_(system.equations()),
          bordered_(system.bordered()),
          residual_(m_),
          right_(m_ + 1),
          step_(n_),
          place_(n_),
          heading_(n_),
          other_(n_),
          slope_(n_) {}

    // Up to ``count`` consecutive pieces from ``start`` along ``tangent``. Stalled: no trusted
    // step is left, or the system is no longer solved farther on; open: nor at the start.
    // The march also ends, with what it has made, where it comes to an end of the ``region``.
    MarchOutcome run(Vector<const double> start, Vector<const double> tangent,
                     const std::optional<Region>& region = {}) {
        std::vector<double> point(start.begin(), start.end());
        std::vector<double> direction(tangent.begin(), tangent.end());
        const Settled first = settle(point, direction);
        MarchOutcome outcome{MarchStatus::open, first.gap, {}};
        if (!(first.gap <= settings_.closing)) return outcome;
        misclosure_ = std::max({settings_.misclosure, march::rounding, first.gap});
        TaylorPiece piece = expand(point, direction, first.sigma, 0.0);
        outcome.status = MarchStatus::stalled;
        if (piece.radius < settings_.shortest) return outcome;
        outcome.pieces.push_back(std::move(piece));
        outcome.status = MarchStatus::ran;
        double center = 0.0;  // arclength from the start
        while (static_cast<Index>(outcome.pieces.size()) < settings_.count) {
            if (!append(outcome.pieces)) {
                outcome.status = MarchStatus::stalled;
                break;
            }
            center += outcome.pieces.back().step;
            const TaylorPiece& last = outcome.pieces.back();
            if (!region) continue;
            if (center + last.radius > region->length) break;
            if (is_at_an_end(last, *region, 0.5 * outcome.pieces[0].radius - center)) break;
        }
        return outcome;
    }

private:
    struct Settled {
        double moved;  // length of the correction
        double gap;    // residual at its end
        double sigma;  // smallest singular value of [F'; t], the smallest regular one of F'
    };

    struct Error {
        double residual;
        double distance;

        bool is_below(const Error& most) const { return residual <= most.residual && distance <= most.distance; }
    };

    // Corrects ``point`` onto the curve across ``tangent`` and turns ``tangent`` into the
    // curve's: Gauss-Newton, min |[F'; t] d + [F; 0]| by QR. Where the residual is rounding a
    // small singular value would only amplify it: then nothing is moved. Leaves [F'; t] factored.
    Settled settle(Vector<double> point, Vector<double> tangent) {
        double moved = 0.0, gap = std::numeric_limits<double>::infinity();
        for (int iteration = 0; iteration <= march::corrections; ++iteration) {
            system_.linearize(point, residual_, bordered_.jacobian());
            const double previous = gap;
            gap = length(residual_);
            bordered_.factor(tangent);
            if (gap <= march::rounding || gap > 0.5 * previous || iteration == march::corrections) break;
            for (Index row = 0; row < m_; ++row) right_[row] = -residual_[row];
            right_[m_] = 0.0;
            bordered_.solve(right_, step_);
            for (Index j = 0; j < n_; ++j) point[j] += step_[j];
            moved += length(step_);
        }
        std::fill(right_.begin(), right_.end(), 0.0);
        right_[m_] = 1.0;
        bordered_.solve(right_, step_);
        const double norm = length(step_);
        for (Index j = 0; j < n_; ++j) tangent[j] = step_[j] / norm;
        bordered_.factor(tangent);
        return {moved, gap, bordered_.smallest_singular_value()};
    }

    // The distance to which a point is known whose smallest regular singular value is ``sigma``.
    double blur(double sigma) const {
        return misclosure_ / std::max(sigma, misclosure_ / march::most_blurred);
    }

    // The series at a settled point; its radius is 0 where no length of it beyond ``needed`` is trusted. It is cut
    // off where its last terms fall to the tolerance, or to the distance to which the point is
    // known: below that the terms are rounding, which a small singular value makes grow like a
    // series that does not reach to where that value vanishes. The residual has to be within the
    // tolerance in any case, but for the misclosure at the best points of the curve, which is no
    // fault of the series, and the estimated distance from the curve within that or what
    // rounding explains.
    TaylorPiece expand(Vector<const double> point, Vector<const double> tangent, double sigma, double needed) {
        TaylorPiece piece{Matrix<double>(settings_.order + 1, n_)};
        piece.sigma = sigma;
        bordered_.prepare_for_many();
        system_.series(point, tangent, bordered_, piece.coefficients);
        const double known = blur(sigma);
        const double within = 3.0 * settings_.tolerance;
        double radius = trusted_radius(piece.coefficients, std::max(settings_.tolerance, known));
        for (int i = 0; i < march::shrinks && radius > needed; ++i) {
            const Error most{within + 4.0 * misclosure_, within + march::handover * known};
            const Error error = largest_error(piece.coefficients, radius, most);
            if (error.is_below(most)) {
                piece.residual = error.residual;
                piece.radius = radius;
                break;
            }
            radius *= march::shrink;
        }
        return piece;
    }

    // The step at which the last two terms of the series fall to ``size``.
    double trusted_radius(View<double> coefficients, double size) const {
        double radius = settings_.longest;
        for (Index k = settings_.order - 1; k <= settings_.order; ++k) {
            const double term = length(coefficients.row(k));
            if (term > 0.0) radius = std::min(radius, std::pow(size / term, 1.0 / k));
        }
        return radius;
    }

    // The largest residual over some points of a piece, and the largest distance from the curve,
    // estimated with the factored [F'; t]: a residual of the size of rounding may be a large
    // distance, where a singular value is small. The first error beyond ``most`` is enough.
    Error largest_error(View<const double> coefficients, double radius, const Error& most) {
        Error worst{0.0, 0.0};
        for (double fraction : march::probes) {
            evaluate(coefficients, fraction * radius, place_, heading_);
            system_.residual(place_, Vector<double>(right_).first(m_));
            right_[m_] = 0.0;
            worst.residual = std::max(worst.residual, length(right_));
            bordered_.solve(right_, step_);
            worst.distance = std::max(worst.distance, length(step_));
            if (!worst.is_below(most)) break;
        }
        return worst;
    }

    // Whether another piece follows, which is then appended.
    bool append(std::vector<TaylorPiece>& pieces) {
        std::vector<double> point(n_), direction(n_);
        const double radius = pieces.back().radius;
        for (double beyond : march::hops) {
            if (radius < settings_.shortest) return false;
            evaluate(pieces.back().coefficients, (1.0 + beyond) * radius, point, direction);
            const double speed = length(direction);
            for (double& entry : direction) entry /= speed;
            const Settled settled = settle(point, direction);
            if (settled.moved > march::farthest_correction * radius || settled.gap > settings_.closing) continue;
            if (is_beside_singular(settled.sigma, pieces.back().sigma)) continue;
            misclosure_ = std::max(misclosure_, settled.gap);
            TaylorPiece piece = expand(point, direction, settled.sigma, reach_needed(beyond) * radius);
            if (piece.radius == 0.0) continue;
            const Meeting meeting = meet(pieces.back(), piece, -beyond * radius);
            const double known = blur(std::min(pieces.back().sigma, piece.sigma));
            const bool is_same = meeting.distance <= 100.0 * settings_.tolerance + march::handover * known;
            if (is_same && meeting.cosine > march::same_way) {
                piece.step = radius - meeting.at;
                pieces.push_back(std::move(piece));
                return true;
            }
        }
        return false;
    }

    // Whether a piece leaves the bounds of a region, or passes its anchor later than ``after``.
    bool is_at_an_end(const TaylorPiece& piece, const Region& region, double after) {
        for (double x : march::samples) {
            evaluate(piece.coefficients, x * piece.radius, place_, heading_);
            for (Index j = 0; j < n_; ++j) {
                if (place_[j] < region.bounds(j, 0) || place_[j] > region.bounds(j, 1)) return true;
            }
        }
        double square = 0.0;
        for (Index j = 0; j < n_; ++j) {
            const double apart = periodic_difference(piece.coefficients(0, j), region.anchor[j], region.periods[j]);
            square += apart * apart;
        }
        return std::sqrt(square) < 1.1 * piece.radius && passes_anchor(piece, region, after);
    }

    bool passes_anchor(const TaylorPiece& piece, const Region& region, double after) {
        const FootOnPiece foot =
            foot_on_piece(piece.coefficients, piece.radius, region.anchor, region.periods, other_, slope_);
        double cosine = 0.0;
        for (Index j = 0; j < n_; ++j) cosine += foot.slope[j] * region.heading[j];
        return foot.s > after && std::abs(foot.s) <= piece.radius && length(foot.offset) < region.within &&
               cosine > march::same_way * length(foot.slope);
    }

    // Whether a singular value falls to where points are known no better than the distance to
    // the next sheet, which is about as large: a centre there may be on any of them.
    bool is_beside_singular(double sigma, double before) const {
        return sigma < march::steep_fall * before && sigma < march::handover * blur(sigma);
    }

    // The radius, over that of the piece before, with which a piece goes on from there.
    static double reach_needed(double beyond) { return beyond < 0.0 ? -march::progress * beyond : beyond; }

    struct Meeting {
        double at;        // on the second piece
        double distance;  // that is left
        double cosine;    // of the angle between the two
    };

    // Where on the piece ``right`` the end of ``left`` lies, near ``guess``. A centre beyond the
    // reach of the series before it may lie on the curve all right, and its tangent point
    // backwards.
    Meeting meet(const TaylorPiece& left, const TaylorPiece& right, double guess) {
        evaluate(left.coefficients, left.radius, place_, heading_);
        double at = guess, square = 0.0, distance = 0.0;
        for (int iteration = 0; iteration < 3; ++iteration) {
            evaluate(right.coefficients, at, other_, slope_);
            double along = 0.0;
            square = distance = 0.0;
            for (Index j = 0; j < n_; ++j) {
                const double gap = place_[j] - other_[j];
                along += gap * slope_[j];
                square += slope_[j] * slope_[j];
                distance += gap * gap;
            }
            at += along / square;
        }
        double dot = 0.0;
        for (Index j = 0; j < n_; ++j) dot += heading_[j] * slope_[j];
        const double cosine = dot / std::sqrt(squared_length(heading_) * square);
        return {at, std::sqrt(distance), cosine};
    }

    const S& system_;
    const MarchSettings settings_;
    const Index n_, m_;
    double misclosure_ = 0.0;
    typename S::Bordered bordered_;
    std::vector<double> residual_, right_, step_, place_, heading_, other_, slope_;
};

}  // namespace bifurc
