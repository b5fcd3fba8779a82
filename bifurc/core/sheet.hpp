// The sheet of a surface, or of a component of more dimensions d, above a tangent plane: followed from the centre outwards, and never by distance.
// Why an arc is one curve, and what a disk has to be, stands in `bifurc.surfaces.sheet`.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "bifurc/core/corrections.hpp"
#include "bifurc/core/gram.hpp"
#include "bifurc/core/least_norm.hpp"
#include "bifurc/core/singular_values.hpp"

namespace bifurc {

namespace sheet {
// Places on an arc at which the cubic is corrected, and how far a quartic with the same ends and tangents is
// from it there, over what it is in the middle.
constexpr std::array<double, 3> inner{0.25, 0.5, 0.75};
constexpr std::array<double, 3> bump{0.5625, 1.0, 0.5625};
constexpr double contraction = 0.125;  // second step of Newton's method over the first, at most
constexpr double smooth = 0.1;  // what the corrections may differ from the bump of a quartic, over their size
constexpr double solved = 1e-9;  // residual above which a point is no solution
constexpr double steep = 0.3;    // smallest cosine between a ray and the sheet above it
constexpr double shortest = 5e-4;  // step along a ray, over its length
constexpr int most_steps = 60;
constexpr double tiny = 1e-300;
constexpr double rounding = 1e-12;  // of a share of a ray
constexpr double any_rank = 1e-15;  // entry of a factor, over the largest, that is rounding
constexpr double full_rank = 1e-6;  // entry on the diagonal of a factor, over the largest, that is not
}  // namespace sheet

// A plane (n, d) of ``planes`` (k * n, d).
inline View<const double> plane_of(View<const double> planes, Index number, Index n) {
    return {planes.row(number * n).data(), n, planes.columns};
}

// Derivatives of graphs above planes. Not for two threads at once.
class Slopes {
public:
    explicit Slopes(const Equations& equations) : equations_(equations), n_(equations.unknowns()), values_(n_) {}

    // Calls ``take(k, slopes)`` with the derivatives (n, d) of the sheet by the position in the plane (n, d)
    // that ``plane`` gives, for each of the points (k, n). Where the plane does not say what they are, they are
    // the smallest ones; entries up to ``negligible`` of the largest say nothing.
    template <class PlaneOf, class Take>
    void at(View<const double> points, PlaneOf plane, double negligible, Take take) {
        const Index at_once = equations_.at_once();
        Matrix<double> slopes(n_, points.rows > 0 ? plane(Index{0}).columns : 0);
        for (Index begin = 0; begin < points.rows; begin += at_once) {
            const Index count = std::min(at_once, points.rows - begin);
            equations_.fill({points.row(begin).data(), count, n_}, true, values_);
            for (Index i = 0; i < count; ++i) {
                solve(values_.jacobian(i), plane(begin + i), negligible, slopes);
                take(begin + i, slopes.view());
            }
        }
    }

    // [F'; T^T] S = [0; I]
    void solve(View<const double> jacobian, View<const double> plane, double negligible, View<double> slopes) {
        if (solve_regular(jacobian, plane, slopes)) return;
        const Index m = jacobian.rows, d = plane.columns;
        solver_.reserve(m + d, n_, d);
        const View<double> matrix = solver_.matrix();
        std::copy(jacobian.data, jacobian.data + m * n_, matrix.data);
        for (Index side = 0; side < d; ++side) {
            for (Index j = 0; j < n_; ++j) matrix(m + side, j) = plane(j, side);
            solver_.sides()(m + side, side) = 1.0;
        }
        solver_.solve(negligible, slopes);
    }

private:
    // The same without pivots, where that is seen to be enough.
    bool solve_regular(View<const double> jacobian, View<const double> plane, View<double> slopes) {
        const Index m = jacobian.rows, d = plane.columns;
        if (m + d < n_) return false;
        if (!regular_ || regular_->matrix().rows != m + d) {
            regular_.emplace(m + d, n_);
            right_.resize(m + d);
            solution_.resize(n_);
        }
        const View<double> matrix = regular_->matrix();
        std::copy(jacobian.data, jacobian.data + m * n_, matrix.data);
        for (Index side = 0; side < d; ++side) {
            for (Index j = 0; j < n_; ++j) matrix(m + side, j) = plane(j, side);
        }
        regular_->factor();
        double least = std::abs(matrix(0, 0)), most = least;
        for (Index j = 1; j < n_; ++j) {
            least = std::min(least, std::abs(matrix(j, j)));
            most = std::max(most, std::abs(matrix(j, j)));
        }
        if (!(least > sheet::full_rank * most)) return false;
        for (Index side = 0; side < d; ++side) {
            std::fill(right_.begin(), right_.end(), 0.0);
            right_[m + side] = 1.0;
            regular_->solve(right_, solution_);
            for (Index j = 0; j < n_; ++j) slopes(j, side) = solution_[j];
        }
        return true;
    }

