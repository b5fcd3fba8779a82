// The charts of a surface that is being covered: which of them overlap, what their polygons are cut to, and
// where these are open. The method stands in `bifurc.surfaces.covering`.
#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "bifurc/core/arrays.hpp"

namespace bifurc {

// A convex polygon about the origin of the plane of a chart: vertices (x, y), counterclockwise, and what made
// each edge, which runs from the vertex of that number to the next one.
struct ConvexPolygon {
    std::vector<std::array<double, 2>> vertices;
    std::vector<Index> labels;

    // The octagon around a circle, which nothing has cut yet.
    static ConvexPolygon octagon(double radius) {
        constexpr double eighth = std::numbers::pi / 4.0;
        const double size = radius / std::cos(eighth / 2.0);
        ConvexPolygon out;
        for (int i = 0; i < 8; ++i) {
            out.vertices.push_back({size * std::cos(eighth * (i + 0.5)), size * std::sin(eighth * (i + 0.5))});
            out.labels.push_back(outline);
        }
        return out;
    }

    static constexpr Index outline = -1;  // label of an edge that nothing has cut yet

    // Cuts off what is not normal . y <= offset; the edge along the cut gets ``label``.
    void clip(const std::array<double, 2>& normal, double offset, Index label) {
        const std::size_t count = vertices.size();
        if (count == 0) return;
        heights_.resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            heights_[i] = vertices[i][0] * normal[0] + vertices[i][1] * normal[1] - offset;
        }
        const auto [least, most] = std::minmax_element(heights_.begin(), heights_.end());
        if (*most <= 0.0) return;
        if (*least > 0.0) {
            vertices.clear();
            labels.clear();
            return;
        }
        std::size_t leaves = 0, enters = 0;
        const auto after = [&](std::size_t i) { return i + 1 < count ? i + 1 : 0; };
        while (!(heights_[leaves] <= 0.0 && heights_[after(leaves)] > 0.0)) ++leaves;
        while (!(heights_[enters] > 0.0 && heights_[after(enters)] <= 0.0)) ++enters;
        ConvexPolygon rest;
        for (std::size_t i = after(enters); i != after(leaves); i = after(i)) {
            rest.vertices.push_back(vertices[i]);
            rest.labels.push_back(labels[i]);
        }
        rest.vertices.push_back(crossing(leaves, after(leaves)));
        rest.labels.push_back(label);
        rest.vertices.push_back(crossing(enters, after(enters)));
        rest.labels.push_back(labels[enters]);
        vertices.swap(rest.vertices);
        labels.swap(rest.labels);
    }

private:
    // The point of an edge on the line.
    std::array<double, 2> crossing(std::size_t first, std::size_t last) const {
        const double share = heights_[first] / (heights_[first] - heights_[last]);
        const auto &begin = vertices[first], &end = vertices[last];
        return {begin[0] + share * (end[0] - begin[0]), begin[1] + share * (end[1] - begin[1])};
    }

    std::vector<double> heights_;
};

// A chart that overlaps a disk: its number, the position of its centre in the plane of the disk, and its height
// above that.
struct Overlap {
    Index number;
    std::array<double, 2> position;
    double height;
};

// What charts have to be to overlap, and polygons to be open: how high, over the distance, another centre may lie
// above a plane, the smallest cosine between planes, the share of the radius by which a vertex is outside its
// disk only by rounding, and the cosine between directions that lead to the same place.
struct FrontLimits {
    double height, agree, on_disk, towards;
};

class Front {
public:
    struct Place {
        std::array<double, 2> position;
        double height;
    };

    Front(Vector<const double> periods, const FrontLimits& limits)
        : n_(static_cast<Index>(periods.size())), periods_(periods.begin(), periods.end()), limits_(limits), offset_(n_) {}

    Index unknowns() const { return n_; }
    Index count() const { return static_cast<Index>(radii_.size()); }
    Vector<const double> center(Index chart) const {
        return {centers_.data() + chart * n_, static_cast<std::size_t>(n_)};
    }
    View<const double> basis(Index chart) const { return {bases_.data() + 2 * chart * n_, n_, 2}; }
    double radius(Index chart) const { return radii_[chart]; }
    bool is_clear(Index chart) const { return are_clear_[chart]; }
    const ConvexPolygon& polygon(Index chart) const { return polygons_[chart]; }

