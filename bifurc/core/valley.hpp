// The valley of a system that contradicts itself a little: `bifurc.curves.valley_problem`.
//
// With F' = U diag(sigma) V^T and P the projection on the first n - 1 columns of U, the valley is where
// G = P F = 0.
#pragma once

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "bifurc/core/system.hpp"

namespace bifurc {

// Rows w_i = sigma_i v_i^T and u_i with u_i . F' = w_i, of a small F' (m, n), by one-sided Jacobi
// rotations of the rows of F' (Hestenes 1958; Golub and Van Loan 2013, 8.6.3). The longest w_i is the
// first. There are m of either: the u_i are a basis, and nothing is divided by a sigma_i.
class TurnedRows {
public:
    TurnedRows(Index rows, Index columns)
        : turned_(rows, columns), basis_(rows, rows), squares_(rows), order_(rows) {}

    void of(View<const double> matrix) {
        std::copy_n(matrix.data, matrix.rows * matrix.columns, turned_.view().data);
        const Index rows = matrix.rows;
        for (Index i = 0; i < rows; ++i) {
            for (Index j = 0; j < rows; ++j) basis_(i, j) = i == j ? 1.0 : 0.0;
        }
        for (int sweep = 0; sweep < most_sweeps; ++sweep) {
            if (!rotate_all()) break;
        }
        for (Index i = 0; i < rows; ++i) squares_[i] = squared_length(turned_.row(i));
        std::iota(order_.begin(), order_.end(), Index{0});
        std::stable_sort(order_.begin(), order_.end(), [&](Index i, Index j) { return squares_[i] > squares_[j]; });
    }

    // w_i (n), u_i (m) and sigma_i^2.
    Vector<const double> image(Index i) const { return turned_.row(order_[i]); }
    Vector<const double> direction(Index i) const { return basis_.row(order_[i]); }
    double square(Index i) const { return squares_[order_[i]]; }

private:
    static constexpr int most_sweeps = 40;
    // a row below this share of the whole matrix is rounding and at right angles to everything
    static constexpr double nothing = 4.0 * std::numeric_limits<double>::epsilon();

    // One rotation for every pair of rows; whether any was needed.
    bool rotate_all() {
        double whole = 0.0;
        for (Index i = 0; i < turned_.rows(); ++i) {
            squares_[i] = squared_length(turned_.row(i));
            whole += squares_[i];
        }
        const double least = nothing * nothing * whole;
        bool has_turned = false;
        for (Index i = 0; i + 1 < turned_.rows(); ++i) {
            for (Index j = i + 1; j < turned_.rows(); ++j) has_turned = rotate(i, j, least) || has_turned;
        }
        return has_turned;
    }

    // Turns rows i and j to right angles; whether they were at none.
    bool rotate(Index i, Index j, double least) {
        if (!(std::min(squares_[i], squares_[j]) > least)) return false;
        const double gamma = dot(turned_.row(i), turned_.row(j));
        const double orthogonal = std::numeric_limits<double>::epsilon() * std::sqrt(squares_[i] * squares_[j]);
        if (!(std::abs(gamma) > orthogonal)) return false;
        const double zeta = (squares_[j] - squares_[i]) / (2.0 * gamma);
        const double tangent = std::copysign(1.0, zeta) / (std::abs(zeta) + std::sqrt(1.0 + zeta * zeta));
        const double cosine = 1.0 / std::sqrt(1.0 + tangent * tangent);
        const double sine = cosine * tangent;
        turn(turned_.row(i), turned_.row(j), cosine, sine);
        turn(basis_.row(i), basis_.row(j), cosine, sine);
        squares_[i] -= tangent * gamma;
        squares_[j] += tangent * gamma;
        return true;
    }

    static void turn(Vector<double> p, Vector<double> q, double cosine, double sine) {
        for (std::size_t k = 0; k < p.size(); ++k) {
            const double first = cosine * p[k] - sine * q[k];
            q[k] = sine * p[k] + cosine * q[k];
            p[k] = first;
        }
    }

    Matrix<double> turned_, basis_;
    std::vector<double> squares_;
    std::vector<Index> order_;
};

// G (m) and G' (m, n) of F (m), F' (m, n) and F'' (m * n, n), all over the magnitude.
class ValleyEquations {
public:
    ValleyEquations(Index equations, Index unknowns)
        : rank_(std::min(unknowns - 1, equations)),
          rows_(equations, unknowns),
          components_(equations),
          weak_bend_(unknowns, unknowns),
          bends_(equations, unknowns),
          turning_(unknowns) {}

    void residual(Vector<const double> residual, View<const double> jacobian, Vector<double> projected) {
        rows_.of(jacobian);
        project(residual, projected);
    }

