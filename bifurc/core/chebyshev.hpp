// Interpolants at Chebyshev nodes and bounds on them: `bifurc.curves.kantorovich` says why these hold.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "bifurc/core/arrays.hpp"

namespace bifurc {

// What the nodes alone determine, N of them, an even number: ``to_coefficients`` (N, N) from values at the nodes to coefficients,
// ``to_edges`` (N, c + 1) from these to the values at the edges of cells, ``powers`` (N, e) on the ellipses,
// ``errors`` (e): how far an interpolant may be off, for a bound of 1 on an ellipse. ``lebesgue``: how much
// larger an interpolant may be than at the nodes. ``bend``: how far it may be, within a cell, from the line
// between its values at the edges, for a second derivative of 1.
class Chebyshev {
public:
    Chebyshev(Matrix<double> to_coefficients, Matrix<double> to_edges, Matrix<double> powers,
              std::vector<double> errors, double lebesgue, double bend)
        : to_coefficients_(std::move(to_coefficients)),
          to_edges_(std::move(to_edges)),
          powers_(std::move(powers)),
          errors_(std::move(errors)),
          lebesgue_(lebesgue),
          bend_(bend) {}

    Index nodes() const { return to_coefficients_.rows(); }
    Index edges() const { return to_edges_.columns(); }
    Index ellipses() const { return powers_.columns(); }

    // The first coefficients (k, q) of the interpolants of values (N, q) at the nodes. Those of even
    // degrees come from the even parts of the values, the others from the odd ones.
    void coefficients(View<const double> values, View<double> out) const {
        const Index width = values.columns, half = nodes() / 2;
        Matrix<double> even(half, width), odd(half, width);
        for (Index node = 0; node < half; ++node) {
            for (Index i = 0; i < width; ++i) {
                const double one = values(node, i), other = values(nodes() - 1 - node, i);
                even(node, i) = one + other;
                odd(node, i) = one - other;
            }
        }
        for (Index k = 0; k < out.rows; ++k) {
            const Matrix<double>& parts = k % 2 == 0 ? even : odd;
            std::fill(out.row(k).begin(), out.row(k).end(), 0.0);
            for (Index node = 0; node < half; ++node) {
                const double share = to_coefficients_(k, node);
                for (Index i = 0; i < width; ++i) out(k, i) += share * parts(node, i);
            }
        }
    }

    // The values (c + 1) of an interpolant with coefficients (N) at the edges of cells.
    void on_edges(Vector<const double> series, Vector<double> out) const {
        add_up(series, to_edges_, out);
    }

    // Bounds (e) on each ellipse on a sum whose coefficients have ``sizes`` (k), the first k of N.
    void on_ellipses(Vector<const double> sizes, Vector<double> out) const { add_up(sizes, powers_, out); }

    // How far an interpolant with coefficients (N) may be, within a cell, from the line between its values at
    // the edges, as a function of the angle.
    double slack(Vector<const double> series) const {
        double second_derivative = 0.0;
        for (std::size_t k = 0; k < series.size(); ++k) {
            second_derivative += std::abs(series[k]) * static_cast<double>(k * k);
        }
        return bend_ * second_derivative;
    }

    // A bound on an interpolant all along, from the sizes of its values (N) at the nodes and of its
    // coefficients (N): by the largest of those, or by the sum of these.
    double largest(Vector<const double> at_nodes, Vector<const double> in_coefficients) const {
        double by_nodes = 0.0, by_sum = 0.0;
        for (double size : at_nodes) by_nodes = std::max(by_nodes, size);
        for (double size : in_coefficients) by_sum += size;
        return std::min(by_sum, lebesgue_ * by_nodes);  // in this order what is no number stays
    }

    // How far an interpolant may be from a function with ``bounds`` (e) on the ellipses.
    double error(Vector<const double> bounds) const {
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < errors_.size(); ++i) least = std::min(least, errors_[i] * bounds[i]);
        return least;
    }

private:
    static void add_up(Vector<const double> shares, const Matrix<double>& rows, Vector<double> out) {
        std::fill(out.begin(), out.end(), 0.0);
        for (std::size_t k = 0; k < shares.size(); ++k) {
            const Vector<const double> row = rows.row(static_cast<Index>(k));
            for (std::size_t i = 0; i < out.size(); ++i) out[i] += shares[k] * row[i];
        }
    }

    Matrix<double> to_coefficients_, to_edges_, powers_;
    std::vector<double> errors_;
    double lebesgue_, bend_;
};

}  // namespace bifurc
