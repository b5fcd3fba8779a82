// The closure of a loop of revolute joints: residual, derivatives, Taylor series of its motion.
//
// The residual of a configuration is (2 sign(q_0) q_v, p): the vector part of the unit
// quaternion of the loop product and its translation over the characteristic length. The vector
// part vanishes for the identity alone; the skew part of the rotation matrix, used in the
// sources, also vanishes at half turns.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "bifurc/core/arrays.hpp"
#include "bifurc/core/least_squares.hpp"
#include "linkages/core/lanes.hpp"
#include "linkages/core/screws.hpp"

namespace linkages {

using bifurc::Factorization;
using bifurc::Index;
using bifurc::Matrix;
using bifurc::Vector;
using bifurc::View;

// ``geometry`` (6, n): length and offset over the characteristic length, cosine and sine of the
// twist, cosine and sine of half the twist.
class Closure {
public:
    static constexpr Index equation_count = 6;

    explicit Closure(View<const double> geometry) : geometry_(geometry) {}

    Index unknowns() const { return geometry_.columns; }
    Index equations() const { return equation_count; }

    // Where a loop of joints and links ends: unit quaternion with q_0 >= 0 (both signs are the
    // same rotation) and translation.
    struct End {
        std::array<double, 4> rotation;
        Vec3<double> translation;
    };

    // The end of the loop at joint angles ``theta``; calls ``visit(i, screw)`` with the screw of
    // every joint on the way.
    template <class Visitor>
    End follow(Vector<const double> theta, Visitor visit) const {
        Vec3<double> x{1.0, 0.0, 0.0}, y{0.0, 1.0, 0.0}, z{0.0, 0.0, 1.0}, p{0.0, 0.0, 0.0};
        std::array<double, 4> q{1.0, 0.0, 0.0, 0.0};
        for (Index i = 0; i < unknowns(); ++i) {
            visit(i, Screw<double>{z, cross(p, z)});
            const double length = geometry_(0, i), offset = geometry_(1, i);
            const double ca = geometry_(2, i), sa = geometry_(3, i);
            const double c = std::cos(theta[i]), s = std::sin(theta[i]);
            const Vec3<double> u = c * x + s * y;
            const Vec3<double> w = c * y - s * x;
            p = p + offset * z + length * u;
            x = u;
            y = ca * w + sa * z;
            z = ca * z - sa * w;
            q = about_z(q, std::cos(0.5 * theta[i]), std::sin(0.5 * theta[i]));
            q = about_x(q, geometry_(4, i), geometry_(5, i));
        }
        if (q[0] < 0.0) q = {-q[0], -q[1], -q[2], -q[3]};
        return {q, p};
    }

    void residual(Vector<const double> theta, Vector<double> residual) const {
        fill(follow(theta, [](Index, const Screw<double>&) {}), residual);
    }

    // Residual (6) and its exact derivative (6, n), also where the loop is not closed.
    void linearize(Vector<const double> theta, Vector<double> residual, View<double> jacobian) const {
        const auto store = [&](Index i, const Screw<double>& screw) { set_column(jacobian, i, screw); };
        const End end = follow(theta, store);
        fill(end, residual);
        for (Index i = 0; i < unknowns(); ++i) {
            const Screw<double> screw = column(jacobian, i);
            const Vec3<double>& w = screw.direction;
            const auto& [q0, q1, q2, q3] = end.rotation;
            const Vec3<double> rotation{q0 * w[0] + w[1] * q3 - w[2] * q2, q0 * w[1] + w[2] * q1 - w[0] * q3,
                                        q0 * w[2] + w[0] * q2 - w[1] * q1};
            set_column(jacobian, i, {rotation, screw.moment + cross(w, end.translation)});
        }
    }

    // Second derivative (6 * n, n) of the residual. For joints i <= j with screws (w, v):
    // d2q = w_i w_j q / 4 (quaternion products), d2p = w_i x (v_j + w_j x p). On a closed
    // configuration this is the symmetric part of the Lie bracket of the screws.
    void hessian(Vector<const double> theta, View<double> hessian) const {
        const Index n = unknowns();
        std::vector<Screw<double>> screws(n);
        const End end = follow(theta, [&](Index i, const Screw<double>& screw) { screws[i] = screw; });
        const Vec3<double> q{end.rotation[1], end.rotation[2], end.rotation[3]};
        for (Index j = 0; j < n; ++j) {
            const Vec3<double>& w = screws[j].direction;
            const double scalar = -dot(w, q);  // of w_j q, and its vector
            const Vec3<double> vector = end.rotation[0] * w + cross(w, q);
            const Vec3<double> velocity = screws[j].moment + cross(w, end.translation);
            for (Index i = 0; i <= j; ++i) {
                const Vec3<double>& u = screws[i].direction;
                const Vec3<double> rotation = 0.5 * (scalar * u + cross(u, vector));
                const Vec3<double> translation = cross(u, velocity);
                for (Index row = 0; row < 3; ++row) {
                    hessian(row * n + i, j) = hessian(row * n + j, i) = rotation[row];
                    hessian((row + 3) * n + i, j) = hessian((row + 3) * n + j, i) = translation[row];
                }
            }
        }
    }