    const Equations& equations_;
    Index n_;
    Values values_;
    LeastNorm solver_;
    std::optional<Factorization> regular_;
    std::vector<double> right_, solution_;
};

// The tangent plane (n, d) at a solution, its smallest cosine with the plane that it was to be next to, and the
// unit vector (n) across the surface along which F' is the weakest, zero where no equation is left.
struct TangentPlane {
    Matrix<double> basis;
    double cosine;
    std::vector<double> normal;
};

// Tangent planes of surfaces.
class TangentPlanes {
public:
    explicit TangentPlanes(const Equations& equations)
        : equations_(equations), n_(equations.unknowns()), values_(n_), slopes_(equations) {}

    // That at a solution, turned as little as possible against the plane ``near`` (n, d); where the null space
    // is larger, the part of it that is nearest to that. Entries up to ``negligible`` of the largest say nothing.
    TangentPlane at(Vector<const double> center, View<const double> near, double negligible) {
        equations_.fill({center.data(), 1, n_}, true, values_);
        const View<const double> jacobian = values_.jacobian(0);
        TangentPlane out{Matrix<double>(n_, near.columns), 0.0, std::vector<double>(n_)};
        slopes_.solve(jacobian, near, negligible, out.basis);
        const Gram gram(out.basis);
        const double steepest = gram.largest();
        gram.straighten(out.basis);
        // where the plane is upright on the other one, no slopes say so
        // beside a rim of F it is not finite
        const bool is_plane = std::isfinite(steepest) && steepest > 0.0;
        out.cosine = is_plane && change_along(jacobian, out.basis) <= negligible ? 1.0 / steepest : 0.0;
        if (n_ > near.columns) find_weakest(jacobian, out);
        return out;
    }

private:
    // |F' plane|, of the column where it is larger.
    static double change_along(View<const double> jacobian, View<const double> plane) {
        double largest = 0.0;
        for (Index side = 0; side < plane.columns; ++side) {
            double square = 0.0;
            for (Index row = 0; row < jacobian.rows; ++row) {
                double change = 0.0;
                for (Index j = 0; j < plane.rows; ++j) change += jacobian(row, j) * plane(j, side);
                square += change * change;
            }
            if (!(square <= largest)) largest = square;  // not a number is more than any
        }
        return std::sqrt(largest);
    }

    void find_weakest(View<const double> jacobian, TangentPlane& out) const {
        const Index across = n_ - out.basis.columns(), count = std::min(jacobian.rows, n_);
        SingularValues decomposition(jacobian.rows, n_);
        Matrix<double> values(1, count);
        decomposition.of(jacobian, values);
        Index rank = 0;
        while (rank < std::min(across, count) && values(0, rank) > sheet::any_rank * values(0, 0)) ++rank;
        const Matrix<double> regular = decomposition.leading_vectors(0, jacobian, rank);
        if (rank == across) {
            std::copy(regular.row(rank - 1).begin(), regular.row(rank - 1).end(), out.normal.begin());
            return;
        }
        // any that is left of an axis across the regular vectors and the plane
        double size = 0.0;
        for (Index axis = 0; axis < n_ && !(size > sheet::steep / static_cast<double>(n_)); ++axis) {
            std::fill(out.normal.begin(), out.normal.end(), 0.0);
            out.normal[axis] = 1.0;
            for (int time = 0; time < 2; ++time) {
                for (Index i = 0; i < rank; ++i) leave(regular.row(i), out.normal);
                for (Index side = 0; side < out.basis.columns(); ++side) {
                    std::vector<double> column(n_);
                    for (Index j = 0; j < n_; ++j) column[j] = out.basis(j, side);
                    leave(column, out.normal);
                }
            }
            size = length(out.normal);
        }
        for (double& entry : out.normal) entry /= size;
    }

