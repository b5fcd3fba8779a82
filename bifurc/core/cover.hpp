// A surface that is being covered by charts, one after another. The method stands in `bifurc.surfaces.covering`.
#pragma once

#include <utility>
#include <vector>

#include "bifurc/core/deadline.hpp"
#include "bifurc/core/front.hpp"
#include "bifurc/core/sheet.hpp"

namespace bifurc {

namespace cover {
constexpr double growth = 1.4;     // radius of a chart, over that of the one from which it was made, at most
constexpr double expected = 0.95;  // height of the surface above the disk that is tried, over the most
constexpr double too_close = 0.2;  // distance from another centre, over the radius there, that is not worth a chart
constexpr double too_far = 0.5;    // distance, over the radius, beyond which a centre was corrected onto another sheet
constexpr double solved = 1e-10;   // residual above which a centre is no solution
constexpr double same = 1e-7;      // distance, over the scale, below which the end of a ray is a known solution
constexpr double on_disk = 1e-9;   // share of the radius by which a vertex is outside the disk only by rounding
constexpr double towards = 0.97;   // cosine between directions that lead to the same place
constexpr double higher = 3.0;     // height of an overlapping chart's centre, over the distance and that of a surface
// Height of a centre above another disk, over that of a parabola with the bend of the disks, and over the distance beside
// that, which is on their sheet for sure where no other is near.
constexpr double bent = 2.0, slant = 0.02;
constexpr double hole = 1e-3;      // share of the radius by which a vertex outside the disk shows a hole at the end
constexpr double roomy = 2.0;      // distance from bounds, over the radius, from which on they do not matter
}  // namespace cover

// What becomes of a place at which a chart is wanted: it fits; charts cover it already, although the polygon does
// not show it; no chart fits there; or it has to be looked at, beside bounds, or as no disk of a usual size fits.
enum class Placement { fits, covered, unfit, beside_bounds, tight };

// A solution with its tangent plane, about which a chart with a disk of at most a radius is wanted.
struct Candidate {
    Placement placement;
    std::vector<double> center;
    TangentPlane plane;
    double largest;
    FittingDisk disk;
};

// A direction in the plane of a chart.
template <Index d>
struct Lead {
    Index chart;
    std::array<double, d> direction;
};

// Why no more charts were made: none are wanted, a limit is reached, or a candidate has to be looked at.
enum class Growth { complete, out_of_time, undecided, chart_limit, doubt };

// The charts of a surface, or of a component of dimension ``d``. Not for two threads at once.
template <Index d>
class Cover {
public:
    // Charts may be neighbours whose tangent planes ``agree`` by a cosine above that, and follow one another where
    // it is above ``smooth``.
    Cover(const Equations& equations, double scale, Vector<const double> periods, View<const double> bounds,
          double agree, double smooth, const DiskLimits& disks)
        : n_(equations.unknowns()),
          scale_(scale),
          bounds_(bounds.data, bounds.data + 2 * n_),
          smooth_(smooth),
          limits_(disks),
          // in two disks of radius R that touch, one centre lies up to 4 bend R above the other's plane
          front_(periods, {cover::higher * disks.bend, agree, cover::on_disk, cover::towards}),
          corrector_(equations, scale),
          follower_(equations, scale),
          planes_(equations),
          fitter_(equations, scale, d) {}

    using Cell = typename Front<d>::Cell;

    const Front<d>& front() const { return front_; }
    Index undecided() const { return undecided_; }

    // Adds charts at open vertices until there are none, a limit is reached, or a candidate has to be looked at:
    // that, and where it was wanted.
    struct Stop {
        Growth growth;
        std::optional<Candidate> candidate{};
        Lead<d> lead{};
    };
    Stop grow(Index most_charts, Index most_undecided, Deadline& deadline) {
        while (const auto open = front_.next_open()) {
            if (deadline.has_passed()) return {Growth::out_of_time};
            if (undecided_ > most_undecided) return {Growth::undecided};
            if (front_.count() >= most_charts) return {Growth::chart_limit};
            const Lead<d> lead{open->first, open->second};
            std::optional<Candidate> next = next_to(lead);
            if (!next || next->placement == Placement::unfit || next->placement == Placement::covered) {
                refuse(lead, !next || next->placement == Placement::unfit);
            } else if (next->placement == Placement::fits) {
                add(next->center, next->plane.basis, next->disk, Cell::around(next->disk.radius));
            } else {
                return {Growth::doubt, std::move(next), lead};
            }
        }
        return {Growth::complete};
    }