    // Taylor coefficients (order + 1, n) of theta(s), s the arclength, from the factored [F'; t].
    void series(Vector<const double> theta, Vector<const double> tangent, const Factorization& factorization,
                View<double> coefficients) const;

private:
    static void fill(const End& end, Vector<double> residual) {
        for (Index row = 0; row < 3; ++row) {
            residual[row] = 2.0 * end.rotation[row + 1];
            residual[row + 3] = end.translation[row];
        }
    }

    View<const double> geometry_;
};

// The closure of a loop in fewer unknowns v, with theta = M v + c. ``coupling`` (n, k + 1) is
// [M c].
class CoupledClosure {
public:
    CoupledClosure(const Closure& closure, View<const double> coupling) : closure_(closure), coupling_(coupling) {}

    Index unknowns() const { return coupling_.columns - 1; }
    Index equations() const { return closure_.equations(); }
    Index joints() const { return coupling_.rows; }
    double ratio(Index joint, Index unknown) const { return coupling_(joint, unknown); }

    std::vector<double> angles(Vector<const double> unknowns) const {
        std::vector<double> theta(joints());
        for (Index i = 0; i < joints(); ++i) {
            theta[i] = coupling_(i, coupling_.columns - 1);
            for (Index j = 0; j < this->unknowns(); ++j) theta[i] += coupling_(i, j) * unknowns[j];
        }
        return theta;
    }

    void residual(Vector<const double> unknowns, Vector<double> residual) const {
        closure_.residual(angles(unknowns), residual);
    }

    void linearize(Vector<const double> unknowns, Vector<double> residual, View<double> jacobian) const {
        Matrix<double> by_angles(equations(), joints());
        closure_.linearize(angles(unknowns), residual, by_angles);
        for (Index row = 0; row < equations(); ++row) {
            for (Index j = 0; j < this->unknowns(); ++j) {
                double total = 0.0;
                for (Index i = 0; i < joints(); ++i) total += by_angles(row, i) * coupling_(i, j);
                jacobian(row, j) = total;
            }
        }
    }

    void series(Vector<const double> unknowns, Vector<const double> tangent, const Factorization& factorization,
                View<double> coefficients) const;

private:
    Closure closure_;
    View<const double> coupling_;
};

// The motion of a closed loop as series in the arclength, one order after the other. With S_i(s)
// the screw of joint i and V_i(s) the twist of the joints before it, dS_i/ds = [V_i, S_i] and
// sum_i S_i dtheta_i/ds = 0, |du/ds| = 1: every order takes one product of series and one solve.
// Joints stand four abreast.
class MotionSeries {
public:
    MotionSeries(Index joints, Index order)
        : joints_(joints),
          blocks_((joints + Lanes::width - 1) / Lanes::width),
          screws_((order + 1) * blocks_),
          twists_((order + 1) * blocks_),
          rates_(order * blocks_) {}

    void set_screw(Index joint, const Screw<double>& screw) { set_lane(screws_[joint / Lanes::width], joint, screw); }
    double& rate(Index k, Index joint) {
        return rates_[k * blocks_ + joint / Lanes::width][joint % Lanes::width];
    }

    // What is left of coefficient k of sum_i S_i dtheta_i/ds without the rates of order k.
    Screw<double> known_part(Index k) const {
        Screw<Lanes> total{};
        for (Index m = 1; m <= k; ++m) {
            for (Index b = 0; b < blocks_; ++b) total = total + rates_[(k - m) * blocks_ + b] * screws_[m * blocks_ + b];
        }
        Screw<double> out;
        for (Index row = 0; row < 3; ++row) {
            out.direction[row] = sum(total.direction[row]);
            out.moment[row] = sum(total.moment[row]);
        }
        return out;
    }

