// The mixed cells of a regular mixed subdivision of n supports in n directions.
//
// A cell has a pair of points of each support, and a vector at which these two are the lowest of their
// support: each point with its lift plus the product with that vector. Together the cells have as many
// volume as polynomials with these supports and generic coefficients have solutions without zeros
// (Bernstein 1975; Huber and Sturmfels 1995). They are followed while lifts change, one support after the
// other, from those of simplices, of which there is one (tropical homotopies: Jensen 2016).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <utility>
#include <vector>

#include "bifurc/core/arrays.hpp"
#include "bifurc/core/deadline.hpp"

namespace bifurc {

namespace cells {

constexpr double meeting = 1e-10;               // lifts at which two points come low that count as one
constexpr std::int64_t largest = 1 << 30;       // of the numbers with which a cell is known
constexpr std::int64_t passing = 100;           // times the volume allowed: while some supports are simplices

}  // namespace cells

// Of n pairs of points, by their numbers, from ``first`` to ``second``: the ``volume`` of the edges between
// them, as rows of a matrix, and its inverse times that volume.
struct MixedCell {
    std::vector<Index> first, second;
    std::int64_t volume;
    Matrix<std::int64_t> inverse;
};

// How an enumeration ended.
enum class CellsEnd { all = 0, not_generic = 1, too_large = 2, out_of_time = 3 };

class MixedCells {
public:
    // ``exponents`` (t, n) of all supports, one after the other of these ``sizes`` (n); ``lifts`` of these,
    // and n (n + 1) others, all generic and from 0 to 1. No more is looked for than a volume of ``most``.
    MixedCells(View<const std::int64_t> exponents, Vector<const std::int64_t> sizes, Vector<const double> lifts,
               std::int64_t most, Deadline& deadline)
        : n_(exponents.columns), most_(most), edge_(n_) {
        start(lifts.subspan(exponents.rows));
        Index from = 0;
        for (Index row = 0; row < n_ && end_ == CellsEnd::all; ++row) {
            const auto size = static_cast<Index>(sizes[row]);
            lower(row, {exponents.data + from * n_, size, n_}, lifts.subspan(from, size), deadline);
            from += size;
        }
    }

    CellsEnd end() const { return end_; }
    const std::vector<MixedCell>& cells() const { return cells_; }

    // By how much each of all points is higher than the two lowest of its support, at a cell.
    void heights(const MixedCell& cell, Vector<double> out) {
        auto next = out.begin();
        for (Index row = 0; row < n_; ++row) {
            for (Index point = 0; point < supports_[row].points.rows(); ++point) {
                const bool is_lowest = point == cell.first[row] || point == cell.second[row];
                expand(cell, row, point);
                *next++ = is_lowest ? 0.0 : height(cell, row, point) / static_cast<double>(cell.volume);
            }
        }
    }

private:
    struct Support {
        Matrix<std::int64_t> points;
        std::vector<double> lifts;
    };

    // A point that comes as low as a pair of its support.
    struct Event {
        double when = std::numeric_limits<double>::infinity();
        Index row = 0, point = 0;
    };

    // Simplices with lifts of which one pair each is low: 0 and the unit of its own direction.
    void start(Vector<const double> lifts) {
        MixedCell cell{std::vector<Index>(n_, 0), std::vector<Index>(n_), 1, Matrix<std::int64_t>(n_, n_)};
        for (Index row = 0; row < n_; ++row) {
            Support simplex{Matrix<std::int64_t>(n_ + 1, n_), std::vector<double>(n_ + 1)};
            for (Index j = 0; j < n_; ++j) {
                simplex.points(j + 1, j) = 1;
                simplex.lifts[j + 1] = lifts[row * (n_ + 1) + j + 1] + (j == row ? 0.0 : 1.0);
            }
            supports_.push_back(std::move(simplex));
            cell.second[row] = row + 1;
            cell.inverse(row, row) = 1;
        }
        cells_.push_back(std::move(cell));
    }

    // The cells once the support of a row is that of its polynomial instead of a simplex: its points, at first
    // far above a simplex that has them inside, come down until they are far below.
    void lower(Index row, View<const std::int64_t> points, Vector<const double> lifts, Deadline& deadline) {
        own_row_ = row;
        own_ = points.rows;
        std::int64_t degree = 0;
        Support both{Matrix<std::int64_t>(own_ + n_ + 1, n_), {lifts.begin(), lifts.end()}};
        for (Index point = 0; point < own_; ++point) {
            std::int64_t total = 0;
            for (Index j = 0; j < n_; ++j) total += both.points(point, j) = points(point, j);
            degree = std::max(degree, total);
        }
        for (Index j = 0; j < n_; ++j) both.points(own_ + j + 1, j) = degree;
        for (double lift : supports_[row].lifts) both.lifts.push_back(static_cast<double>(degree) * lift);
        supports_[row] = std::move(both);
        if (!degree) cells_.clear();
        std::vector<MixedCell> open;
        for (MixedCell& cell : cells_) {
            cell.first[row] += own_;
            cell.second[row] += own_;
            cell.volume *= degree;
            for (Index i = 0; i < n_; ++i) {
                for (Index j = 0; j < n_; ++j) {
                    if (j != row) cell.inverse(i, j) *= degree;
                }
            }
            open.push_back(std::move(cell));
        }
        cells_.clear();
        std::int64_t volume = 0;
        while (!open.empty() && end_ == CellsEnd::all) {
            MixedCell cell = std::move(open.back());
            open.pop_back();
            if (is_own(cell.first[row]) && is_own(cell.second[row])) {
                volume += cell.volume;
                if (volume > (row + 1 < n_ ? cells::passing * most_ : most_)) end_ = CellsEnd::too_large;
                cells_.push_back(std::move(cell));
                continue;
            }
            if (deadline.has_passed()) end_ = CellsEnd::out_of_time;
            const Event event = next(cell);
            if (std::isfinite(event.when)) pass(cell, event, open);
        }
        Support& support = supports_[row];
        Matrix<std::int64_t> kept(own_, n_);
        std::copy(points.data, points.data + own_ * n_, kept.view().data);
        support.points = std::move(kept);
        support.lifts.resize(own_);
    }

