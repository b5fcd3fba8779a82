// Systems of many small blocks of equations that hang together, each of which leaves one freedom to
// its unknowns, as every vertex of a sheet does that four creases meet at.
//
// Then one unknown gives all: a block that has a known one gives its others, and so on along a tree,
// over those blocks first in which what is known is not small beside the others (Prim 1957), and of those
// over the nearest to the root, as rounding adds up along the way. The
// equations that the tree does not need are those which say that all blocks agree. Time and memory go
// with the number of blocks, whatever the pattern is, where factors of the whole matrix fill.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <tuple>
#include <vector>

#include "bifurc/core/arrays.hpp"
#include "bifurc/core/column_order.hpp"

namespace bifurc {

class BlockTree {
public:
    // The rows that follow each other with no unknowns but those of one of them are a block.
    explicit BlockTree(const SparsityPattern& pattern) : pattern_(pattern), beside_(pattern.columns) {
        for (Index row = 0; row < pattern.rows(); ++row) {
            if (blocks_.empty() || !takes(blocks_.back(), row)) blocks_.push_back(Block{row});
            add(blocks_.back(), row);
        }
        for (Index block = 0; block < size(); ++block) {
            const std::vector<Index>& columns = blocks_[block].columns;
            for (Index k = 0; k < std::ssize(columns); ++k) beside_[columns[k]].push_back({0, 0, block, k});
        }
    }

    // Whether there are equations enough in every block that it leaves one freedom at most.
    bool may_hold() const {
        const auto leaves_one = [](const Block& block) { return block.rows + 1 >= block.width(); };
        return std::all_of(blocks_.begin(), blocks_.end(), leaves_one);
    }

    // Solves all blocks of the matrix with these entries and joins them from the column ``root`` on. False where a
    // block leaves no freedom or more than one, and where they do not hang together.
    bool factor(Vector<const double> entries, Index root) {
        for (Block& block : blocks_) {
            if (!solve_block(block, entries)) return false;
        }
        return join(root);
    }

    // The solution (columns) for a right-hand side (rows) in which the unknown at the root is ``at_root``.
    void solve(Vector<const double> right, double at_root, Vector<double> solution) const {
        solution[root_] = at_root;
        for (const Branch& branch : branches_) {
            const Block& block = blocks_[branch.block];
            const Vector<const double> own = right.subspan(block.first, block.rows);
            const double given = solution[block.columns[branch.entry]];
            const double along = (given - block.particular(branch.entry, own)) / block.null[branch.entry];
            for (Index k = branch.begin; k < branch.end; ++k) {
                const Index entry = reached_[k];
                solution[block.columns[entry]] = block.particular(entry, own) + along * block.null[entry];
            }
        }
    }

    // The transpose of that with nothing at the root: from a vector (columns), which is overwritten, to one (rows).
    void solve_transposed(Vector<double> vector, Vector<double> out) const {
        std::fill(out.begin(), out.end(), 0.0);
        for (auto branch = branches_.rbegin(); branch != branches_.rend(); ++branch) {
            const Block& block = blocks_[branch->block];
            const Vector<double> own = out.subspan(block.first, block.rows);
            double along = 0.0;
            for (Index k = branch->begin; k < branch->end; ++k) {
                const Index entry = reached_[k];
                const double value = vector[block.columns[entry]];
                block.add_transposed(entry, value, own);
                along += value * block.null[entry];
            }
            along /= block.null[branch->entry];
            block.add_transposed(branch->entry, -along, own);
            vector[block.columns[branch->entry]] += along;
        }
    }

private:
    static constexpr double small = 16.0;  // times the largest unknown of a block is larger
    static constexpr double beyond = 1e12;  // the same from which on nothing follows from an unknown
    static constexpr double negligible = 1e-12;  // a pivot, over the largest of its block
    static constexpr double disagreement = 1e-2;  // the same of what equations leave that a block does not need

    struct Block {
        Index first, rows = 0;
        std::vector<Index> columns = {};
        // unknowns (width) of a right-hand side (rows) are ``inverse`` (width, rows) times it, and any multiple of
        // ``null`` (width) besides
        std::vector<double> inverse = {}, null = {};

        Index width() const { return static_cast<Index>(columns.size()); }
        double particular(Index entry, Vector<const double> right) const {
            double total = 0.0;
            for (Index i = 0; i < rows; ++i) total += inverse[entry * rows + i] * right[i];
            return total;
        }
        void add_transposed(Index entry, double value, Vector<double> to) const {
            for (Index i = 0; i < rows; ++i) to[i] += inverse[entry * rows + i] * value;
        }
    };

    // An unknown, number ``entry`` of a block; how many times it is smaller in the freedom of it than the largest one,
    // as a power of ``small``, and how many blocks it is from the root.
    struct Place {
        Index smallness, depth, block, entry;

        bool operator>(const Place& other) const {
            return std::tie(smallness, depth, block) > std::tie(other.smallness, other.depth, other.block);
        }
    };