    // Coefficients k + 1 of the screws, once the rates of order k are known.
    void advance(Index k) {
        Screw<double> twist{};
        for (Index b = 0; b < blocks_; ++b) {
            Screw<Lanes> gained{};
            for (Index m = 0; m <= k; ++m) gained = gained + rates_[(k - m) * blocks_ + b] * screws_[m * blocks_ + b];
            for (Index joint = b * Lanes::width; joint < std::min(joints_, (b + 1) * Lanes::width); ++joint) {
                set_lane(twists_[k * blocks_ + b], joint, twist);
                twist = twist + lane(gained, joint);
            }
        }
        const double share = 1.0 / static_cast<double>(k + 1);
        for (Index b = 0; b < blocks_; ++b) {
            Screw<Lanes> total{};
            for (Index m = 0; m <= k; ++m) {
                total = total + bracket(twists_[m * blocks_ + b], screws_[(k - m) * blocks_ + b]);
            }
            screws_[(k + 1) * blocks_ + b] = Lanes{share, share, share, share} * total;
        }
    }

private:
    static Screw<double> lane(const Screw<Lanes>& block, Index joint) {
        const Index i = joint % Lanes::width;
        return {{block.direction[0][i], block.direction[1][i], block.direction[2][i]},
                {block.moment[0][i], block.moment[1][i], block.moment[2][i]}};
    }

    static void set_lane(Screw<Lanes>& block, Index joint, const Screw<double>& screw) {
        for (Index row = 0; row < 3; ++row) {
            block.direction[row][joint % Lanes::width] = screw.direction[row];
            block.moment[row][joint % Lanes::width] = screw.moment[row];
        }
    }

    Index joints_, blocks_;
    std::vector<Screw<Lanes>> screws_, twists_;  // coefficient by coefficient, block by block
    std::vector<Lanes> rates_;
};

namespace detail {

// `Closure::series` for either kind of unknowns; ``spread(own, k, motion)`` turns their rates of
// order k into those of the joints.
template <class Spread>
void fill_series(const Closure& closure, Vector<const double> theta, Vector<const double> start,
                 Vector<const double> tangent, const Factorization& factorization, Spread spread,
                 View<double> coefficients) {
    const Index order = coefficients.rows - 1, count = coefficients.columns;
    MotionSeries motion(closure.unknowns(), order);
    closure.follow(theta, [&](Index i, const Screw<double>& screw) { motion.set_screw(i, screw); });
    Matrix<double> own(order, count);
    std::vector<double> right(Closure::equation_count + 1);
    std::copy(start.begin(), start.end(), coefficients.row(0).begin());
    for (Index k = 0; k < order; ++k) {
        if (k == 0) {
            std::copy(tangent.begin(), tangent.end(), own.row(0).begin());
        } else {
            const Screw<double> known = motion.known_part(k);
            for (Index row = 0; row < 3; ++row) {
                right[row] = -known.direction[row];
                right[row + 3] = -known.moment[row];
            }
            double excess = 0.0;  // of the squared speed
            for (Index m = 1; m < k; ++m) {
                for (Index j = 0; j < count; ++j) excess += own(m, j) * own(k - m, j);
            }
            right[Closure::equation_count] = -0.5 * excess;
            factorization.solve(right, own.row(k));
        }
        spread(own.row(k), k, motion);
        for (Index j = 0; j < count; ++j) coefficients(k + 1, j) = own(k, j) / static_cast<double>(k + 1);
        if (k + 1 < order) motion.advance(k);
    }
}

}  // namespace detail

inline void Closure::series(Vector<const double> theta, Vector<const double> tangent,
                            const Factorization& factorization, View<double> coefficients) const {
    const auto spread = [](Vector<const double> own, Index k, MotionSeries& motion) {
        for (Index i = 0; i < static_cast<Index>(own.size()); ++i) motion.rate(k, i) = own[i];
    };
    detail::fill_series(*this, theta, theta, tangent, factorization, spread, coefficients);
}

inline void CoupledClosure::series(Vector<const double> unknowns, Vector<const double> tangent,
                                   const Factorization& factorization, View<double> coefficients) const {
    const auto spread = [this](Vector<const double> own, Index k, MotionSeries& motion) {
        for (Index i = 0; i < joints(); ++i) {
            double total = 0.0;
            for (Index j = 0; j < this->unknowns(); ++j) total += ratio(i, j) * own[j];
            motion.rate(k, i) = total;
        }
    };
    detail::fill_series(closure_, angles(unknowns), unknowns, tangent, factorization, spread, coefficients);
}

}  // namespace linkages
