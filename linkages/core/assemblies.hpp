// Configurations of a closed loop of six joints, followed while its geometry moves through
// complex numbers: `linkages.slices.assemblies` says what for.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "bifurc/core/arrays.hpp"
#include "bifurc/core/deadline.hpp"
#include "bifurc/core/null_vector.hpp"
#include "linkages/core/complex_lanes.hpp"
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

inline double largest_imaginary_part(const PathAngles& angles) {
    double largest = 0.0;
    for (const Complex& angle : angles) largest = std::max(largest, std::abs(angle.imag()));
    return largest;
}

// Complex loops of a fixed geometry: one, or as many as a number ``T`` has lanes.
template <class T>
class ComplexLoop {
public:
    using Column = std::array<T, 6>;

    struct Table {
        std::array<T, path_joints> lengths, offsets;
        std::array<Turn<T>, path_joints> half_twists;
    };

    explicit ComplexLoop(const Table& table) {
        for (std::size_t i = 0; i < path_joints; ++i) {
            links_[i] = {table.lengths[i], table.offsets[i], doubled(table.half_twists[i])};
            quaternions_[i] = link_quaternion(table.lengths[i], table.offsets[i], table.half_twists[i]);
        }
    }

    // The closure error and its derivatives by the joints, from half the angles, in quaternions: where
    // angles have large imaginary parts, these keep more digits than matrices.
    ChainClosure<T, path_joints> close(const std::array<Turn<T>, path_joints>& halves) const {
        return close_chain(quaternions_, halves);
    }

    // The rate of the error as the geometry changes, where the loop is closed.
    Column rate(const std::array<Turn<T>, path_joints>& halves, const std::array<Column, 3>& change) const {
        Frame<T> frame;
        Screw<T> rate{};
        for (std::size_t i = 0; i < path_joints; ++i) {
            const Screw<T> joint = frame.joint();
            frame.advance(doubled(halves[i]), links_[i]);
            const Screw<T> normal = frame.normal();  // about which the twist turns
            const Vec3<T> slide = change[0][i] * normal.direction + change[2][i] * joint.direction;
            rate = rate + change[1][i] * normal;
            rate.moment = rate.moment + slide;
        }
        return entries(rate);
    }

private:
    std::array<Link<T>, path_joints> links_;
    std::array<DualQuaternion<T>, path_joints> quaternions_;
};

// A complex loop with this table.
inline ComplexLoop<Complex> complex_loop(const ComplexTable& table) {
    ComplexLoop<Complex>::Table of{table.lengths, table.offsets, {}};
    for (std::size_t i = 0; i < path_joints; ++i) of.half_twists[i] = turn_by(0.5 * table.twists[i]);
    return ComplexLoop<Complex>(of);
}

inline std::array<Turn<Complex>, path_joints> half_turns(const PathAngles& angles) {
    std::array<Turn<Complex>, path_joints> halves;
    for (std::size_t i = 0; i < path_joints; ++i) halves[i] = turn_by(0.5 * angles[i]);
    return halves;
}

// Corrections by Newton's method of up to four configurations abreast, each of a loop of its own.
class AbreastCorrector {
public:
    using Column = std::array<ComplexLanes, path_joints>;

    explicit AbreastCorrector(const ComplexTable& change) {
        for (std::size_t i = 0; i < path_joints; ++i) {
            change_[0][i] = ComplexLanes(change.lengths[i]);
            change_[1][i] = ComplexLanes(change.twists[i]);
            change_[2][i] = ComplexLanes(change.offsets[i]);
        }
    }

    void set_table(int lane, const ComplexTable& table) {
        for (std::size_t i = 0; i < path_joints; ++i) {
            table_.lengths[i].set(lane, table.lengths[i]);
            table_.offsets[i].set(lane, table.offsets[i]);
            set_turn(lane, table_.half_twists[i], turn_by(0.5 * table.twists[i]));
        }
    }

    void set_angles(int lane, const PathAngles& angles) {
        for (std::size_t i = 0; i < path_joints; ++i) set_turn(lane, halves_[i], turn_by(0.5 * angles[i]));
    }

    void solve() { solve(table_, halves_, change_, step_, velocity_); }

    // What is to be taken from the angles, and how fast they change on the way; not numbers where the
    // derivatives are singular.
    PathAngles step(int lane) const { return of_lane(step_, lane); }
    PathAngles velocity(int lane) const { return of_lane(velocity_, lane); }

private:
    using Table = ComplexLoop<ComplexLanes>::Table;
    using Turns = std::array<Turn<ComplexLanes>, path_joints>;

