// Krawczyk's test (1969) with one unknown as the parameter: n - 1 equations F in n unknowns.
//
// F and F', and the products of matrices made of them, are intervals rounded outwards. The matrix that
// preconditions them and the unknown that is the parameter are chosen in doubles: any choice is right.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "bifurc/core/arrays.hpp"
#include "bifurc/core/interval.hpp"

namespace bifurc {

// C F' (m, n) in the radii of a box about its middle, with C near the inverse of F' by all unknowns but one, the
// parameter, and C F (m) in the middle.
class Preconditioned {
public:
    explicit Preconditioned(Index unknowns)
        : rows_(unknowns - 1),
          work_(rows_, unknowns + rows_),
          is_free_(unknowns),
          pivots_(rows_),
          gaps_(rows_),
          slopes_(rows_, unknowns) {}

    Index parameter() const { return parameter_; }
    // The unknown that row i of C F' is about: its own entry there is about 1.
    Index pivot(Index i) const { return pivots_[i]; }
    const Interval& gap(Index i) const { return gaps_[i]; }
    const Interval& slope(Index i) const { return slopes_(i, parameter_); }

    // C from the middle of bounds on F' (m, n); false where it has none.
    bool choose(const Matrix<Interval>& jacobian, Vector<const double> radii) {
        const Index n = jacobian.columns();
        for (Index i = 0; i < rows_; ++i) {
            for (Index j = 0; j < n; ++j) work_(i, j) = jacobian(i, j).middle() * radii[j];
            for (Index k = 0; k < rows_; ++k) work_(i, n + k) = i == k ? 1.0 : 0.0;
        }
        std::fill(is_free_.begin(), is_free_.end(), true);
        for (Index k = 0; k < rows_; ++k) {
            if (!eliminate(k)) return false;
        }
        parameter_ = std::find(is_free_.begin(), is_free_.end(), true) - is_free_.begin();
        return true;
    }

    void take_values(Vector<const Interval> values) {
        for (Index i = 0; i < rows_; ++i) {
            gaps_[i] = 0.0;
            for (Index k = 0; k < rows_; ++k) gaps_[i] += Interval(inverse(i, k)) * values[k];
        }
    }

    void take_jacobian(const Matrix<Interval>& jacobian, Vector<const double> radii) {
        for (Index i = 0; i < rows_; ++i) {
            for (Index j = 0; j < jacobian.columns(); ++j) {
                Interval total = 0.0;
                for (Index k = 0; k < rows_; ++k) total += Interval(inverse(i, k)) * jacobian(k, j);
                slopes_(i, j) = total * Interval(radii[j]);
            }
        }
    }

    // Whether C F = C F(0) + C F' x is nowhere 0 for x in [-1, 1].
    bool leaves_out_zero() const {
        for (Index i = 0; i < rows_; ++i) {
            Interval range = gaps_[i];
            for (Index j = 0; j < slopes_.columns(); ++j) {
                const double size = slopes_(i, j).magnitude();
                range += Interval(-size, size);
            }
            if (!range.contains(0.0)) return true;
        }
        return false;
    }

    // A bound on x - C F in the unknown of row i, where the parameter is in [-1, 1] and the others are in
    // [-width, width]: Krawczyk's operator (1969).
    double reach(Index i, double width) const {
        const Interval others = Interval(width) * bend(i);
        return (Interval(gap(i).magnitude()) + Interval(slope(i).magnitude()) + others).high;
    }

    // By how much C F (m) may be off a linear function along an unknown.
    double spread(Index j) const {
        double most = 0.0;
        for (Index i = 0; i < rows_; ++i) most = std::max(most, slopes_(i, j).high - slopes_(i, j).low);
        return most;
    }

    bool reaches_less(double width, double allowed) const {
        for (Index i = 0; i < rows_; ++i) {
            if (!(reach(i, width) < allowed)) return false;
        }
        return true;
    }

    // The rates at which the unknowns (m) of the rows change along an arc, over that of the parameter.
    void find_rates(Vector<Interval> rates) const {
        double steepest = 0.0, most = 0.0;
        for (Index i = 0; i < rows_; ++i) {
            steepest = std::max(steepest, slope(i).magnitude());
            most = std::max(most, bend(i).high);
        }
        const Interval bound = Interval(steepest) / (Interval(1.0) - Interval(most));
        for (Index i = 0; i < rows_; ++i) {
            const double spread = (bend(i) * bound).high;
            rates[i] = -slope(i) + Interval(-spread, spread);
        }
    }

private:
    double inverse(Index i, Index k) const { return work_(i, slopes_.columns() + k); }

    // How far row i is from the unit matrix in the unknowns but the parameter: the sum of absolute values.
    Interval bend(Index i) const {
        Interval total = 0.0;
        for (Index j = 0; j < slopes_.columns(); ++j) {
            if (j == parameter_) continue;
            const Interval entry = j == pivots_[i] ? slopes_(i, j) - Interval(1.0) : slopes_(i, j);
            total += Interval(entry.magnitude());
        }
        return total;
    }

    // One step of Gauss-Jordan elimination with the largest entry as the pivot.
    bool eliminate(Index k) {
        const Index n = slopes_.columns();
        Index row = k, column = -1;
        double largest = 0.0;
        for (Index i = k; i < rows_; ++i) {
            for (Index j = 0; j < n; ++j) {
                if (!is_free_[j] || !(std::abs(work_(i, j)) > largest)) continue;
                largest = std::abs(work_(i, j));
                row = i;
                column = j;
            }
        }
        if (column < 0) return false;
        std::swap_ranges(work_.row(k).begin(), work_.row(k).end(), work_.row(row).begin());
        is_free_[column] = false;
        pivots_[k] = column;
        const double share = 1.0 / work_(k, column);
        for (double& entry : work_.row(k)) entry *= share;
        for (Index i = 0; i < rows_; ++i) {
            if (i == k) continue;
            const double factor = work_(i, column);
            for (Index j = 0; j < work_.columns(); ++j) work_(i, j) -= factor * work_(k, j);
        }
        return true;
    }

    Index rows_;
    Matrix<double> work_;  // (m, n + m): on its right comes C about
    std::vector<char> is_free_;
    std::vector<Index> pivots_;
    Index parameter_ = 0;
    std::vector<Interval> gaps_;
    Matrix<Interval> slopes_;
};

}  // namespace bifurc