    // Takes its part along a unit vector from another vector.
    static void leave(Vector<const double> unit, std::vector<double>& vector) {
        const double part = dot(unit, vector);
        for (std::size_t j = 0; j < vector.size(); ++j) vector[j] -= part * unit[j];
    }

    const Equations& equations_;
    Index n_;
    Values values_;
    Slopes slopes_;
};

// Rays of a surface: from the solutions ``centers`` (k, n) in tangent ``planes`` (k * n, d) to ``positions`` (k,
// d), and places at ``shares`` (s) of their lengths.
struct RayBundle {
    View<const double> centers, planes, positions;
    Vector<const double> shares;
};

// Where rays end (k, n), what share (k) of the rays is reached, solutions (k * s, n) at the places, and whether
// they are on the sheet (k * s).
struct RayEnds {
    View<double> ends;
    Vector<double> reached;
    View<double> passed;
    Vector<bool> are_there;
};

// Follows rays in steps as long as they may be, at first all the way: many abreast, of which each takes its own
// steps. Not for two threads at once.
class RayFollower {
public:
    RayFollower(const Equations& equations, double scale)
        : equations_(equations), n_(equations.unknowns()), corrector_(equations, scale), slopes_(equations) {}

    template <class Pause>
    void follow(const RayBundle& bundle, const RayEnds& out, Pause pause) {
        const Index s = static_cast<Index>(bundle.shares.size());
        // a function of Python is called for all of them at once
        const Index at_once = std::max(equations_.at_once(), Index{1});
        for (Index begin = 0; begin < bundle.centers.rows; begin += at_once) {
            const Index count = std::min(at_once, bundle.centers.rows - begin);
            const RayBundle part{rows(bundle.centers, begin, count), rows(bundle.planes, begin * n_, count * n_),
                                 rows(bundle.positions, begin, count), bundle.shares};
            const RayEnds ends{rows(out.ends, begin, count), out.reached.subspan(begin, count),
                               rows(out.passed, begin * s, count * s), out.are_there.subspan(begin * s, count * s)};
            run(part, ends);
            pause();
        }
    }

private:
    // Places on rays: shares t (k) of the rays' lengths, solutions (k, n), and the slopes (k, n) of the sheet
    // along the rays.
    struct Nodes {
        std::vector<double> t;
        Matrix<double> points{0, 0}, slopes{0, 0};

        void resize(Index count, Index n) {
            t.resize(count);
            if (points.rows() != count) points = slopes = Matrix<double>(count, n);
        }
        void put(Index row, const Nodes& others, Index other) {
            t[row] = others.t[other];
            std::copy(others.points.row(other).begin(), others.points.row(other).end(), points.row(row).begin());
            std::copy(others.slopes.row(other).begin(), others.slopes.row(other).end(), slopes.row(row).begin());
        }
    };

    template <class T>
    static View<T> rows(View<T> of, Index begin, Index count) {
        return {of.data + begin * of.columns, count, of.columns};
    }

    View<const double> plane(Index ray) const { return plane_of(bundle_.planes, ray, n_); }

    void run(const RayBundle& bundle, const RayEnds& out) {
        bundle_ = bundle;
        out_ = out;
        start();
        for (int number = 0; number < sheet::most_steps; ++number) {
            rays_.clear();
            for (Index ray = 0; ray < bundle_.centers.rows; ++ray) {
                if (at_.t[ray] < 1.0 && steps_[ray] >= sheet::shortest) rays_.push_back(ray);
            }
            if (rays_.empty()) break;
            step();
        }
        finish();
    }