    static void set_turn(int lane, Turn<ComplexLanes>& turns, const Turn<Complex>& turn) {
        turns.cosine.set(lane, turn.cosine);
        turns.sine.set(lane, turn.sine);
    }

    static PathAngles of_lane(const Column& column, int lane) {
        PathAngles out;
        for (std::size_t i = 0; i < path_joints; ++i) out[i] = column[i].at(lane);
        return out;
    }

    // What the derivatives turn into error and rate, by elimination with row pivots.
    LINKAGES_VECTORISED static void solve(const Table& table, const Turns& halves,
                                          const std::array<Column, 3>& change, Column& step,
                                          Column& velocity) {
        constexpr int n = path_joints, columns = n + 2;
        const ComplexLoop<ComplexLanes> loop(table);
        const auto closure = loop.close(halves);
        const Column rate = loop.rate(halves, change);
        std::array<std::array<ComplexLanes, columns>, n> rows;
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n; ++j) rows[i][j] = closure.derivatives[j][i];
            rows[i][n] = closure.error[i];
            rows[i][n + 1] = rate[i];
        }
        Column inverses;
        for (int k = 0; k < n; ++k) {
            Packed largest = rough_size(rows[k][k]);
            for (int i = k + 1; i < n; ++i) {
                const Packed size = rough_size(rows[i][k]);
                for (int j = k; j < columns; ++j) exchange_where_less(largest, size, rows[k][j], rows[i][j]);
                largest = where_less(largest, size, size, largest);
            }
            inverses[k] = inverse(rows[k][k]);
            for (int i = k + 1; i < n; ++i) {
                const ComplexLanes factor = rows[i][k] * inverses[k];
                for (int j = k + 1; j < columns; ++j) rows[i][j] = rows[i][j] - factor * rows[k][j];
            }
        }
        for (int k = n - 1; k >= 0; --k) {
            ComplexLanes of_step = rows[k][n], of_velocity = rows[k][n + 1];
            for (int i = k + 1; i < n; ++i) {
                of_step = of_step - rows[k][i] * step[i];
                of_velocity = of_velocity - rows[k][i] * velocity[i];
            }
            step[k] = of_step * inverses[k];
            velocity[k] = of_velocity * inverses[k];
        }
    }

    static void exchange_where_less(const Packed& a, const Packed& b, ComplexLanes& p, ComplexLanes& q) {
        const ComplexLanes former = p;
        p = {where_less(a, b, q.re, p.re), where_less(a, b, q.im, p.im)};
        q = {where_less(a, b, former.re, q.re), where_less(a, b, former.im, q.im)};
    }

    std::array<Column, 3> change_;
    Table table_;
    Turns halves_;
    Column step_, velocity_;
};

// The path of a configuration while the geometry of its loop moves straight from one table to
// another. The next point is predicted by the cubic through the last two points and their
// velocities, and corrected by Newton's method. The rest of the path, from 1 to 0, not the way that
// was made, is the parameter: near the end it keeps all its digits.
class Path {
public:
    // Of all the way from one table to the other, ``share`` is before it: what is counted as 1.
    Path(const PathAngles& start, double share) : here_{start, {}}, ahead_(here_), share_(share) {}

    bool is_over() const { return is_over_; }
    PathEnd end() const { return end_; }
    // Where it is, and what is left of it.
    const PathAngles& angles() const { return here_.angles; }
    double rest() const { return rest_; }

    // Where a correction is wanted, and what is left there of all the way.
    const PathAngles& angles_ahead() const { return ahead_.angles; }
    double way_ahead() const { return share_ * (rest_ - step_); }

    // Takes a correction by Newton's method, and how fast the angles change on the way. The first one
    // says how far the prediction was off; each following one is to be smaller by the contraction,
    // which it is not where another configuration is near.
    void correct(const PathAngles& correction, const PathAngles& velocity) {
        const double former = size_;
        size_ = 0.0;
        double total = 0.0;  // no number where one is none
        for (const Complex& entry : correction) {
            const double size = std::abs(entry.real()) + std::abs(entry.imag());
            size_ = std::max(size_, size);
            total += size;
        }
        if (corrections_ == 0) first_ = size_;
        const bool contracts =
            corrections_ == 0 || size_ <= std::max(paths::contraction * former, paths::rounding);
        if (!(total < std::numeric_limits<double>::infinity()) || size_ > paths::trusted || !contracts)
            return step_back();
        for (std::size_t j = 0; j < path_joints; ++j) {
            ahead_.angles[j] -= correction[j];
            ahead_.velocity[j] = share_ * velocity[j];
        }
        ++corrections_;
        const int most = is_to_the_end_ ? paths::last_corrections : paths::corrections;
        if (size_ >= paths::exact && corrections_ < most) return;
        if (size_ < paths::corrected)
            step_on();
        else
            step_back();
    }

private:
    // Of a path: angles, and how fast they change on the way.
    struct Point {
        PathAngles angles;
        PathAngles velocity;
    };

