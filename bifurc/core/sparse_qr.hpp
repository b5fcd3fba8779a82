// Least-squares problems with sparse matrices of one pattern: QR by fronts.
//
// Multifrontal QR (Liu 1986; Matstoms 1994): a front for every column holds the rows that begin
// there, and what the fronts before it leave. All of it is made triangular by Householder
// reflections; the first row is one of R, the others go on to the front of the next column in
// which they have entries. So redundant equations end where the last of them is needed, and the
// matrix need neither be square nor have its independent rows chosen. All arithmetic is here,
// so that every processor makes the same of it.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "bifurc/core/arrays.hpp"
#include "bifurc/core/column_order.hpp"

namespace bifurc {

// A row with a single entry under those of the pattern.
struct SingleEntry {
    Index column;
    double value;
};

class SparseQr {
public:
    explicit SparseQr(const Sparsity& sparsity)
        : pattern_(sparsity.pattern),
          order_(sparsity.order()),
          fronts_(order_.size()),
          solution_(order_.size()) {
        for (Index place = 0; place < order_.size(); ++place) {
            const std::vector<Index>& others = order_.row(place);
            Front& front = fronts_[place];
            front.columns.push_back(place);
            front.columns.insert(front.columns.end(), others.begin(), others.end());
        }
        for (Index place = 0; place < order_.size(); ++place) {
            if (fronts_[place].columns.size() > 1) set_parent(place);
        }
        for (Index row = 0; row < pattern_.rows(); ++row) {
            const auto columns = pattern_.row(row);
            if (!columns.empty()) fronts_[first_place(columns)].own.push_back(row);
        }
    }

    // Factors the matrix with these entries, in the order of the pattern, and ``below`` it rows of
    // a single entry.
    void factor(Vector<const double> entries, Vector<const SingleEntry> below) {
        arrange(below);
        for (Front& front : fronts_) {
            std::fill(front.values.begin(), front.values.end(), 0.0);
            fill_own(front, entries, below);
            for (Index child : front.children) fill_from(fronts_[child], front);
            triangularise(front);
        }
    }

    // The least-squares solution (columns) for a right-hand side (rows, with those below), which is
    // overwritten. Unknowns without a pivot are 0.
    void solve(Vector<double> right, Vector<double> solution) const {
        for (const Front& front : fronts_) reflect(front, right);
        for (const Front& front : fronts_) {
            solution_[front.columns[0]] = front.has_pivot() ? right[front.rows[0]] : 0.0;
        }
        solve_upper(solution_);
        for (Index place = 0; place < order_.size(); ++place) solution[order_.column(place)] = solution_[place];
    }

    // Overwrites a vector by R^-1 R^-T of it; false where R is singular. The vector is in the order of
    // elimination.
    bool solve_normal(Vector<double> vector) const {
        for (const Front& front : fronts_) {
            if (!front.is_regular()) return false;
            const double value = vector[front.columns[0]] /= front.values[0];
            for (Index j = 1; j < front.width(); ++j) vector[front.columns[j]] -= front.values[j] * value;
        }
        solve_upper(vector);
        return true;
    }

private:
    struct Front {
        std::vector<Index> columns;    // places of its columns, its own one first
        std::vector<Index> children;   // fronts that leave rows to it
        std::vector<Index> to_parent;  // its columns as those of the front that follows
        std::vector<Index> own;        // rows of the pattern that begin here
        std::vector<Index> single;     // rows below
        std::vector<Index> rows;       // numbers of all its rows in right-hand sides, by their first column
        std::vector<Index> places;     // where in ``rows`` those stand that come in, in the order of coming
        std::vector<Index> ends;       // for every column the number of rows that begin at it or before
        std::vector<Index> leads;      // the columns with a pivot
        std::vector<double> values;    // (rows, columns): R, and reflectors below it
        std::vector<double> scales;    // of the reflectors

        Index width() const { return static_cast<Index>(columns.size()); }
        bool has_pivot() const { return !leads.empty() && leads[0] == 0; }
        bool is_regular() const { return has_pivot() && values[0] != 0.0; }
        // The first row that goes on.
        Index first_left() const { return has_pivot() ? 1 : 0; }
        double* row(Index number) { return values.data() + number * width(); }
        const double* row(Index number) const { return values.data() + number * width(); }
    };

    Index first_place(Vector<const Index> columns) const {
        Index first = order_.size();
        for (Index column : columns) first = std::min(first, order_.place(column));
        return first;
    }

    // Its entries beside the diagonal are those of the front at the first of them as well.
    void set_parent(Index place) {
        Front& front = fronts_[place];
        Front& parent = fronts_[front.columns[1]];
        parent.children.push_back(place);
        front.to_parent.push_back(-1);
        for (Index j = 1; j < front.width(); ++j) front.to_parent.push_back(local(parent, front.columns[j]));
    }

    static Index local(const Front& front, Index place) {
        const auto found = std::lower_bound(front.columns.begin(), front.columns.end(), place);
        return found - front.columns.begin();
    }

    // --- where rows stand -------------------------------------------------------------------------

    // Rows, stairs and pivots of all fronts; as before where the rows below are in the same columns.
    void arrange(Vector<const SingleEntry> below) {
        const auto is_same = [](Index column, const SingleEntry& entry) { return column == entry.column; };
        if (is_arranged_ && std::equal(below_.begin(), below_.end(), below.begin(), below.end(), is_same)) return;
        below_.clear();
        for (Front& front : fronts_) front.single.clear();
        for (const SingleEntry& entry : below) {
            fronts_[order_.place(entry.column)].single.push_back(static_cast<Index>(below_.size()));
            below_.push_back(entry.column);
        }
        for (Front& front : fronts_) arrange(front);
        is_arranged_ = true;
    }