    void start() {
        const Index count = bundle_.centers.rows;
        const auto s = static_cast<Index>(bundle_.shares.size());
        at_.resize(count, n_);
        before_.resize(count, n_);
        straight_.resize(count * n_);
        steps_.assign(count, 1.0);
        std::fill(out_.are_there.begin(), out_.are_there.end(), false);
        for (Index ray = 0; ray < count; ++ray) {
            at_.t[ray] = 0.0;
            before_.t[ray] = -1.0;
            const View<const double> basis = plane(ray);
            for (Index j = 0; j < n_; ++j) {
                const double way = along(basis, j, bundle_.positions.row(ray));
                const double center = bundle_.centers(ray, j);
                straight_[ray * n_ + j] = way;
                at_.points(ray, j) = center;
                before_.points(ray, j) = center - way;
                at_.slopes(ray, j) = before_.slopes(ray, j) = way;
                for (Index i = 0; i < s; ++i) out_.passed(ray * s + i, j) = center + bundle_.shares[i] * way;
            }
        }
    }

    // One step of the rays, or a shorter one to try where that fails.
    void step() {
        const auto count = static_cast<Index>(rays_.size());
        end_.resize(count, n_);
        is_taken_.assign(count, false);
        for (Index i = 0; i < count; ++i) {
            end_.t[i] = std::min(at_.t[rays_[i]] + steps_[rays_[i]], 1.0);
            predict(rays_[i], end_.t[i], end_.points.row(i));
        }
        const auto plane_of_ray = [&](Index i) { return plane(rays_[i]); };
        corrector_.correct(end_.points, plane_of_ray, corrections_);
        slopes_.at(end_.points, plane_of_ray, sheet::any_rank,
                   [&](Index i, View<const double> slopes) { take_slopes(i, slopes); });
        keep_arcs();
        for (Index i = 0; i < count; ++i) {
            const Index ray = rays_[i];
            if (is_taken_[i]) reach(ray, i);
            // a cubic is off by the fourth power of the step
            const double room =
                sheet::contraction / 2.0 / std::max(corrections_[i].contraction(), corrections::tiny);
            const double growth = std::clamp(std::sqrt(std::sqrt(room)), 0.5, 2.0);
            steps_[ray] *= is_taken_[i] ? growth : 0.5;
        }
    }

    void take_slopes(Index i, View<const double> slopes) {
        const Vector<const double> position = bundle_.positions.row(rays_[i]);
        for (Index j = 0; j < n_; ++j) end_.slopes(i, j) = along(slopes, j, position);
        const bool is_flat = length(position) >= sheet::steep * length(end_.slopes.row(i));
        is_taken_[i] = is_flat && is_solved(corrections_[i]);
    }

    bool is_solved(const Correction& correction) const {
        return correction.is_settled(corrector_.scale()) && correction.gap < sheet::solved;
    }

    // Where the cubic through the last two nodes leads.
    void predict(Index ray, double t, Vector<double> point) const {
        on_cubic(before_, ray, at_, ray, t, point);
        // rounding grows as cubics are prolonged: the place in the plane is known
        const View<const double> basis = plane(ray);
        std::array<double, Gram::most> aside{};
        for (Index j = 0; j < n_; ++j) {
            const double off = bundle_.centers(ray, j) + t * straight_[ray * n_ + j] - point[j];
            for (Index side = 0; side < basis.columns; ++side) aside[side] += basis(j, side) * off;
        }
        for (Index j = 0; j < n_; ++j) point[j] += along(basis, j, aside);
    }

    // Entry j of the vector that a position in a plane is.
    static double along(View<const double> plane, Index j, Vector<const double> position) {
        double way = 0.0;
        for (Index side = 0; side < plane.columns; ++side) way += plane(j, side) * position[side];
        return way;
    }

