// Adjugates of matrices along arcs, and how large their columns are.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "bifurc/core/arrays.hpp"
#include "bifurc/core/chebyshev.hpp"
#include "bifurc/core/inverse.hpp"

namespace bifurc {

// What an arc is taken to be at its N nodes: the curve's ``slopes`` (N, n), F' in ``jacobians``
// (N * m, n) and the combinations ``left`` (m, n - 1) of the equations, the weakest last.
struct ArcNodes {
    View<const double> slopes, jacobians, left;
};

// Norms of columns of the adjugates, ``all`` of them, those of the ``strong`` combinations and that
// of the weakest: each (N).
struct ColumnNorms {
    Vector<double> all, strong, weak;
};

// What is found there of H = [left^T F'; slope^T]: ``determinants`` (N), ``adjugates`` (N * n, n), the
// norms of H (N), and of the columns of the adjugates at the nodes and in the coefficients of the
// polynomials through them.
struct ArcAdjugates {
    Vector<double> determinants;
    View<double> adjugates;
    Vector<double> frame_norms;
    ColumnNorms at_nodes, in_coefficients;
};

// Adjugates arc by arc.
class Adjugates {
public:
    Adjugates(Index unknowns, const Chebyshev& chebyshev)
        : chebyshev_(chebyshev),
          frame_(unknowns, unknowns),
          pivots_(unknowns),
          coefficients_(chebyshev.nodes(), unknowns * unknowns) {}

    void of(const ArcNodes& arc, const ArcAdjugates& out) {
        const Index nodes = chebyshev_.nodes(), n = frame_.rows();
        for (Index node = 0; node < nodes; ++node) {
            fill_frame(arc, node);
            out.frame_norms[node] = length({frame_.view().data, static_cast<std::size_t>(n * n)});
            out.determinants[node] = adjugate({out.adjugates.data + node * n * n, n, n});
        }
        take_norms({out.adjugates.data, nodes, n * n}, out.at_nodes);
        chebyshev_.coefficients({out.adjugates.data, nodes, n * n}, coefficients_);
        take_norms(coefficients_.view(), out.in_coefficients);
    }

private:
    void fill_frame(const ArcNodes& arc, Index node) {
        const Index n = frame_.rows(), m = arc.left.rows;
        std::fill_n(frame_.view().data, n * n, 0.0);
        for (Index row = 0; row < m; ++row) {
            const Vector<const double> gradient = arc.jacobians.row(node * m + row);
            for (Index i = 0; i + 1 < n; ++i) {
                const double share = arc.left(row, i);
                for (Index j = 0; j < n; ++j) frame_(i, j) += share * gradient[j];
            }
        }
        for (Index j = 0; j < n; ++j) frame_(n - 1, j) = arc.slopes(node, j);
    }

    // The determinant of the frame, which is overwritten; fills its adjugate. A singular frame, to the
    // last bit, says nothing of it: zero.
    double adjugate(View<double> out) {
        const double determinant = invert(frame_, pivots_);
        const Index size = out.rows * out.columns;
        const double* const inverse = frame_.view().data;
        for (Index i = 0; i < size; ++i) out.data[i] = determinant == 0.0 ? 0.0 : determinant * inverse[i];
        return determinant;
    }

    // Of matrices (n, n), one a row: their last column is that of the slope.
    void take_norms(View<const double> matrices, const ColumnNorms& norms) const {
        const Index n = frame_.rows();
        for (Index k = 0; k < matrices.rows; ++k) {
            double strong = 0.0, weak = 0.0, last = 0.0;
            for (Index i = 0; i < n; ++i) {
                const double* const row = matrices.row(k).data() + i * n;
                for (Index j = 0; j + 2 < n; ++j) strong += row[j] * row[j];
                if (n > 1) weak += row[n - 2] * row[n - 2];
                last += row[n - 1] * row[n - 1];
            }
            norms.all[k] = std::sqrt(strong + weak + last);
            norms.strong[k] = std::sqrt(strong);
            norms.weak[k] = std::sqrt(weak);
        }
    }

    const Chebyshev& chebyshev_;
    Matrix<double> frame_;
    std::vector<Index> pivots_;
    Matrix<double> coefficients_;
};

}  // namespace bifurc