    // No chart is made there: where none fits, others may cover it later, else it is a hole.
    void refuse(const Lead<d>& lead, bool is_unfit) {
        front_.add_dead_end(lead.chart, lead.direction);
        if (is_unfit) unfit_.push_back(lead);
    }

    // What a chart about a solution, of at most a radius, would be; its tangent plane is next to ``near`` (n, d).
    Candidate candidate(Vector<const double> center, View<const double> near, double radius) {
        Candidate out{Placement::unfit, {center.begin(), center.end()}, planes_.at(center, near, limits_.negligible),
                      std::min(radius, limits_.largest), {}};
        if (out.plane.cosine < smooth_) return out;
        if (is_close_to_a_center(center, out.plane.basis)) {
            out.placement = Placement::covered;
            return out;
        }
        const auto fitting = disk(center, out.plane.basis, out.plane.normal, out.largest, limits_.smallest);
        out.placement = Placement::tight;
        if (fitting) {
            out.disk = *fitting;
            out.placement = is_beside_bounds(center, fitting->radius) ? Placement::beside_bounds : Placement::fits;
        }
        return out;
    }

    // The largest disk that fits a tangent plane at a solution, with a radius between these.
    std::optional<FittingDisk> disk(Vector<const double> center, View<const double> basis, Vector<const double> normal,
                                    double largest, double smallest) {
        DiskLimits limits = limits_;
        limits.largest = largest;
        limits.smallest = smallest;
        return fitter_.fit(center, basis, normal, limits);
    }

    // Adds a chart with a polygon, and cuts that and those of the charts on its sheet that overlap it.
    void add(Vector<const double> center, View<const double> basis, const FittingDisk& disk, Cell polygon) {
        const auto others = on_sheet(center, basis, disk, front_.overlaps(center, basis, disk.radius));
        front_.add(center, basis, disk.radius, disk.is_clear, std::move(polygon), others);
        heights_.push_back(disk.height);
    }

    // Where on the rims of charts, at places at which none fitted, polygons are still open: points (k * n).
    std::vector<double> holes() const {
        std::vector<double> out;
        for (const Lead<d>& lead : unfit_) {
            if (!front_.is_open_towards(lead.chart, lead.direction, cover::hole)) continue;
            const std::vector<double> above = above_rim(lead);
            out.insert(out.end(), above.begin(), above.end());
        }
        return out;
    }

private:
    std::vector<double> above_rim(const Lead<d>& lead) const {
        const Vector<const double> center = front_.center(lead.chart);
        const View<const double> basis = front_.basis(lead.chart);
        const double radius = front_.radius(lead.chart);
        std::vector<double> out(center.begin(), center.end());
        for (Index j = 0; j < n_; ++j) {
            out[j] += radius * dot(basis.row(j), lead.direction);
        }
        return out;
    }

    // The candidate about the solution above the rim of a chart in a direction; none where that is on another sheet.
    std::optional<Candidate> next_to(const Lead<d>& lead) {
        const double radius = front_.radius(lead.chart);
        const View<const double> basis = front_.basis(lead.chart);
        const std::vector<double> start = above_rim(lead);
        std::vector<double> center = start;
        bool is_there = false;
        if (front_.is_clear(lead.chart)) {
            corrector_.correct({center.data(), 1, n_}, [&](Index) { return basis; }, corrections_);
            is_there = corrections_[0].gap < cover::solved;
        } else {
            for (Index side = 0; side < d; ++side) positions_[side] = radius * lead.direction[side];
            const Vector<const double> at = front_.center(lead.chart);
            double reached = 0.0;
            follower_.follow({{at.data(), 1, n_}, basis, {positions_.data(), 1, d}, {}},
                             {{center.data(), 1, n_}, {&reached, 1}, {nullptr, 0, n_}, {}}, [] {});
            is_there = reached >= 1.0;
        }
        double square = 0.0;
        for (Index j = 0; j < n_; ++j) square += (center[j] - start[j]) * (center[j] - start[j]);
        if (!is_there || std::sqrt(square) > cover::too_far * radius) return {};
        // the surface is expected to bend as it does about the chart
        const double room = cover::expected * limits_.bend / std::max(heights_[lead.chart], sheet::tiny);
        return candidate(center, basis, radius * std::min(cover::growth, room));
    }

