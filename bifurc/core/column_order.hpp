// In which order the columns of a sparse matrix are eliminated, and what that fills.
#pragma once

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "bifurc/core/arrays.hpp"

namespace bifurc {

// Where a matrix has entries, by rows: those of row i are ``entries[starts[i]]`` and so on, the
// numbers of their columns.
struct SparsityPattern {
    Index columns;
    std::vector<Index> starts, entries;

    Index rows() const { return static_cast<Index>(starts.size()) - 1; }
    Vector<const Index> row(Index number) const {
        return {entries.data() + starts[number], entries.data() + starts[number + 1]};
    }
};

// An order of elimination in which the triangle R of a QR factorisation has few entries: always
// the column next that has the fewest others beside it in its rows (minimum degree on A^T A;
// Tinney and Walker 1967). What is eliminated joins its neighbours to each other.
class ColumnOrder {
public:
    explicit ColumnOrder(const SparsityPattern& pattern) : places_(pattern.columns, -1) {
        std::vector<std::vector<Index>> beside = neighbours(pattern);
        std::set<std::pair<std::size_t, Index>> left;  // columns, by the number of their neighbours
        for (Index column = 0; column < pattern.columns; ++column) left.emplace(beside[column].size(), column);
        for (Index place = 0; place < pattern.columns; ++place) {
            const Index column = left.begin()->second;
            left.erase(left.begin());
            places_[column] = place;
            columns_.push_back(column);
            for (Index other : beside[column]) {
                left.erase({beside[other].size(), other});
                join(beside[other], beside[column], column, other);
                left.emplace(beside[other].size(), other);
            }
            rows_.push_back(std::move(beside[column]));
        }
        for (std::vector<Index>& row : rows_) {
            for (Index& column : row) column = places_[column];
            std::sort(row.begin(), row.end());
        }
    }

    Index size() const { return static_cast<Index>(columns_.size()); }
    // The column that is eliminated at a place.
    Index column(Index place) const { return columns_[place]; }
    // The place at which a column is eliminated.
    Index place(Index column) const { return places_[column]; }
    // The places at which the row of R at a place has entries beside its diagonal, in order.
    const std::vector<Index>& row(Index place) const { return rows_[place]; }

private:
    static std::vector<std::vector<Index>> neighbours(const SparsityPattern& pattern) {
        std::vector<std::vector<Index>> beside(pattern.columns);
        for (Index row = 0; row < pattern.rows(); ++row) {
            for (Index column : pattern.row(row)) {
                for (Index other : pattern.row(row)) {
                    if (other != column) beside[column].push_back(other);
                }
            }
        }
        for (std::vector<Index>& others : beside) {
            std::sort(others.begin(), others.end());
            others.erase(std::unique(others.begin(), others.end()), others.end());
        }
        return beside;
    }

    // The neighbours of a column take the place of it, ``eliminated``, among those of another one, ``self``.
    static void join(std::vector<Index>& mine, const std::vector<Index>& others, Index eliminated, Index self) {
        std::vector<Index> all;
        std::set_union(mine.begin(), mine.end(), others.begin(), others.end(), std::back_inserter(all));
        std::erase_if(all, [&](Index column) { return column == eliminated || column == self; });
        mine = std::move(all);
    }

    std::vector<Index> places_, columns_;
    std::vector<std::vector<Index>> rows_;
};

// The pattern of a matrix and the order of its columns, which is made when it is first asked for: not for two
// threads at once.
class Sparsity {
public:
    explicit Sparsity(SparsityPattern entries) : pattern(std::move(entries)) {}

    const ColumnOrder& order() const {
        if (!order_) order_.emplace(pattern);
        return *order_;
    }

    const SparsityPattern pattern;

private:
    mutable std::optional<ColumnOrder> order_;
};

}  // namespace bifurc
