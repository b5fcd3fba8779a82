// Configurations of a closed loop of six joints, followed while its geometry moves through
// complex numbers: `linkages.slices.assemblies` says what for.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "bifurc/core/arrays.hpp"
#include "bifurc/core/null_vector.hpp"
#include "linkages/core/dual_quaternions.hpp"
#include "linkages/core/screws.hpp"

namespace linkages {

namespace paths {

constexpr double first_step = 0.02, longest_step = 0.1;
// A step shorter than this share of the rest of the path is none; near the end, where rounding
// stops a path to a singular configuration, than the other one.
constexpr double shortest_share = 1e-7, shortest_stiff_share = 0.05;
constexpr double stiff = 1e-5;
// A step that is not all of the rest is at most this share of it. If the step to the end fails, it
// is tried again when the rest is smaller by the other share.
constexpr double most_share = 0.8, whole_again = 1e-3;
constexpr double shorter = 0.4;  // by which a step that failed is shortened
// The rest of a path that is taken in one step or not at all: a path to a singular configuration
// comes to its end in ever shorter steps. Two configurations of which each has the singular value
// s meet about s^2 behind the end.
constexpr double last_stretch = 1e-12;
constexpr double trusted = 1e-2;     // rad: the largest first correction of an accepted step
constexpr double aim = 1e-3;         // rad: the first correction that the length of a step aims at
constexpr double contraction = 0.1;  // of a correction to the next, on an accepted step
constexpr double rounding = 1e-7;    // rad: a correction that may be one of rounding
constexpr double exact = 1e-11;      // rad: a correction after which no other is made
constexpr double corrected = 1e-5;   // rad: the largest last correction of an accepted step
constexpr int corrections = 2, last_corrections = 5;  // of a step, and of the last step of a path
constexpr double far_away = 2.0;   // imaginary part beyond which dual quaternions save digits
constexpr double infinite = 12.0;  // imaginary part of an angle beyond which a path runs to infinity
constexpr int most_steps = 2000;

}  // namespace paths

enum class PathEnd { arrived = 0, stopped = 1, at_infinity = 2 };  // as in `linkages.slices.assemblies`

constexpr std::size_t path_joints = 6;
using PathAngles = std::array<Complex, path_joints>;

// Lengths, twists and offsets of a loop.
struct ComplexTable {
    PathAngles lengths, twists, offsets;

    // From a table (3, 6).
    static ComplexTable from(bifurc::View<const Complex> rows) {
        ComplexTable out;
        for (std::size_t i = 0; i < path_joints; ++i) {
            out.lengths[i] = rows(0, i);
            out.twists[i] = rows(1, i);
            out.offsets[i] = rows(2, i);
        }
        return out;
    }

    // This table plus ``factor`` times another one.
    ComplexTable plus(double factor, const ComplexTable& other) const {
        ComplexTable out = *this;
        for (std::size_t i = 0; i < path_joints; ++i) {
            out.lengths[i] += factor * other.lengths[i];
            out.twists[i] += factor * other.twists[i];
            out.offsets[i] += factor * other.offsets[i];
        }
        return out;
    }
};

using ComplexScrews = std::array<std::array<Complex, path_joints>, 6>;  // columns

inline double largest_imaginary_part(const PathAngles& angles) {
    double largest = 0.0;
    for (const Complex& angle : angles) largest = std::max(largest, std::abs(angle.imag()));
    return largest;
}

// A complex loop of a fixed geometry.
class ComplexLoop {
public:
    explicit ComplexLoop(const ComplexTable& table) {
        for (std::size_t i = 0; i < path_joints; ++i) {
            const Turn<Complex> half_twist = turn_by(0.5 * table.twists[i]);
            links_[i] = {table.lengths[i], table.offsets[i], doubled(half_twist)};
            quaternions_[i] = link_quaternion(table.lengths[i], table.offsets[i], half_twist);
        }
    }

    // The closure error, its derivatives by the joints, and its rate as the geometry changes.
    struct Linearization {
        std::array<Complex, 6> error;
        ComplexScrews derivatives;
        std::array<Complex, 6> rate;
    };