    void stop(PathEnd end) {
        is_over_ = true;
        end_ = end;
    }

    void step_on() {
        before_ = here_;
        here_ = ahead_;
        last_step_ = step_;
        rest_ -= step_;
        if (is_to_the_end_) {
            rest_ = 0.0;
            return stop(PathEnd::arrived);
        }
        if (largest_imaginary_part(here_.angles) > paths::infinite) return stop(PathEnd::at_infinity);
        if (steps_ == 0) {
            step_ = paths::first_step;
        } else {
            const double growth = std::sqrt(std::sqrt(paths::aim / (first_ + 1e-14)));
            step_ = std::min(paths::longest_step, step_ * std::clamp(growth, 0.5, 2.0));
        }
        look_ahead();
    }

    void step_back() {
        if (steps_ == 0) return stop(PathEnd::stopped);
        if (is_to_the_end_) whole_below_ = paths::whole_again * rest_;
        step_ *= paths::shorter;
        const double share = rest_ > paths::stiff ? paths::shortest_share : paths::shortest_stiff_share;
        if (rest_ < paths::last_stretch || step_ < share * rest_) return stop(PathEnd::stopped);
        look_ahead();
    }

    void look_ahead() {
        if (++steps_ > paths::most_steps) return stop(PathEnd::stopped);
        is_to_the_end_ = rest_ < paths::last_stretch || (step_ >= rest_ && rest_ <= whole_below_);
        step_ = is_to_the_end_ ? rest_ : std::min(step_, paths::most_share * rest_);
        ahead_.angles = predict();
        corrections_ = 0;
    }

    // The angles a step ahead; on the tangent where there is no last step.
    PathAngles predict() const {
        PathAngles out;
        for (std::size_t i = 0; i < path_joints; ++i) {
            out[i] = here_.angles[i] + step_ * here_.velocity[i];
            if (last_step_ == 0.0) continue;
            const Complex slope = (here_.angles[i] - before_.angles[i]) / last_step_;
            const Complex bend = (2.0 * here_.velocity[i] + before_.velocity[i] - 3.0 * slope) / last_step_;
            const Complex twist =
                (here_.velocity[i] + before_.velocity[i] - 2.0 * slope) / (last_step_ * last_step_);
            out[i] += step_ * step_ * (bend + step_ * twist);
        }
        return out;
    }

    Point here_, ahead_, before_{};
    double share_;
    double rest_ = 1.0, step_ = 0.0, last_step_ = 0.0;
    double whole_below_ = 1.0;  // the rest below which a step of all of it is tried
    double first_ = 0.0, size_ = 0.0;  // of the corrections of a step
    int steps_ = 0, corrections_ = 0;
    bool is_to_the_end_ = false, is_over_ = false;
    PathEnd end_ = PathEnd::stopped;
};

// Follows paths from one table to another, four abreast.
class PathTracker {
public:
    PathTracker(const ComplexTable& first, const ComplexTable& last)
        : last_(last), change_(first.plus(-1.0, last)) {}

    // None is begun when the time is over.
    void follow(std::vector<Path>& all, bifurc::Deadline& deadline) const {
        AbreastCorrector corrector(change_);
        std::array<Path*, lane_count> lanes{};
        std::size_t next = 0;
        while (true) {
            bool is_any = false;
            for (int lane = 0; lane < lane_count; ++lane) {
                Path*& path = lanes[lane];
                if (path && path->is_over()) path = nullptr;
                if (!path && next < all.size() && !deadline.has_passed()) path = &all[next++];
                if (!path) continue;
                is_any = true;
                corrector.set_table(lane, last_.plus(path->way_ahead(), change_));
                corrector.set_angles(lane, path->angles_ahead());
            }
            if (!is_any) return;
            corrector.solve();
            for (int lane = 0; lane < lane_count; ++lane) {
                if (lanes[lane]) lanes[lane]->correct(corrector.step(lane), corrector.velocity(lane));
            }
        }
    }

private:
    ComplexTable last_;
    ComplexTable change_;
};

}  // namespace linkages
