// Convex cells about the centres of charts, in the coordinates of their tangent spaces: polygons, and polytopes of more
// dimensions. Each starts around a ball, and half-spaces cut it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "bifurc/core/arrays.hpp"

namespace bifurc {

// A convex polygon about the origin of the plane of a chart: vertices (x, y), counterclockwise, and what made
// each edge, which runs from the vertex of that number to the next one.
struct ConvexPolygon {
    std::vector<std::array<double, 2>> vertices;
    std::vector<Index> labels;

    // The octagon around a circle, which nothing has cut yet.
    static ConvexPolygon around(double radius) {
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

// A convex polytope of ``d`` dimensions about the origin: vertices, the numbers in ascending order of the d facets that
// meet at each, and what made every facet. Where more than d meet in a place, several vertices lie there.
template <Index d>
struct ConvexPolytope {
    using Position = std::array<double, d>;

    std::vector<Position> vertices;
    std::vector<std::array<Index, d>> facets;
    std::vector<Index> labels;

    static constexpr Index outline = -1;  // label of a facet that nothing has cut yet

    // The cube around a ball, turned so that its facets are parallel to no plane of coordinates: centres of charts often
    // lie in these.
    static ConvexPolytope around(double radius) {
        ConvexPolytope out;
        out.labels.assign(2 * d, outline);
        for (Index corner = 0; corner < (Index{1} << d); ++corner) {
            Position at;
            std::array<Index, d> sides;
            for (Index j = 0; j < d; ++j) {
                const Index side = (corner >> j) & 1;
                at[j] = side ? radius : -radius;
                sides[j] = 2 * j + side;
            }
            for (Index j = 0; j < d; ++j) {
                for (Index k = j + 1; k < d; ++k) {
                    const double before = at[j], c = std::cos(1.0), s = std::sin(1.0);
                    at[j] = c * before - s * at[k];
                    at[k] = s * before + c * at[k];
                }
            }
            out.vertices.push_back(at);
            out.facets.push_back(sides);
        }
        return out;
    }

    // Cuts off what is not normal . y <= offset; the facet along the cut gets ``label``.
    void clip(const Position& normal, double offset, Index label) {
        const std::size_t count = vertices.size();
        heights_.resize(count);
        for (std::size_t i = 0; i < count; ++i) heights_[i] = dot(vertices[i], normal) - offset;
        if (std::none_of(heights_.begin(), heights_.end(), [](double height) { return height > 0.0; })) return;
        find_edges_of_cut();
        const auto number = static_cast<Index>(labels.size());
        labels.push_back(label);
        ConvexPolytope rest;
        for (std::size_t inside = 0; inside < count; ++inside) {
            if (heights_[inside] > 0.0) continue;
            rest.vertices.push_back(vertices[inside]);
            rest.facets.push_back(facets[inside]);
            if (has_far_facets(inside)) continue;
            for (Index omitted = 0; omitted < d; ++omitted) {
                const Edge edge{edge_at(inside, omitted), 0};
                const auto other = std::lower_bound(edges_.begin(), edges_.end(), edge);
                if (other == edges_.end() || other->first != edge.first) continue;
                rest.vertices.push_back(crossing(inside, other->second));
                rest.facets.push_back(facets[inside]);
                std::array<Index, d>& own = rest.facets.back();
                std::copy(own.begin() + omitted + 1, own.end(), own.begin() + omitted);
                own[d - 1] = number;
            }
        }
        vertices.swap(rest.vertices);
        facets.swap(rest.facets);
    }

    // The labels of the facets that are left, each once, in ascending order.
    std::vector<Index> labels_of_facets() const {
        std::vector<Index> out;
        for (const auto& own : facets) {
            for (const Index facet : own) out.push_back(labels[facet]);
        }
        std::sort(out.begin(), out.end());
        out.erase(std::unique(out.begin(), out.end()), out.end());
        return out;
    }

private:
    // An edge by the d - 1 facets that meet in it, 16 bits each, and a vertex at its end.
    using Edge = std::pair<std::uint64_t, std::size_t>;
    static_assert(d <= 5);

    std::uint64_t edge_at(std::size_t vertex, Index omitted) const {
        std::uint64_t key = 0;
        for (Index j = 0; j < d; ++j) {
            if (j != omitted) key = key << 16 | static_cast<std::uint64_t>(facets[vertex][j]);
        }
        return key;
    }

    // The edges at vertices that are cut off, and the facets that these are on.
    void find_edges_of_cut() {
        edges_.clear();
        are_near_.assign(labels.size(), false);
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            if (!(heights_[i] > 0.0)) continue;
            for (Index j = 0; j < d; ++j) {
                are_near_[facets[i][j]] = true;
                edges_.emplace_back(edge_at(i, j), i);
            }
        }
        std::sort(edges_.begin(), edges_.end());
    }

    // Whether a vertex is on two facets or more that no vertex that is cut off is on: no edge leads to one.
    bool has_far_facets(std::size_t vertex) const {
        const auto& own = facets[vertex];
        return std::count_if(own.begin(), own.end(), [&](Index facet) { return !are_near_[facet]; }) > 1;
    }

    // The point of an edge on the plane of the cut.
    Position crossing(std::size_t inside, std::size_t outside) const {
        const double share = heights_[inside] / (heights_[inside] - heights_[outside]);
        Position point = vertices[inside];
        for (Index j = 0; j < d; ++j) point[j] += share * (vertices[outside][j] - point[j]);
        return point;
    }

    std::vector<double> heights_;
    std::vector<Edge> edges_;
    std::vector<bool> are_near_;  // facets
};

}  // namespace bifurc