    // Whether a chart would be close to another one.
    bool is_close_to_a_center(Vector<const double> center, View<const double> basis) {
        std::vector<Overlap<d>> close;
        for (const Overlap<d>& other : front_.overlaps(center, basis, limits_.largest)) {
            const double distance = length(other.position);
            if (distance < cover::too_close * front_.radius(other.number)) close.push_back(other);
        }
        return !on_sheet(center, basis, {0.0, 0.0, true}, std::move(close)).empty();
    }

    bool is_beside_bounds(Vector<const double> center, double radius) const {
        for (Index j = 0; j < 2 * n_; ++j) {
            if (!(std::abs(bounds_[j] - center[j / 2]) > cover::roomy * radius)) return true;
        }
        return false;
    }

    // Those of the charts whose centres are on the sheet of a solution, with a disk of a radius: above the plane of
    // the larger disk the sheet leads to the other centre.
    std::vector<Overlap<d>> on_sheet(Vector<const double> center, View<const double> basis, const FittingDisk& disk,
                                  std::vector<Overlap<d>> others) {
        std::vector<Index> open;
        for (std::size_t i = 0; i < others.size(); ++i) {
            const bool are_clear = disk.is_clear && front_.is_clear(others[i].number);
            if (!are_clear || is_too_high(others[i], disk)) open.push_back(static_cast<Index>(i));
        }
        if (open.empty()) return others;
        const auto count = static_cast<Index>(open.size());
        Matrix<double> centers(count, n_), goals(count, n_), planes(count * n_, d), positions(count, d), ends(count, n_);
        for (Index i = 0; i < count; ++i) {
            const Index other = others[open[i]].number;
            const bool is_larger = front_.radius(other) > disk.radius;
            const Vector<const double> from = is_larger ? front_.center(other) : center;
            const Vector<const double> to = is_larger ? center : front_.center(other);
            const View<const double> plane = is_larger ? front_.basis(other) : basis;
            const auto position = front_.gap(to, from, plane).position;
            std::copy(from.begin(), from.end(), centers.row(i).begin());
            std::copy(to.begin(), to.end(), goals.row(i).begin());
            std::copy_n(plane.data, d * n_, planes.row(i * n_).data());
            std::copy(position.begin(), position.end(), positions.row(i).begin());
        }
        std::vector<double> reached(count);
        follower_.follow({centers, planes, positions, {}}, {ends, reached, {nullptr, 0, n_}, {}}, [] {});
        std::vector<bool> is_elsewhere(others.size(), false);
        for (Index i = 0; i < count; ++i) {
            if (!(reached[i] >= 1.0)) {
                ++undecided_;
                continue;
            }
            // off the surface redundant equations contradict one another, and their least squares move an end a
            // little along it
            const auto gap = front_.gap(goals.row(i), ends.row(i), plane_of(planes, i, n_));
            const double moved = length(gap.position) + cover::same * scale_;
            is_elsewhere[open[i]] = !(gap.height < moved);
        }
        std::vector<Overlap<d>> same;
        for (std::size_t i = 0; i < others.size(); ++i) {
            if (!is_elsewhere[i]) same.push_back(others[i]);
        }
        return same;
    }

    // Whether the centre of a chart is higher above a disk than the bend of both makes it: it may be on a sheet that is
    // farther away than others are looked for.
    bool is_too_high(const Overlap<d>& other, const FittingDisk& disk) const {
        const double there = heights_[other.number] / front_.radius(other.number);
        const double here = disk.radius > 0.0 ? disk.height / disk.radius : 0.0;
        const double square = squared_length(other.position);
        return other.height > cover::bent * std::max(here, there) * square + cover::slant * std::sqrt(square);
    }

    Index n_;
    double scale_;
    std::vector<double> bounds_;
    double smooth_;
    DiskLimits limits_;
    Front<d> front_;
    NormalCorrector corrector_;
    RayFollower follower_;
    TangentPlanes planes_;
    DiskFitter fitter_;
    std::array<double, d> positions_{};
    std::vector<double> heights_;  // of the surface above the disks, over their radii
    std::vector<Lead<d>> unfit_;
    std::vector<Correction> corrections_;
    Index undecided_ = 0;  // pairs of charts of which it is not known whether they are on one sheet
};

}  // namespace bifurc
