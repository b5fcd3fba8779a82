// The charts of a surface, or of a component of more dimensions, that is being covered: which of them overlap, what their cells are cut to, and
// where these are open. The method stands in `bifurc.surfaces.covering`.
#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>
#include <type_traits>
#include <vector>

#include "bifurc/core/arrays.hpp"
#include "bifurc/core/gram.hpp"
#include "bifurc/core/polytope.hpp"

namespace bifurc {

// A chart that overlaps a disk: its number, the position of its centre in the plane of the disk, and its height
// above that.
template <Index d>
struct Overlap {
    Index number;
    std::array<double, d> position;
    double height;
};

// What charts have to be to overlap, and polygons to be open: how high, over the distance, another centre may lie
// above a plane, the smallest cosine between planes, the share of the radius by which a vertex is outside its
// disk only by rounding, and the cosine between directions that lead to the same place.
struct FrontLimits {
    double height, agree, on_disk, towards;
};

// The charts of components of dimension ``d``. What is said of polygons holds for polytopes.
template <Index d>
class Front {
public:
    using Direction = std::array<double, d>;
    using Cell = std::conditional_t<d == 2, ConvexPolygon, ConvexPolytope<d>>;

    struct Place {
        Direction position;
        double height;
    };

    Front(Vector<const double> periods, const FrontLimits& limits)
        : n_(static_cast<Index>(periods.size())), periods_(periods.begin(), periods.end()), limits_(limits), offset_(n_) {}

    Index unknowns() const { return n_; }
    Index count() const { return static_cast<Index>(radii_.size()); }
    Vector<const double> center(Index chart) const {
        return {centers_.data() + chart * n_, static_cast<std::size_t>(n_)};
    }
    View<const double> basis(Index chart) const { return {bases_.data() + d * chart * n_, n_, d}; }
    double radius(Index chart) const { return radii_[chart]; }
    bool is_clear(Index chart) const { return are_clear_[chart]; }
    const Cell& polygon(Index chart) const { return polygons_[chart]; }

    // The charts that overlap a disk in a plane ``basis`` (n, d) about ``center`` (n), or lie above it.
    std::vector<Overlap<d>> overlaps(Vector<const double> center, View<const double> basis, double radius) {
        std::vector<Overlap<d>> found;
        for (Index chart = 0; chart < count(); ++chart) {
            const double reach = radius + radii_[chart];
            const double square = squared_distance(this->center(chart), center, reach * reach);
            if (!(square < reach * reach)) continue;
            const auto [position, height] = place(basis);
            if (!(height < limits_.height * std::max(radius, std::sqrt(square)))) continue;
            if (smallest_cosine(this->basis(chart), basis) > limits_.agree) found.push_back({chart, position, height});
        }
        return found;
    }

    // Adds a chart with a polygon, and cuts that and those of the charts that overlap it.
    void add(Vector<const double> center, View<const double> basis, double radius, bool is_clear, Cell polygon,
             const std::vector<Overlap<d>>& overlaps) {
        const Index number = count();
        for (const Overlap<d>& other : overlaps) {
            cut(polygon, radius, other.position, other.height, radii_[other.number], other.number);
            const auto [position, height] = gap(center, this->center(other.number), this->basis(other.number));
            cut(polygons_[other.number], radii_[other.number], position, height, radius, number);
            open_.push_back(other.number);
        }
        centers_.insert(centers_.end(), center.begin(), center.end());
        bases_.insert(bases_.end(), basis.data, basis.data + d * n_);
        radii_.push_back(radius);
        are_clear_.push_back(is_clear);
        polygons_.push_back(std::move(polygon));
        dead_ends_.emplace_back();
        open_.push_back(number);
    }

    // A chart of which the polygon is open, and the unit vector to the vertex farthest outside its disk, in no
    // direction that is a dead end; none where all are closed.
    std::optional<std::pair<Index, Direction>> next_open() {
        while (!open_.empty()) {
            const Index chart = open_.front();
            if (const auto direction = open_direction(chart)) return std::pair{chart, *direction};
            open_.pop_front();
        }
        return {};
    }