    // P' = sum_{i < n <= j} b_ij (u_i u_j^T + u_j u_i^T): first-order perturbation of F' F'^T, with
    // b_ij = (u_j . F''(w, w_i) + u_i . F''(w, w_j)) / (sigma_i^2 - sigma_j^2) along w.
    void linearize(Vector<const double> residual, View<const double> jacobian, View<const double> hessian,
                   Vector<double> projected, View<double> out) {
        rows_.of(jacobian);
        project(residual, projected);
        const Index m = jacobian.rows, n = jacobian.columns;
        std::fill_n(out.data, m * n, 0.0);
        for (Index i = 0; i < rank_; ++i) add_product(rows_.direction(i), rows_.image(i), 1.0, out);
        for (Index j = rank_; j < m; ++j) {
            bend_along(hessian, rows_.direction(j));
            bend_with(hessian, rows_.image(j));
            for (Index i = 0; i < rank_; ++i) {
                turn_of(i, j);
                add_product(rows_.direction(i), turning_, components_[j], out);
                add_product(rows_.direction(j), turning_, components_[i], out);
            }
        }
    }

private:
    static constexpr double tiny = 1e-30;  // keeps a difference of squares from being zero

    // P F, and the components u_i . F.
    void project(Vector<const double> residual, Vector<double> projected) {
        std::fill(projected.begin(), projected.end(), 0.0);
        for (std::size_t i = 0; i < components_.size(); ++i) {
            components_[i] = dot(rows_.direction(static_cast<Index>(i)), residual);
        }
        for (Index i = 0; i < rank_; ++i) {
            const Vector<const double> direction = rows_.direction(i);
            for (std::size_t row = 0; row < projected.size(); ++row) projected[row] += components_[i] * direction[row];
        }
    }

    // u . F'' (n, n).
    void bend_along(View<const double> hessian, Vector<const double> direction) {
        const Index n = hessian.columns;
        std::fill_n(weak_bend_.view().data, n * n, 0.0);
        for (std::size_t row = 0; row < direction.size(); ++row) {
            const double* const of_row = hessian.row(static_cast<Index>(row) * n).data();
            for (Index k = 0; k < n * n; ++k) weak_bend_.view().data[k] += direction[row] * of_row[k];
        }
    }

    // F'' with a vector (m, n).
    void bend_with(View<const double> hessian, Vector<const double> vector) {
        const Index n = hessian.columns;
        for (Index row = 0; row < bends_.rows(); ++row) {
            for (Index k = 0; k < n; ++k) bends_(row, k) = dot(hessian.row(row * n + k), vector);
        }
    }

    // b_ij for w along every unknown (n).
    void turn_of(Index i, Index j) {
        const Vector<const double> image = rows_.image(i), direction = rows_.direction(i);
        const double gap = std::max(rows_.square(i) - rows_.square(j), tiny);
        for (std::size_t k = 0; k < turning_.size(); ++k) {
            double total = dot(weak_bend_.row(static_cast<Index>(k)), image);
            for (std::size_t row = 0; row < direction.size(); ++row) {
                total += direction[row] * bends_(static_cast<Index>(row), static_cast<Index>(k));
            }
            turning_[k] = total / gap;
        }
    }

    static void add_product(Vector<const double> column, Vector<const double> row, double factor, View<double> to) {
        for (Index i = 0; i < to.rows; ++i) {
            const double share = factor * column[i];
            for (Index k = 0; k < to.columns; ++k) to(i, k) += share * row[k];
        }
    }

    Index rank_;
    TurnedRows rows_;
    std::vector<double> components_;  // u_i . F
    Matrix<double> weak_bend_, bends_;
    std::vector<double> turning_;
};

// A system that gives F'' (m * n, n) as well.
template <class S>
concept CurvedSystem =
    DenseSystem<S> && requires(const S& system, Vector<const double> point, View<double> hessian) { system.hessian(point, hessian); };

// G and G' of a system at a point.
template <CurvedSystem S>
class Valley {
public:
    explicit Valley(const S& system)
        : system_(system),
          equations_(system.equations(), system.unknowns()),
          own_residual_(system.equations()),
          own_jacobian_(system.equations(), system.unknowns()),
          hessian_(system.equations() * system.unknowns(), system.unknowns()) {}

    Index unknowns() const { return system_.unknowns(); }
    Index equations() const { return system_.equations(); }

    void residual(Vector<const double> point, Vector<double> residual) {
        system_.linearize(point, own_residual_, own_jacobian_.view());
        equations_.residual(own_residual_, own_jacobian_, residual);
    }

    void linearize(Vector<const double> point, Vector<double> residual, View<double> jacobian) {
        system_.linearize(point, own_residual_, own_jacobian_.view());
        system_.hessian(point, hessian_);
        equations_.linearize(own_residual_, own_jacobian_, hessian_, residual, jacobian);
    }

private:
    const S& system_;
    ValleyEquations equations_;
    std::vector<double> own_residual_;
    Matrix<double> own_jacobian_, hessian_;
};

}  // namespace bifurc