    // The charts that overlap a disk in a plane ``basis`` (n, 2) about ``center`` (n), or lie above it.
    std::vector<Overlap> overlaps(Vector<const double> center, View<const double> basis, double radius) {
        std::vector<Overlap> found;
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
    void add(Vector<const double> center, View<const double> basis, double radius, bool is_clear, ConvexPolygon polygon,
             const std::vector<Overlap>& overlaps) {
        const Index number = count();
        for (const Overlap& other : overlaps) {
            cut(polygon, radius, other.position, other.height, radii_[other.number], other.number);
            const auto [position, height] = gap(center, this->center(other.number), this->basis(other.number));
            cut(polygons_[other.number], radii_[other.number], position, height, radius, number);
            open_.push_back(other.number);
        }
        centers_.insert(centers_.end(), center.begin(), center.end());
        bases_.insert(bases_.end(), basis.data, basis.data + 2 * n_);
        radii_.push_back(radius);
        are_clear_.push_back(is_clear);
        polygons_.push_back(std::move(polygon));
        dead_ends_.emplace_back();
        open_.push_back(number);
    }

    // A chart of which the polygon is open, and the unit vector to the vertex farthest outside its disk, in no
    // direction that is a dead end; none where all are closed.
    std::optional<std::pair<Index, std::array<double, 2>>> next_open() {
        while (!open_.empty()) {
            const Index chart = open_.front();
            if (const auto direction = open_direction(chart)) return std::pair{chart, *direction};
            open_.pop_front();
        }
        return {};
    }

    // Whether a polygon has a vertex in a direction, outside the disk by more than a share of the radius.
    bool is_open_towards(Index chart, const std::array<double, 2>& direction, double share) const {
        const auto& vertices = polygons_[chart].vertices;
        return std::any_of(vertices.begin(), vertices.end(), [&](const std::array<double, 2>& vertex) {
            const double size = std::hypot(vertex[0], vertex[1]);
            return is_towards(vertex, direction, size) && size > (1.0 + share) * radii_[chart];
        });
    }

    // Where a point lies in a plane about another one, and how high above it.
    Place gap(Vector<const double> point, Vector<const double> from, View<const double> basis) {
        squared_distance(point, from, std::numeric_limits<double>::infinity());
        return place(basis);
    }

    // No other chart can be made from this one in a direction.
    void add_dead_end(Index chart, const std::array<double, 2>& direction) { dead_ends_[chart].push_back(direction); }

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
        Place out{{0.0, 0.0}, 0.0};
        for (Index j = 0; j < n_; ++j) {
            out.position[0] += offset_[j] * basis(j, 0);
            out.position[1] += offset_[j] * basis(j, 1);
        }
        double square = 0.0;
        for (Index j = 0; j < n_; ++j) {
            const double above = offset_[j] - basis(j, 0) * out.position[0] - basis(j, 1) * out.position[1];
            square += above * above;
        }
        out.height = std::sqrt(square);
        return out;
    }

    // The smaller singular value of one^T other.
    double smallest_cosine(View<const double> one, View<const double> other) const {
        double a = 0.0, b = 0.0, c = 0.0, d = 0.0;
        for (Index j = 0; j < n_; ++j) {
            a += one(j, 0) * other(j, 0);
            b += one(j, 0) * other(j, 1);
            c += one(j, 1) * other(j, 0);
            d += one(j, 1) * other(j, 1);
        }
        return 0.5 * std::abs(std::hypot(a + d, b - c) - std::hypot(a - d, b + c));
    }

    // Cuts a polygon where its disk intersects another one, whose centre lies at a height. In the formula of
    // Henderson (2002) the distance in the plane is corrected for the bend of the surface.
    static void cut(ConvexPolygon& polygon, double radius, const std::array<double, 2>& position, double height,
                    double other_radius, Index label) {
        const double distance = std::hypot(position[0], position[1]);
        if (distance == 0.0) return;
        const double bent = distance * distance + 0.5 * height * height;
        const double offset = (bent + radius * radius - other_radius * other_radius) / (2.0 * distance);
        polygon.clip({position[0] / distance, position[1] / distance}, offset, label);
    }

    std::optional<std::array<double, 2>> open_direction(Index chart) const {
        double farthest = radii_[chart] * (1.0 + limits_.on_disk);
        std::optional<std::array<double, 2>> found;
        for (const auto& vertex : polygons_[chart].vertices) {
            const double size = std::hypot(vertex[0], vertex[1]);
            if (!(size > farthest) || is_dead_end(chart, vertex, size)) continue;
            farthest = size;
            found = {vertex[0] / size, vertex[1] / size};
        }
        return found;
    }

    bool is_dead_end(Index chart, const std::array<double, 2>& vertex, double size) const {
        const auto& directions = dead_ends_[chart];
        return std::any_of(directions.begin(), directions.end(), [&](const std::array<double, 2>& direction) {
            return is_towards(vertex, direction, size);
        });
    }

    bool is_towards(const std::array<double, 2>& vertex, const std::array<double, 2>& direction, double size) const {
        return vertex[0] * direction[0] + vertex[1] * direction[1] >= limits_.towards * size;
    }

    Index n_;
    std::vector<double> periods_;
    FrontLimits limits_;
    std::vector<double> centers_, bases_, radii_, offset_;
    std::vector<bool> are_clear_;  // where no other sheet is near
    std::vector<ConvexPolygon> polygons_;
    std::vector<std::vector<std::array<double, 2>>> dead_ends_;
    std::deque<Index> open_;  // charts whose polygons may be open
};

}  // namespace bifurc