    void on_cubic(const Nodes& begin, Index one, const Nodes& end, Index other, double t, Vector<double> point) const {
        const double width = end.t[other] - begin.t[one], s = (t - begin.t[one]) / width;
        for (Index j = 0; j < n_; ++j) {
            const double rise = end.points(other, j) - begin.points(one, j);
            const double at_begin = width * begin.slopes(one, j) - rise;
            const double at_end = rise - width * end.slopes(other, j);
            point[j] = begin.points(one, j) + s * (rise + (1.0 - s) * ((1.0 - s) * at_begin + s * at_end));
        }
    }

    // Takes no step along which the sheet does not run from one node to the other.
    void keep_arcs() {
        constexpr auto places = static_cast<Index>(sheet::inner.size());
        some_.clear();
        for (Index i = 0; i < static_cast<Index>(rays_.size()); ++i) {
            if (is_taken_[i]) some_.push_back(i);
        }
        const auto count = static_cast<Index>(some_.size());
        cubics_.resize(count * places * n_);
        const View<double> cubics{cubics_.data(), count * places, n_};
        for (Index i = 0; i < count; ++i) {
            const Index ray = rays_[some_[i]];
            const double begin = at_.t[ray], width = end_.t[some_[i]] - begin;
            for (Index k = 0; k < places; ++k) {
                on_cubic(at_, ray, end_, some_[i], begin + sheet::inner[k] * width, cubics.row(i * places + k));
            }
        }
        corrected_ = cubics_;
        corrector_.correct({corrected_.data(), count * places, n_}, [&](Index i) { return plane(rays_[some_[i / places]]); },
                           of_cubics_);
        for (Index i = 0; i < count; ++i) is_taken_[some_[i]] = is_arc(i * places);
    }

    // Whether the corrections from number ``first`` on are those of one curve.
    bool is_arc(Index first) const {
        double uneven = 0.0;
        std::array<double, 3> squares{};
        for (Index k = 0; k < 3; ++k) {
            const Correction& correction = of_cubics_[first + k];
            if (!(is_solved(correction) && correction.contraction() < sheet::contraction)) return false;
        }
        for (Index j = 0; j < n_; ++j) {
            std::array<double, 3> bumps;
            for (Index k = 0; k < 3; ++k) {
                const Index entry = (first + k) * n_ + j;
                bumps[k] = (corrected_[entry] - cubics_[entry]) / sheet::bump[k];
                squares[k] += bumps[k] * bumps[k];
            }
            const double bent = 0.5 * (bumps[0] + bumps[2]) - bumps[1];
            uneven += bent * bent;
        }
        const double largest = std::sqrt(*std::max_element(squares.begin(), squares.end()));
        return std::sqrt(uneven) <= sheet::smooth * largest + corrections::settled * corrector_.scale();
    }

    // Notes that a ray went to end number i, and where it passed.
    void reach(Index ray, Index i) {
        const auto s = static_cast<Index>(bundle_.shares.size());
        const double begin = at_.t[ray];
        for (Index k = 0; k < s; ++k) {
            const double share = bundle_.shares[k];
            if (!(begin < share && share <= end_.t[i])) continue;
            const Vector<double> point = out_.passed.row(ray * s + k);
            if (const double* known = known_at((share - begin) / (end_.t[i] - begin), i)) {
                std::copy_n(known, n_, point.data());
                out_.are_there[ray * s + k] = true;
            } else {
                on_cubic(at_, ray, end_, i, share, point);
            }
        }
        before_.put(ray, at_, ray);
        at_.put(ray, end_, i);
    }

    // The solution (n) that is known at a share of the arc to end number i; none where none is.
    const double* known_at(double share, Index i) const {
        if (std::abs(share - 1.0) < sheet::rounding) return end_.points.row(i).data();
        const auto arc = std::find(some_.begin(), some_.end(), i) - some_.begin();
        for (std::size_t k = 0; k < sheet::inner.size(); ++k) {
            if (std::abs(share - sheet::inner[k]) < sheet::rounding) {
                return corrected_.data() + (arc * sheet::inner.size() + k) * n_;
            }
        }
        return nullptr;
    }

