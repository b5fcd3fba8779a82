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

using bifurc::DenseBordered;
using bifurc::Index;
using bifurc::Matrix;
using bifurc::Vector;
using bifurc::View;

// ``geometry`` (6, n): length and offset over the characteristic length, cosine and sine of the
// twist, cosine and sine of half the twist.
class Closure {
public:
    using Bordered = DenseBordered;
    using Damped = bifurc::DenseDamped;

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
        Frame<double> frame;
        std::array<double, 4> q{1.0, 0.0, 0.0, 0.0};
        for (Index i = 0; i < unknowns(); ++i) {
            visit(i, frame.joint());
            const Link<double> link{geometry_(0, i), geometry_(1, i), {geometry_(2, i), geometry_(3, i)}};
            const Turn<double> half = turn_by(0.5 * theta[i]);
            frame.advance(doubled(half), link);
            q = about_z(q, half.cosine, half.sine);
            q = about_x(q, geometry_(4, i), geometry_(5, i));
        }
        if (q[0] < 0.0) q = {-q[0], -q[1], -q[2], -q[3]};
        return {q, frame.origin};
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

    Bordered bordered() const { return {equations(), unknowns()}; }
    Damped damped() const { return {equations(), unknowns()}; }

    // Taylor coefficients (order + 1, n) of theta(s), s the arclength, from the factored [F'; t].
    void series(Vector<const double> theta, Vector<const double> tangent, const DenseBordered& bordered,
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

// The screws of four joints, lane by lane.
struct ScrewLanes {
    std::array<Lanes, 6> rows;

    Screw<double> lane(Index i) const {
        return {{rows[0][i], rows[1][i], rows[2][i]}, {rows[3][i], rows[4][i], rows[5][i]}};
    }
    void set_lane(Index i, const Screw<double>& screw) {
        for (Index row = 0; row < 3; ++row) {
            rows[row][i] = screw.direction[row];
            rows[row + 3][i] = screw.moment[row];
        }
    }
};

namespace lanes {

inline Packed load(const Lanes& from) {
    Packed out;
    std::memcpy(&out, from.data(), sizeof out);
    return out;
}

inline void store(const Packed& value, Lanes& to) { std::memcpy(to.data(), &value, sizeof value); }

// Coefficient k of the product of rates and screws, but for what the rates of order k add to it; every
// ``stride``-th entry belongs to a series.
LINKAGES_VECTORISED inline void multiply(const Lanes* rates, const ScrewLanes* screws, Index k, Index stride,
                                         ScrewLanes& product) {
    Packed total[6] = {};
    for (Index m = 1; m <= k; ++m) {
        const Packed rate = load(rates[(k - m) * stride]);
        const ScrewLanes& screw = screws[m * stride];
        for (int row = 0; row < 6; ++row) total[row] = total[row] + rate * load(screw.rows[row]);
    }
    for (int row = 0; row < 6; ++row) store(total[row], product.rows[row]);
}

// Adds a rate times a screw.
LINKAGES_VECTORISED inline void add_product(const Lanes& rates, const ScrewLanes& screws, ScrewLanes& product) {
    const Packed rate = load(rates);
    for (int row = 0; row < 6; ++row) {
        store(load(product.rows[row]) + rate * load(screws.rows[row]), product.rows[row]);
    }
}

// Coefficient k of the Lie bracket of two series, times ``share``.
LINKAGES_VECTORISED inline void bracket(const ScrewLanes* twists, const ScrewLanes* screws, Index k, Index stride,
                                        const Lanes& share, ScrewLanes& product) {
    Packed x{}, y{}, z{}, u{}, v{}, w{};  // of the direction and of the moment
    for (Index m = 0; m <= k; ++m) {
        const auto& left = twists[m * stride].rows;
        const auto& right = screws[(k - m) * stride].rows;
        const Packed a0 = load(left[0]), a1 = load(left[1]), a2 = load(left[2]);
        const Packed a3 = load(left[3]), a4 = load(left[4]), a5 = load(left[5]);
        const Packed b0 = load(right[0]), b1 = load(right[1]), b2 = load(right[2]);
        const Packed b3 = load(right[3]), b4 = load(right[4]), b5 = load(right[5]);
        x = x + (a1 * b2 - a2 * b1);
        y = y + (a2 * b0 - a0 * b2);
        z = z + (a0 * b1 - a1 * b0);
        u = u + ((a1 * b5 - a2 * b4) + (a4 * b2 - a5 * b1));
        v = v + ((a2 * b3 - a0 * b5) + (a5 * b0 - a3 * b2));
        w = w + ((a0 * b4 - a1 * b3) + (a3 * b1 - a4 * b0));
    }
    const Packed factor = load(share);
    store(factor * x, product.rows[0]);
    store(factor * y, product.rows[1]);
    store(factor * z, product.rows[2]);
    store(factor * u, product.rows[3]);
    store(factor * v, product.rows[4]);
    store(factor * w, product.rows[5]);
}

}  // namespace lanes

// The motion of a closed loop as series in the arclength, one order after the other. With S_i(s)
// the screw of joint i and V_i(s) the twist of the joints before it, dS_i/ds = [V_i, S_i] and
// sum_i S_i dtheta_i/ds = 0, |du/ds| = 1: every order takes one product of series and one solve.
// Joints stand four abreast.
class MotionSeries {
public:
    MotionSeries(Index joints, Index order)
        : joints_(joints),
          blocks_((joints + lane_count - 1) / lane_count),
          screws_((order + 1) * blocks_),
          twists_((order + 1) * blocks_),
          rates_(order * blocks_),
          products_(blocks_) {}

    void set_screw(Index joint, const Screw<double>& screw) {
        screws_[joint / lane_count].set_lane(joint % lane_count, screw);
    }
    double& rate(Index k, Index joint) { return rates_[k * blocks_ + joint / lane_count][joint % lane_count]; }

    // What is left of coefficient k of sum_i S_i dtheta_i/ds without the rates of order k.
    Screw<double> known_part(Index k) {
        Screw<double> total{};
        for (Index block = 0; block < blocks_; ++block) {
            ScrewLanes& product = products_[block];
            lanes::multiply(&rates_[block], &screws_[block], k, blocks_, product);
            for (Index row = 0; row < 3; ++row) {
                total.direction[row] += sum(product.rows[row]);
                total.moment[row] += sum(product.rows[row + 3]);
            }
        }
        return total;
    }

    // Coefficients k + 1 of the screws, once the rates of order k are known, after `known_part` of them.
    void advance(Index k) {
        Screw<double> twist{};
        for (Index block = 0; block < blocks_; ++block) {
            ScrewLanes& gained = products_[block];
            lanes::add_product(rates_[k * blocks_ + block], screws_[block], gained);
            const Index last = std::min<Index>(lane_count, joints_ - block * lane_count);
            for (Index i = 0; i < last; ++i) {
                twists_[k * blocks_ + block].set_lane(i, twist);
                twist = twist + gained.lane(i);
            }
        }
        Lanes share;
        share.fill(1.0 / static_cast<double>(k + 1));
        for (Index block = 0; block < blocks_; ++block) {
            lanes::bracket(&twists_[block], &screws_[block], k, blocks_, share, screws_[(k + 1) * blocks_ + block]);
        }
    }

private:
    Index joints_, blocks_;
    std::vector<ScrewLanes> screws_, twists_;  // coefficient by coefficient, block by block
    std::vector<Lanes> rates_;
    std::vector<ScrewLanes> products_;  // of rates and screws, of the coefficient that is made
};

inline void Closure::series(Vector<const double> theta, Vector<const double> tangent,
                            const DenseBordered& bordered, View<double> coefficients) const {
    const Index order = coefficients.rows - 1, count = coefficients.columns;
    MotionSeries motion(count, order);
    follow(theta, [&](Index i, const Screw<double>& screw) { motion.set_screw(i, screw); });
    Matrix<double> rates(order, count);
    std::vector<double> right(equation_count + 1);
    std::copy(theta.begin(), theta.end(), coefficients.row(0).begin());
    for (Index k = 0; k < order; ++k) {
        const Screw<double> known = motion.known_part(k);
        if (k == 0) {
            std::copy(tangent.begin(), tangent.end(), rates.row(0).begin());
        } else {
            for (Index row = 0; row < 3; ++row) {
                right[row] = -known.direction[row];
                right[row + 3] = -known.moment[row];
            }
            double excess = 0.0;  // of the squared speed
            for (Index m = 1; 2 * m < k; ++m) excess += 2.0 * bifurc::dot(rates.row(m), rates.row(k - m));
            if (k % 2 == 0) excess += bifurc::squared_length(rates.row(k / 2));
            right[equation_count] = -0.5 * excess;
            bordered.solve(right, rates.row(k));
        }
        for (Index i = 0; i < count; ++i) {
            motion.rate(k, i) = rates(k, i);
            coefficients(k + 1, i) = rates(k, i) / static_cast<double>(k + 1);
        }
        if (k + 1 < order) motion.advance(k);
    }
}

}  // namespace linkages
