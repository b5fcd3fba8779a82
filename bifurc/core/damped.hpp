// Steps of Levenberg and Marquardt's method: min |F' d + F|^2 + damping |d|^2.
#pragma once

#include <cmath>
#include <vector>

#include "bifurc/core/least_squares.hpp"
#include "bifurc/core/sparse_qr.hpp"

namespace bifurc {

// With a dense F' (m, n), by the normal equations.
class DenseDamped {
public:
    using Jacobian = Matrix<double>;

    DenseDamped(Index equations, Index unknowns) : equations_(equations), normal_(unknowns, unknowns) {}

    Jacobian jacobian() const { return {equations_, normal_.columns()}; }

    void step(const Jacobian& jacobian, Vector<const double> residual, double damping, Vector<double> step) {
        damped_step(jacobian, residual, damping, normal_, step);
    }

private:
    Index equations_;
    Matrix<double> normal_;
};

// With a sparse F', by QR of F' and a row sqrt(damping) for every unknown.
class SparseDamped {
public:
    using Jacobian = std::vector<double>;

    explicit SparseDamped(const Sparsity& sparsity)
        : count_(sparsity.pattern.entries.size()),
          below_(sparsity.pattern.columns),
          right_(sparsity.pattern.rows() + sparsity.pattern.columns),
          qr_(sparsity) {}

    Jacobian jacobian() const { return Jacobian(count_); }

    void step(const Jacobian& jacobian, Vector<const double> residual, double damping, Vector<double> step) {
        const double root = std::sqrt(damping);
        for (std::size_t j = 0; j < below_.size(); ++j) below_[j] = {static_cast<Index>(j), root};
        std::fill(right_.begin(), right_.end(), 0.0);
        for (std::size_t row = 0; row < residual.size(); ++row) right_[row] = -residual[row];
        qr_.factor(jacobian, below_);
        qr_.solve(right_, step);
    }

private:
    std::size_t count_;
    std::vector<SingleEntry> below_;
    std::vector<double> right_;
    SparseQr qr_;
};

}  // namespace bifurc