    // Corrects the places that were passed and are not known.
    void finish() {
        const auto s = static_cast<Index>(bundle_.shares.size());
        for (Index ray = 0; ray < bundle_.centers.rows; ++ray) {
            out_.reached[ray] = at_.t[ray];
            std::copy(at_.points.row(ray).begin(), at_.points.row(ray).end(), out_.ends.row(ray).begin());
        }
        some_.clear();
        for (Index i = 0; i < out_.passed.rows; ++i) {
            if (!out_.are_there[i]) some_.push_back(i);
        }
        const auto count = static_cast<Index>(some_.size());
        corrected_.resize(count * n_);
        const View<double> points{corrected_.data(), count, n_};
        for (Index i = 0; i < count; ++i) copy_row(out_.passed.row(some_[i]), points.row(i));
        corrector_.correct(points, [&](Index i) { return plane(some_[i] / s); }, corrections_);
        for (Index i = 0; i < count; ++i) {
            const Index k = some_[i];
            copy_row(points.row(i), out_.passed.row(k));
            out_.are_there[k] = is_solved(corrections_[i]) && corrections_[i].contraction() < sheet::contraction &&
                                at_.t[k / s] >= bundle_.shares[k % s];
        }
    }

    static void copy_row(Vector<const double> from, Vector<double> to) { std::copy(from.begin(), from.end(), to.begin()); }

    const Equations& equations_;
    Index n_;
    NormalCorrector corrector_;
    Slopes slopes_;
    RayBundle bundle_{};
    RayEnds out_{};
    Nodes at_, before_, end_;  // the last nodes reached, those before them, and those that are tried
    std::vector<double> straight_, steps_, cubics_, corrected_;
    std::vector<Index> rays_, some_;
    std::vector<bool> is_taken_;
    std::vector<Correction> corrections_, of_cubics_;
};

// How a disk has to fit a surface: its radius between the ``smallest`` and the ``largest``, the height of the
// surface above it, over the radius, at most ``bend``, and the cosine between tangent planes at least ``agree``;
// entries up to ``negligible`` of the largest say nothing about these.
struct DiskLimits {
    double largest, smallest, bend, agree, negligible;
};

// The radius of a disk, how high the surface is above it, over the radius, and whether other sheets are far from it.
struct FittingDisk {
    double radius, height;
    bool is_clear;
};

namespace disk {
// How far from the centre, over the radius, other sheets are looked for. Where none is near, the second step of
// Newton's method from there, over the first, and the distance of where it ends from the centre, over that of
// where it begins, are smaller than these. With a factor for every two steps the first is 1/4 where the other sheet is
// far nearer than that.
constexpr double aside = 0.2, contraction = 0.15, back = 0.3;
// Change of F' across the plane up to the rim, over F', below which no sheet crosses in the disk, and entries,
// over the largest, that are taken for zero there.
constexpr double steady = 0.7, negligible = 1e-12;
}  // namespace disk

// Unit vectors (r, d) to places on the rim of a disk of d dimensions at which a surface is looked at: both ways along the
// axes, halfway between each two of them, and halfway between all of them where they are more. They show its bend in all
// directions.
inline Matrix<double> rim_of(Index d) {
    const Index corners = d > 2 ? Index{1} << d : 0;
    Matrix<double> rim(2 * d * d + corners, d);
    Index row = 0;
    for (Index one = 0; one < d; ++one) {
        for (Index other = one + 1; other < d; ++other) {
            for (int eighth = 0; eighth < 8; ++eighth) {
                // axes come with the first pair that has them
                if (eighth % 2 == 0 && (one > 0 || (eighth % 4 == 0 && other > 1))) continue;
                const double angle = std::numbers::pi / 4.0 * static_cast<double>(eighth);
                rim(row, one) = std::cos(angle);
                rim(row, other) = std::sin(angle);
                ++row;
            }
        }
    }
    for (Index corner = 0; corner < corners; ++corner, ++row) {
        for (Index j = 0; j < d; ++j) rim(row, j) = ((corner >> j) & 1 ? 1.0 : -1.0) / std::sqrt(static_cast<double>(d));
    }
    return rim;
}

// Disks about solutions, of ``dimension`` d. Not for two threads at once.
class DiskFitter {
public:
    DiskFitter(const Equations& equations, double scale, Index dimension)
        : equations_(equations),
          n_(equations.unknowns()),
          d_(dimension),
          rim_(rim_of(d_)),
          count_(rim_.rows()),
          corrector_(equations, scale),
          follower_(equations, scale),
          slopes_(equations),
          values_(n_),
          flat_(count_ + 2, n_),
          points_(count_ + 2, n_),
          factor_(n_, n_),
          at_rim_(n_, d_) {}