    bool is_own(Index point) const { return point < own_; }

    // The edge from the first point of a row to another one, in terms of the edges of a cell times its volume:
    // in ``edge_``.
    void expand(const MixedCell& cell, Index row, Index point) {
        std::fill(edge_.begin(), edge_.end(), 0);
        const Matrix<std::int64_t>& points = supports_[row].points;
        for (Index i = 0; i < n_; ++i) {
            const std::int64_t step = points(point, i) - points(cell.first[row], i);
            if (!step) continue;
            for (Index j = 0; j < n_; ++j) edge_[j] += step * cell.inverse(i, j);
        }
    }

    // How much higher that point is, times the volume, before anything has come down.
    double height(const MixedCell& cell, Index row, Index point) const {
        const std::vector<double>& lifts = supports_[row].lifts;
        double total = static_cast<double>(cell.volume) * (lifts[point] - lifts[cell.first[row]]);
        for (Index j = 0; j < n_; ++j) {
            if (!edge_[j]) continue;
            const std::vector<double>& others = supports_[j].lifts;
            total += static_cast<double>(edge_[j]) * (others[cell.first[j]] - others[cell.second[j]]);
        }
        return total;
    }

    // By how much it comes down, times the volume, while the own points of the row come down by 1.
    std::int64_t descent(const MixedCell& cell, Index row, Index point) const {
        const Index first = cell.first[own_row_], second = cell.second[own_row_];
        std::int64_t total = edge_[own_row_] * (is_own(first) - is_own(second));
        if (row == own_row_) total += cell.volume * (is_own(point) - is_own(first));
        return total;
    }

    // Which point comes first as low as a pair.
    Event next(const MixedCell& cell) {
        Event event;
        double second = std::numeric_limits<double>::infinity();
        for (Index row = 0; row < n_; ++row) {
            for (Index point = 0; point < supports_[row].points.rows(); ++point) {
                if (point == cell.first[row] || point == cell.second[row]) continue;
                expand(cell, row, point);
                const std::int64_t down = descent(cell, row, point);
                if (down <= 0) continue;
                const double when = height(cell, row, point) / static_cast<double>(down);
                if (when < event.when) {
                    second = event.when;
                    event = {when, row, point};
                } else {
                    second = std::min(second, when);
                }
            }
        }
        if (second - event.when < cells::meeting) end_ = CellsEnd::not_generic;
        return event;
    }

    // The cells that follow on one. Where two are followed by one, it follows on that which has the lower
    // number of its two points.
    void pass(const MixedCell& cell, const Event& event, std::vector<MixedCell>& open) {
        const Index row = event.row, point = event.point;
        expand(cell, row, point);
        const std::int64_t share = edge_[row];
        const Index first = cell.first[row], second = cell.second[row];
        if (share > 0 && (share <= cell.volume || first < point)) open.push_back(exchanged(cell, row, point));
        if (share < cell.volume && (share >= 0 || second < point)) {
            MixedCell reversed = cell;
            reverse(reversed, row);
            for (std::int64_t& entry : edge_) entry = -entry;
            edge_[row] = reversed.volume - edge_[row];
            open.push_back(exchanged(reversed, row, point));
        }
    }

    // A cell with its pair of a row from the other end.
    void reverse(MixedCell& cell, Index row) const {
        std::swap(cell.first[row], cell.second[row]);
        cell.volume = -cell.volume;
        for (Index i = 0; i < n_; ++i) {
            for (Index j = 0; j < n_; ++j) {
                if (j != row) cell.inverse(i, j) = -cell.inverse(i, j);
            }
        }
    }

    // A cell with another second point of a row, the edge to which is in ``edge_``.
    MixedCell exchanged(const MixedCell& cell, Index row, Index point) {
        MixedCell out = cell;
        out.second[row] = point;
        out.volume = edge_[row];
        for (Index i = 0; i < n_; ++i) {
            for (Index j = 0; j < n_; ++j) {
                if (j == row) continue;
                out.inverse(i, j) = (edge_[row] * cell.inverse(i, j) - edge_[j] * cell.inverse(i, row)) / cell.volume;
                if (std::abs(out.inverse(i, j)) > cells::largest) end_ = CellsEnd::too_large;
            }
        }
        if (out.volume < 0) reverse(out, row);
        return out;
    }

    Index n_;
    std::int64_t most_;
    Index own_row_ = 0, own_ = 0;
    CellsEnd end_ = CellsEnd::all;
    std::vector<Support> supports_;
    std::vector<MixedCell> cells_;
    std::vector<std::int64_t> edge_;
};

}  // namespace bifurc