    // The error is the skew part of the rotation and the translation, its derivatives, where the
    // loop is closed, are the screws. It vanishes for half turns, too: no path leads from a closed
    // loop to one.
    Linearization linearize(const PathAngles& angles, const ComplexTable& change) const {
        std::array<Turn<Complex>, path_joints> turns;
        for (std::size_t i = 0; i < path_joints; ++i) turns[i] = turn_by(angles[i]);
        return follow(turns, change);
    }

    // Error and derivatives in quaternions: where angles have large imaginary parts, these keep
    // more digits.
    Linearization linearize_far_away(const PathAngles& angles, const ComplexTable& change) const {
        std::array<Turn<Complex>, path_joints> halves, turns;
        for (std::size_t i = 0; i < path_joints; ++i) {
            halves[i] = turn_by(0.5 * angles[i]);
            turns[i] = doubled(halves[i]);
        }
        Linearization out = follow(turns, change);
        const auto closure = close_chain(quaternions_, halves);
        out.error = closure.error;
        out.derivatives = closure.derivatives;
        return out;
    }

private:
    Linearization follow(const std::array<Turn<Complex>, path_joints>& turns,
                         const ComplexTable& change) const {
        Linearization out;
        Frame<Complex> frame;
        Screw<Complex> rate{};
        for (std::size_t i = 0; i < path_joints; ++i) {
            const Screw<Complex> joint = frame.joint();
            out.derivatives[i] = entries(joint);
            frame.advance(turns[i], links_[i]);
            const Screw<Complex> normal = frame.normal();  // about which the twist turns
            const Vec3<Complex> slide =
                change.lengths[i] * normal.direction + change.offsets[i] * joint.direction;
            rate = rate + change.twists[i] * normal;
            rate.moment = rate.moment + slide;
        }
        out.error = entries(frame.skew_gap());
        out.rate = entries(rate);
        return out;
    }

    std::array<Link<Complex>, path_joints> links_;
    std::array<DualQuaternion<Complex>, path_joints> quaternions_;
};

// The path of a configuration while the geometry of its loop moves straight from one table to
// another. The next point is predicted by the cubic through the last two points and their
// velocities, and corrected by Newton's method. The rest of the path, from 1 to 0, not the way that
// was made, is the parameter: near the end it keeps all its digits.
class PathTracker {
public:
    PathTracker(const ComplexTable& first, const ComplexTable& last)
        : last_(last), change_(first.plus(-1.0, last)) {}

    struct Outcome {
        PathAngles angles;
        double rest;
        PathEnd end;
    };

    Outcome follow(const PathAngles& start) const {
        Point here{start, {}}, before{};
        if (!(correct(here, 1.0, paths::corrections) <= paths::trusted))
            return {start, 1.0, PathEnd::stopped};
        double rest = 1.0, step = paths::first_step, last_step = 0.0;
        double whole_below = 1.0;  // the rest below which a step of all of it is tried
        for (int i = 0; i < paths::most_steps; ++i) {
            const bool is_last_stretch = rest < paths::last_stretch;
            const bool is_to_the_end = is_last_stretch || (step >= rest && rest <= whole_below);
            step = is_to_the_end ? rest : std::min(step, paths::most_share * rest);
            Point ahead{predict(here, before, last_step, step), {}};
            const int most = is_to_the_end ? paths::last_corrections : paths::corrections;
            const double correction = correct(ahead, rest - step, most);
            if (!(correction <= paths::trusted)) {
                if (is_to_the_end) whole_below = paths::whole_again * rest;
                step *= paths::shorter;
                const double share =
                    rest > paths::stiff ? paths::shortest_share : paths::shortest_stiff_share;
                if (is_last_stretch || step < share * rest) break;
                continue;
            }
            before = here;
            here = ahead;
            last_step = step;
            rest -= step;
            if (is_to_the_end) return {here.angles, 0.0, PathEnd::arrived};
            if (largest_imaginary_part(here.angles) > paths::infinite)
                return {here.angles, rest, PathEnd::at_infinity};
            const double growth = std::sqrt(std::sqrt(paths::aim / (correction + 1e-14)));
            step = std::min(paths::longest_step, step * std::clamp(growth, 0.5, 2.0));
        }
        return {here.angles, rest, PathEnd::stopped};
    }

private:
    // Of a path: angles, and how fast they change on the way.
    struct Point {
        PathAngles angles;
        PathAngles velocity;
    };