    // A block, and its unknown from which those that are ``reached_`` from ``begin`` on follow.
    struct Branch {
        Index block, entry, begin, end;
    };

    Index size() const { return static_cast<Index>(blocks_.size()); }

    bool takes(const Block& block, Index row) const {
        const auto columns = pattern_.row(row);
        const auto& own = block.columns;
        return std::includes(own.begin(), own.end(), columns.begin(), columns.end()) ||
               std::includes(columns.begin(), columns.end(), own.begin(), own.end());
    }

    void add(Block& block, Index row) {
        const auto columns = pattern_.row(row);
        ++block.rows;
        if (columns.size() > block.columns.size()) block.columns.assign(columns.begin(), columns.end());
    }

    // Gauss and Jordan's elimination with complete pivoting, the unit matrix beside.
    bool solve_block(Block& block, Vector<const double> entries) {
        const Index width = block.width(), rows = block.rows;
        Matrix<double> matrix(rows, width + rows);
        for (Index i = 0; i < rows; ++i) {
            const Index row = block.first + i;
            for (Index entry = pattern_.starts[row]; entry < pattern_.starts[row + 1]; ++entry) {
                const auto at = std::lower_bound(block.columns.begin(), block.columns.end(), pattern_.entries[entry]);
                matrix(i, at - block.columns.begin()) = entries[entry];
            }
            matrix(i, width + i) = 1.0;
        }
        std::vector<Index> row_of(width, -1);
        std::vector<bool> is_used(rows, false);
        double largest = 0.0;
        for (Index step = 0; step < width; ++step) {
            Index row = -1, column = -1;
            double pivot = 0.0;
            for (Index i = 0; i < rows; ++i) {
                if (is_used[i]) continue;
                for (Index j = 0; j < width; ++j) {
                    if (row_of[j] >= 0 || !(std::abs(matrix(i, j)) > pivot)) continue;
                    pivot = std::abs(matrix(i, j));
                    row = i;
                    column = j;
                }
            }
            largest = std::max(largest, pivot);
            if (step == width - 1) {
                if (pivot > disagreement * largest) return false;
                break;
            }
            if (!(pivot > negligible * largest)) return false;
            eliminate(matrix, row, column);
            row_of[column] = row;
            is_used[row] = true;
        }
        const Index free = std::find(row_of.begin(), row_of.end(), -1) - row_of.begin();
        block.inverse.assign(width * rows, 0.0);
        block.null.assign(width, 1.0);
        for (Index j = 0; j < width; ++j) {
            if (j == free) continue;
            block.null[j] = -matrix(row_of[j], free);
            for (Index i = 0; i < rows; ++i) block.inverse[j * rows + i] = matrix(row_of[j], width + i);
        }
        return true;
    }

    static void eliminate(Matrix<double>& matrix, Index row, Index column) {
        const double pivot = matrix(row, column);
        for (double& entry : matrix.row(row)) entry /= pivot;
        for (Index i = 0; i < matrix.rows(); ++i) {
            const double factor = matrix(i, column);
            if (i == row || factor == 0.0) continue;
            for (Index j = 0; j < matrix.columns(); ++j) matrix(i, j) -= factor * matrix(row, j);
        }
    }

    bool join(Index root) {
        root_ = root;
        branches_.clear();
        reached_.clear();
        std::vector<bool> is_known(pattern_.columns, false);
        std::priority_queue<Place, std::vector<Place>, std::greater<>> waiting;
        const auto reach = [&](Index column, Index depth) {
            is_known[column] = true;
            for (Place place : beside_[column]) {
                const Block& block = blocks_[place.block];
                double most = 0.0;
                for (double entry : block.null) most = std::max(most, std::abs(entry));
                const double times = most / std::abs(block.null[place.entry]);
                if (!(times < beyond)) continue;
                place.smallness = static_cast<Index>(std::log(times) / std::log(small));
                place.depth = depth;
                waiting.push(place);
            }
        };
        reach(root, 0);
        while (!waiting.empty()) {
            const Place place = waiting.top();
            waiting.pop();
            const Index begin = static_cast<Index>(reached_.size());
            const Block& block = blocks_[place.block];
            for (Index k = 0; k < block.width(); ++k) {
                if (!is_known[block.columns[k]]) reached_.push_back(k);
            }
            const Index end = static_cast<Index>(reached_.size());
            if (begin == end) continue;
            branches_.push_back({place.block, place.entry, begin, end});
            for (Index k = begin; k < end; ++k) reach(block.columns[reached_[k]], place.depth + 1);
        }
        return static_cast<Index>(reached_.size()) + 1 == pattern_.columns;
    }

    const SparsityPattern& pattern_;
    std::vector<Block> blocks_;
    std::vector<std::vector<Place>> beside_;  // of every column its places in blocks
    std::vector<Branch> branches_;
    std::vector<Index> reached_;
    Index root_ = 0;
};

}  // namespace bifurc
