// Unit dual quaternions: the displacements of links and joints, and of a loop of them.
#pragma once

#include <array>
#include <complex>

#include "linkages/core/screws.hpp"

namespace linkages {

// (w, x, y, z) of a rotation, and the same of the dual part.
template <class T>
struct DualQuaternion : std::array<T, 8> {};

namespace detail {

// The product of the quaternions that start at entry i of p and entry j of q.
template <class P, class Q>
auto quaternion_product(const DualQuaternion<P>& p, int i, const DualQuaternion<Q>& q, int j) {
    const P &a = p[i], &b = p[i + 1], &c = p[i + 2], &d = p[i + 3];
    const Q &w = q[j], &x = q[j + 1], &y = q[j + 2], &z = q[j + 3];
    return std::array{a * w - b * x - c * y - d * z, a * x + b * w + c * z - d * y,
                      a * y - b * z + c * w + d * x, a * z + b * y - c * x + d * w};
}

}  // namespace detail

template <class P, class Q>
auto operator*(const DualQuaternion<P>& p, const DualQuaternion<Q>& q) {
    const auto real = detail::quaternion_product(p, 0, q, 0);
    const auto first = detail::quaternion_product(p, 0, q, 4);
    const auto second = detail::quaternion_product(p, 4, q, 0);
    DualQuaternion<decltype(P{} * Q{})> out;
    for (int r = 0; r < 4; ++r) {
        out[r] = real[r];
        out[r + 4] = first[r] + second[r];
    }
    return out;
}

// The vector parts of a product, of rotation and translation.
template <class T>
std::array<T, 6> product_vectors(const DualQuaternion<T>& p, const DualQuaternion<T>& q) {
    const auto real = detail::quaternion_product(p, 0, q, 0);
    const auto first = detail::quaternion_product(p, 0, q, 4);
    const auto second = detail::quaternion_product(p, 4, q, 0);
    return {real[1], real[2], real[3], first[1] + second[1], first[2] + second[2], first[3] + second[3]};
}

template <class T>
DualQuaternion<T> conjugate(const DualQuaternion<T>& q) {
    return {q[0], -q[1], -q[2], -q[3], q[4], -q[5], -q[6], -q[7]};
}

// k q: half a turn about z.
template <class T>
DualQuaternion<T> half_turned(const DualQuaternion<T>& q) {
    return {-q[3], -q[2], q[1], q[0], -q[7], -q[6], q[5], q[4]};
}

// (cos + k sin) q with cosine and sine of half an angle.
template <class T, class Q>
DualQuaternion<T> turned(const Turn<T>& half, const DualQuaternion<Q>& q) {
    const DualQuaternion<Q> side = half_turned(q);
    DualQuaternion<T> out;
    for (int r = 0; r < 8; ++r) out[r] = half.cosine * q[r] + half.sine * side[r];
    return out;
}

// Tz(offset) Tx(length) Rx(twist), the turn being half the twist.
template <class T>
DualQuaternion<T> link_quaternion(const T& length, const T& offset, const Turn<T>& half_twist) {
    const T &c = half_twist.cosine, &s = half_twist.sine;
    return {c,
            s,
            T(0.0),
            T(0.0),
            -0.5 * (length * s),
            0.5 * (length * c),
            0.5 * (offset * s),
            0.5 * (offset * c)};
}

// Twice the vector parts, of rotation and translation.
template <class T>
std::array<T, 6> vector_parts(const DualQuaternion<T>& q) {
    return {2.0 * q[1], 2.0 * q[2], 2.0 * q[3], 2.0 * q[5], 2.0 * q[6], 2.0 * q[7]};
}

// The closure error of a chain, to first order rotation vector and translation, with its
// derivatives by the joints. Half turns are no ghosts: the vector part of a quaternion vanishes
// for the identity only. Where angles have large imaginary parts, the entries of a quaternion grow
// with half of these, and it takes many digits less than a matrix.
template <class T, std::size_t n>
struct ChainClosure {
    std::array<T, 6> error;
    std::array<std::array<T, 6>, n> derivatives;
};

template <class T>
double sign_of_real_part(const T& value) {
    return std::real(value) >= 0.0 ? 1.0 : -1.0;
}

// From half the angles as turns; ``links`` follow the joints.
template <class T, class L, std::size_t n>
ChainClosure<T, n> close_chain(const std::array<DualQuaternion<L>, n>& links,
                               const std::array<Turn<T>, n>& halves) {
    std::array<DualQuaternion<T>, n> steps, after;  // a joint and its link; joint i and all that follows it
    for (std::size_t i = 0; i < n; ++i) steps[i] = turned(halves[i], links[i]);
    after[n - 1] = steps[n - 1];
    for (std::size_t i = n - 1; i-- > 0;) after[i] = steps[i] * after[i + 1];
    const auto sign = sign_of_real_part(after[0][0]);  // both are the same displacement
    ChainClosure<T, n> out;
    out.error = vector_parts(after[0]);
    for (T& entry : out.error) entry = sign * entry;
    DualQuaternion<T> before{T(sign)};
    for (std::size_t i = 0; i < n; ++i) {
        out.derivatives[i] = product_vectors(before, half_turned(after[i]));
        if (i + 1 < n) before = before * steps[i];
    }
    return out;
}

template <class T, class L, std::size_t n>
ChainClosure<T, n> close_chain(const std::array<DualQuaternion<L>, n>& links,
                               const std::array<T, n>& angles) {
    std::array<Turn<T>, n> halves;
    for (std::size_t i = 0; i < n; ++i) halves[i] = turn_by(0.5 * angles[i]);
    return close_chain(links, halves);
}

}  // namespace linkages