    void arrange(Front& front) {
        std::vector<Index> numbers, firsts;  // of the rows that come in, and their first columns
        for (Index row : front.own) numbers.push_back(row);
        for (Index row : front.single) numbers.push_back(pattern_.rows() + row);
        firsts.assign(numbers.size(), 0);
        for (Index child : front.children) {
            const Front& before = fronts_[child];
            for (Index row = before.first_left(); row < static_cast<Index>(before.leads.size()); ++row) {
                numbers.push_back(before.rows[row]);
                firsts.push_back(before.to_parent[before.leads[row]]);
            }
        }
        std::vector<Index> counts(front.width() + 1, 0);
        for (Index first : firsts) ++counts[first + 1];
        for (Index j = 0; j < front.width(); ++j) counts[j + 1] += counts[j];
        front.ends.assign(counts.begin() + 1, counts.end());
        front.rows.resize(numbers.size());
        front.places.resize(numbers.size());
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            front.places[i] = counts[firsts[i]]++;
            front.rows[front.places[i]] = numbers[i];
        }
        front.leads.clear();
        for (Index j = 0; j < front.width(); ++j) {
            if (front.ends[j] > static_cast<Index>(front.leads.size())) front.leads.push_back(j);
        }
        front.values.resize(numbers.size() * front.columns.size());
        front.scales.resize(front.leads.size());
    }

    // --- numbers ----------------------------------------------------------------------------------

    void fill_own(Front& front, Vector<const double> entries, Vector<const SingleEntry> below) {
        next_ = 0;
        for (Index row : front.own) {
            double* const values = front.row(front.places[next_++]);
            for (Index entry = pattern_.starts[row]; entry < pattern_.starts[row + 1]; ++entry) {
                values[local(front, order_.place(pattern_.entries[entry]))] = entries[entry];
            }
        }
        for (Index row : front.single) front.row(front.places[next_++])[0] = below[row].value;
    }

    // The rows that a front before leaves.
    void fill_from(const Front& before, Front& front) {
        for (Index row = before.first_left(); row < static_cast<Index>(before.leads.size()); ++row) {
            const double* const left = before.row(row);
            double* const values = front.row(front.places[next_++]);
            for (Index j = before.leads[row]; j < before.width(); ++j) values[before.to_parent[j]] = left[j];
        }
    }

    void triangularise(Front& front) {
        const Index width = front.width();
        dots_.resize(width);
        for (Index pivot = 0; pivot < static_cast<Index>(front.leads.size()); ++pivot) {
            const Index column = front.leads[pivot], end = front.ends[column];
            double* const top = front.row(pivot);
            double square = 0.0;
            for (Index i = pivot + 1; i < end; ++i) square += front.row(i)[column] * front.row(i)[column];
            front.scales[pivot] = 0.0;
            if (square == 0.0) continue;
            const double norm = std::sqrt(top[column] * top[column] + square);
            const double diagonal = top[column] > 0.0 ? -norm : norm;
            const double first = top[column] - diagonal;
            const double scale = -first / diagonal;
            front.scales[pivot] = scale;
            top[column] = diagonal;
            for (Index j = column + 1; j < width; ++j) dots_[j] = top[j];
            for (Index i = pivot + 1; i < end; ++i) {
                double* const row = front.row(i);
                const double entry = row[column] /= first;
                for (Index j = column + 1; j < width; ++j) dots_[j] += entry * row[j];
            }
            for (Index j = column + 1; j < width; ++j) {
                dots_[j] *= scale;
                top[j] -= dots_[j];
            }
            for (Index i = pivot + 1; i < end; ++i) {
                double* const row = front.row(i);
                const double entry = row[column];
                for (Index j = column + 1; j < width; ++j) row[j] -= entry * dots_[j];
            }
        }
    }

    static void reflect(const Front& front, Vector<double> right) {
        for (Index pivot = 0; pivot < static_cast<Index>(front.leads.size()); ++pivot) {
            if (front.scales[pivot] == 0.0) continue;
            const Index column = front.leads[pivot], end = front.ends[column];
            double dot = right[front.rows[pivot]];
            for (Index i = pivot + 1; i < end; ++i) dot += front.row(i)[column] * right[front.rows[i]];
            dot *= front.scales[pivot];
            right[front.rows[pivot]] -= dot;
            for (Index i = pivot + 1; i < end; ++i) right[front.rows[i]] -= dot * front.row(i)[column];
        }
    }

    void solve_upper(Vector<double> vector) const {
        for (Index place = order_.size() - 1; place >= 0; --place) {
            const Front& front = fronts_[place];
            if (!front.is_regular()) {
                vector[place] = 0.0;
                continue;
            }
            double total = vector[place];
            for (Index j = 1; j < front.width(); ++j) total -= front.values[j] * vector[front.columns[j]];
            vector[place] = total / front.values[0];
        }
    }

    const SparsityPattern& pattern_;
    const ColumnOrder& order_;
    std::vector<Front> fronts_;
    std::vector<Index> below_;  // columns of the rows below
    bool is_arranged_ = false;
    Index next_ = 0;  // row that comes in
    std::vector<double> dots_;
    mutable std::vector<double> solution_;
};

}  // namespace bifurc