    // The largest disk in the plane ``basis`` (n, d) at a solution to which the surface stays close and where
    // tangent planes agree; another sheet may be near along the unit vector ``normal``, which may be zero.
    std::optional<FittingDisk> fit(Vector<const double> center, View<const double> basis, Vector<const double> normal,
                                   const DiskLimits& limits) {
        center_ = center;
        basis_ = basis;
        normal_ = normal;
        for (double radius = limits.largest; radius >= limits.smallest;) {
            bool is_clear = look_straight_above(radius);
            double height = highest() / radius;
            if (height < limits.bend) {
                is_clear = is_clear && is_steady();
                if (!is_clear) height = follow_to_rim(radius) ? highest() / radius : infinite;
                if (height < limits.bend && planes_agree(limits, is_clear)) return FittingDisk{radius, height, is_clear};
            }
            double shrink = 0.5;
            if (std::isfinite(height)) shrink = std::clamp(0.9 * limits.bend / height, 0.5, 0.8);
            radius *= shrink;
        }
        return {};
    }

private:
    static constexpr double infinite = std::numeric_limits<double>::infinity();

    View<const double> rim_points() const { return {points_.view().data, count_, n_}; }

    // Finds solutions straight above the rim, and whether Newton's method comes to them, and back to the centre from
    // beside it, at once, as it does where no other sheet is near.
    bool look_straight_above(double radius) {
        double offset = 0.0;
        for (Index j = 0; j < n_; ++j) {
            for (Index i = 0; i < count_; ++i) {
                flat_(i, j) = center_[j] + radius * dot(rim_.row(i), basis_.row(j));
            }
            const double step = disk::aside * radius * normal_[j];
            flat_(count_, j) = center_[j] + step;
            flat_(count_ + 1, j) = center_[j] - step;
            offset += step * step;
        }
        std::copy_n(flat_.view().data, flat_.rows() * n_, points_.view().data);
        corrector_.correct(points_, [&](Index) { return basis_; }, corrections_);
        for (Index i = 0; i < flat_.rows(); ++i) {
            if (!(corrections_[i].contraction() < disk::contraction)) return false;
            if (i < count_ && !(corrections_[i].gap < sheet::solved)) return false;
            if (i >= count_ && !(distance_from_center(i) <= disk::back * std::sqrt(offset))) return false;
        }
        return true;
    }

    double distance_from_center(Index i) const {
        double square = 0.0;
        for (Index j = 0; j < n_; ++j) square += (points_(i, j) - center_[j]) * (points_(i, j) - center_[j]);
        return std::sqrt(square);
    }

    // Whether F' across the plane is all along the rim much what it is at the centre: where another sheet
    // crosses it changes its sign. With E for what it changes by, over F' there, v^T (1 + E) v is at least 1 -
    // ``steady`` for unit vectors v, and no value is taken twice (Gale and Nikaido 1965, theorem 6).
    bool is_steady() {
        equations_.fill({center_.data(), 1, n_}, true, values_);
        const Index m = values_.equations();
        Matrix<double> at_center(m, n_);
        across(values_.jacobian(0), at_center);
        equations_.fill(rim_points(), true, values_);
        solver_.reserve(m + d_, n_, count_ * n_);
        std::copy_n(at_center.view().data, m * n_, solver_.matrix().data);
        for (Index j = 0; j < n_; ++j) {
            for (Index side = 0; side < d_; ++side) solver_.matrix()(m + side, j) = basis_(j, side);
        }
        Matrix<double> there(m, n_);
        for (Index i = 0; i < count_; ++i) {
            across(values_.jacobian(i), there);
            for (Index row = 0; row < m; ++row) {
                for (Index j = 0; j < n_; ++j) solver_.sides()(row, i * n_ + j) = there(row, j) - at_center(row, j);
            }
        }
        Matrix<double> changes(n_, count_ * n_);
        solver_.solve(disk::negligible, changes);
        for (Index i = 0; i < count_; ++i) {
            if (!is_positive(changes, i * n_)) return false;
        }
        return true;
    }