    // The angles a ``step`` ahead; on the tangent where there is no last step.
    static PathAngles predict(const Point& here, const Point& before, double last_step, double step) {
        PathAngles out;
        for (std::size_t i = 0; i < path_joints; ++i) {
            out[i] = here.angles[i] + step * here.velocity[i];
            if (last_step == 0.0) continue;
            const Complex slope = (here.angles[i] - before.angles[i]) / last_step;
            const Complex bend = (2.0 * here.velocity[i] + before.velocity[i] - 3.0 * slope) / last_step;
            const Complex twist =
                (here.velocity[i] + before.velocity[i] - 2.0 * slope) / (last_step * last_step);
            out[i] += step * step * (bend + step * twist);
        }
        return out;
    }

    // The first correction of Newton's method on the angles, in place; infinite where it is larger
    // than is trusted or the next ones, at most ``most`` in all, do not converge. The first one says
    // how far the prediction was off; each following one is to be smaller by the contraction, which
    // it is not where another configuration is near.
    double correct(Point& point, double rest, int most) const {
        constexpr double infinity = std::numeric_limits<double>::infinity();
        const ComplexLoop loop(last_.plus(rest, change_));
        const bool is_far_away = largest_imaginary_part(point.angles) > paths::far_away;
        double first = infinity, size = infinity;
        for (int i = 0; i < most; ++i) {
            const auto at = is_far_away ? loop.linearize_far_away(point.angles, change_)
                                        : loop.linearize(point.angles, change_);
            PathAngles step;
            if (!solve(at, step, point.velocity)) return infinity;
            const double former = size;
            size = 0.0;
            for (const Complex& entry : step)
                size = std::max(size, std::abs(entry.real()) + std::abs(entry.imag()));
            if (i == 0) first = size;
            if (!(size <= paths::trusted)) return infinity;
            if (i > 0 && size > std::max(paths::contraction * former, paths::rounding)) return infinity;
            for (std::size_t j = 0; j < path_joints; ++j) point.angles[j] -= step[j];
            if (size < paths::exact) break;
        }
        return size < paths::corrected ? first : infinity;
    }

    // What the derivatives turn into error and rate, by elimination with row pivots; false where
    // they are singular.
    static bool solve(const ComplexLoop::Linearization& at, PathAngles& step, PathAngles& velocity) {
        constexpr bifurc::Index n = path_joints, columns = n + 2;
        bifurc::SmallMatrix<Complex, n, columns> matrix;
        for (bifurc::Index i = 0; i < n; ++i) {
            for (bifurc::Index j = 0; j < n; ++j) matrix(i, j) = at.derivatives[j][i];
            matrix(i, n) = at.error[i];
            matrix(i, n + 1) = at.rate[i];
        }
        std::array<Complex, n> inverse;
        for (bifurc::Index k = 0; k < n; ++k) {
            bifurc::Index pivot = k;
            double largest = 0.0;
            for (bifurc::Index i = k; i < n; ++i) {
                const double size = std::abs(matrix(i, k).real()) + std::abs(matrix(i, k).imag());
                if (size > largest) {
                    pivot = i;
                    largest = size;
                }
            }
            if (!(largest > 0.0 && largest < std::numeric_limits<double>::infinity())) return false;
            for (bifurc::Index j = k; j < columns && pivot != k; ++j)
                std::swap(matrix(k, j), matrix(pivot, j));
            inverse[k] = 1.0 / matrix(k, k);
            for (bifurc::Index i = k + 1; i < n; ++i) {
                const Complex factor = matrix(i, k) * inverse[k];
                for (bifurc::Index j = k + 1; j < columns; ++j) matrix(i, j) -= factor * matrix(k, j);
            }
        }
        for (bifurc::Index k = n - 1; k >= 0; --k) {
            Complex of_step = matrix(k, n), of_velocity = matrix(k, n + 1);
            for (bifurc::Index i = k + 1; i < n; ++i) {
                of_step -= matrix(k, i) * step[i];
                of_velocity -= matrix(k, i) * velocity[i];
            }
            step[k] = of_step * inverse[k];
            velocity[k] = of_velocity * inverse[k];
        }
        return true;
    }

    ComplexTable last_;
    ComplexTable change_;
};

}  // namespace linkages