    // Whether a polygon has a vertex in a direction, outside the disk by more than a share of the radius.
    bool is_open_towards(Index chart, const Direction& direction, double share) const {
        const auto& vertices = polygons_[chart].vertices;
        return std::any_of(vertices.begin(), vertices.end(), [&](const Direction& vertex) {
            const double size = length(vertex);
            return is_towards(vertex, direction, size) && size > (1.0 + share) * radii_[chart];
        });
    }

    // Where a point lies in a plane about another one, and how high above it.
    Place gap(Vector<const double> point, Vector<const double> from, View<const double> basis) {
        squared_distance(point, from, std::numeric_limits<double>::infinity());
        return place(basis);
    }

    // No other chart can be made from this one in a direction.
    void add_dead_end(Index chart, const Direction& direction) { dead_ends_[chart].push_back(direction); }

private:
    // |a - b|^2 with periodic unknowns to within half a period, and the difference; no more of it than up to
    // where it is seen to be more than ``most``.
    double squared_distance(Vector<const double> a, Vector<const double> b, double most) {
        double square = 0.0;
        for (Index j = 0; j < n_; ++j) {
            double gap = a[j] - b[j];
            if (std::isfinite(periods_[j])) gap -= periods_[j] * std::nearbyint(gap / periods_[j]);
            offset_[j] = gap;
            square += gap * gap;
            if (square >= most) return square;
        }
        return square;
    }

    // Where the difference that was taken last lies in a plane, and how high above it.
    Place place(View<const double> basis) const {
        Place out{};
        for (Index j = 0; j < n_; ++j) {
            for (Index side = 0; side < d; ++side) out.position[side] += offset_[j] * basis(j, side);
        }
        double square = 0.0;
        for (Index j = 0; j < n_; ++j) {
            const double above = offset_[j] - dot(basis.row(j), out.position);
            square += above * above;
        }
        out.height = std::sqrt(square);
        return out;
    }

    // The smaller singular value of one^T other.
    double smallest_cosine(View<const double> one, View<const double> other) const {
        SmallMatrix<double, d, d> product{};
        for (Index row = 0; row < n_; ++row) {
            for (Index i = 0; i < d; ++i) {
                for (Index j = 0; j < d; ++j) product(i, j) += one(row, i) * other(row, j);
            }
        }
        return Gram(View<double>(product)).smallest();
    }

    // Cuts a polygon where its disk intersects another one, whose centre lies at a height. In the formula of
    // Henderson (2002) the distance in the plane is corrected for the bend of the surface.
    static void cut(Cell& polygon, double radius, const Direction& position, double height,
                    double other_radius, Index label) {
        const double distance = length(position);
        if (distance == 0.0) return;
        const double bent = distance * distance + 0.5 * height * height;
        const double offset = (bent + radius * radius - other_radius * other_radius) / (2.0 * distance);
        polygon.clip(over(position, distance), offset, label);
    }

    std::optional<Direction> open_direction(Index chart) const {
        double farthest = radii_[chart] * (1.0 + limits_.on_disk);
        std::optional<Direction> found;
        for (const auto& vertex : polygons_[chart].vertices) {
            const double size = length(vertex);
            if (!(size > farthest) || is_dead_end(chart, vertex, size)) continue;
            farthest = size;
            found = over(vertex, size);
        }
        return found;
    }

    bool is_dead_end(Index chart, const Direction& vertex, double size) const {
        const auto& directions = dead_ends_[chart];
        return std::any_of(directions.begin(), directions.end(), [&](const Direction& direction) {
            return is_towards(vertex, direction, size);
        });
    }

    bool is_towards(const Direction& vertex, const Direction& direction, double size) const {
        return dot(vertex, direction) >= limits_.towards * size;
    }

    static Direction over(Direction vector, double size) {
        for (double& entry : vector) entry /= size;
        return vector;
    }

    Index n_;
    std::vector<double> periods_;
    FrontLimits limits_;
    std::vector<double> centers_, bases_, radii_, offset_;
    std::vector<bool> are_clear_;  // where no other sheet is near
    std::vector<Cell> polygons_;
    std::vector<std::vector<Direction>> dead_ends_;
    std::deque<Index> open_;  // charts whose polygons may be open
};

}  // namespace bifurc