    // F' without its part in the plane.
    void across(View<const double> jacobian, View<double> out) const {
        for (Index row = 0; row < jacobian.rows; ++row) {
            std::array<double, Gram::most> along{};
            for (Index j = 0; j < n_; ++j) {
                for (Index side = 0; side < d_; ++side) along[side] += jacobian(row, j) * basis_(j, side);
            }
            for (Index j = 0; j < n_; ++j) {
                out(row, j) = jacobian(row, j) - dot({along.data(), static_cast<std::size_t>(d_)}, basis_.row(j));
            }
        }
    }

    // Whether ``steady`` and the symmetric part of the block (n, n) from a column on are positive together, by
    // Cholesky's factor.
    bool is_positive(const Matrix<double>& blocks, Index first) {
        for (Index i = 0; i < n_; ++i) {
            for (Index j = 0; j <= i; ++j) {
                double total = 0.5 * (blocks(i, first + j) + blocks(j, first + i));
                if (i == j) total += disk::steady;
                for (Index k = 0; k < j; ++k) total -= factor_(i, k) * factor_(j, k);
                if (i > j) {
                    factor_(i, j) = total / factor_(j, j);
                } else {
                    if (!(total > 0.0)) return false;  // nor is what is no number
                    factor_(i, i) = std::sqrt(total);
                }
            }
        }
        return true;
    }

    // How far the solutions are from the plane, the farthest.
    double highest() const {
        double largest = 0.0;
        for (Index i = 0; i < count_; ++i) {
            double square = 0.0;
            for (Index j = 0; j < n_; ++j) square += (points_(i, j) - flat_(i, j)) * (points_(i, j) - flat_(i, j));
            if (!(square <= largest)) largest = square;  // not a number is more than any
        }
        return std::sqrt(largest);
    }

    // Follows the sheet from the centre to the rim; whether all of it is reached.
    bool follow_to_rim(double radius) {
        Matrix<double> centers(count_, n_), planes(count_ * n_, d_), positions(count_, d_);
        for (Index i = 0; i < count_; ++i) {
            std::copy(center_.begin(), center_.end(), centers.row(i).begin());
            std::copy_n(basis_.data, d_ * n_, planes.row(i * n_).data());
            for (Index side = 0; side < d_; ++side) positions(i, side) = radius * rim_(i, side);
        }
        std::vector<double> reached(count_);
        const View<double> ends{points_.view().data, count_, n_};
        follower_.follow({centers, planes, positions, {}}, {ends, reached, {nullptr, 0, n_}, {}}, [] {});
        return std::all_of(reached.begin(), reached.end(), [](double t) { return t >= 1.0; });
    }

    // The columns of the slopes have 1 over the cosines between the planes as singular values.
    bool planes_agree(const DiskLimits& limits, bool has_values) {
        if (!has_values) equations_.fill(rim_points(), true, values_);
        for (Index i = 0; i < count_; ++i) {
            slopes_.solve(values_.jacobian(i), basis_, limits.negligible, at_rim_);
            const double steepest = Gram(at_rim_).largest();
            // there are no slopes where F' is not finite
            if (!(steepest > 0.0 && steepest * limits.agree < 1.0)) return false;
        }
        return true;
    }

    const Equations& equations_;
    Index n_, d_;
    Matrix<double> rim_;
    Index count_;  // of places on the rim
    NormalCorrector corrector_;
    RayFollower follower_;
    Slopes slopes_;
    Values values_;
    LeastNorm solver_;
    Matrix<double> flat_, points_, factor_, at_rim_;
    std::vector<Correction> corrections_;
    Vector<const double> center_, normal_;
    View<const double> basis_{};
};

}  // namespace bifurc
