// Vectors in space, quaternions and screws, over any kind of number.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <type_traits>

#include "bifurc/core/arrays.hpp"

namespace linkages {

using bifurc::Index;
using Complex = std::complex<double>;

template <class T>
struct Vec3 : std::array<T, 3> {};

template <class T>
Vec3<T> operator+(const Vec3<T>& a, const Vec3<T>& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

template <class T>
Vec3<T> operator-(const Vec3<T>& a, const Vec3<T>& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

template <class T>
Vec3<T> operator*(const T& factor, const Vec3<T>& a) {
    return {factor * a[0], factor * a[1], factor * a[2]};
}

template <class T>
    requires(!std::is_same_v<T, double>)
Vec3<T> operator*(double factor, const Vec3<T>& a) {
    return {factor * a[0], factor * a[1], factor * a[2]};
}

template <class T>
T dot(const Vec3<T>& a, const Vec3<T>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class T>
Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// A line, or a twist: direction over moment.
template <class T>
struct Screw {
    Vec3<T> direction;
    Vec3<T> moment;
};

template <class T>
Screw<T> operator+(const Screw<T>& a, const Screw<T>& b) {
    return {a.direction + b.direction, a.moment + b.moment};
}

template <class T>
Screw<T> operator*(const T& factor, const Screw<T>& a) {
    return {factor * a.direction, factor * a.moment};
}

template <class T>
    requires(!std::is_same_v<T, double>)
Screw<T> operator*(double factor, const Screw<T>& a) {
    return {factor * a.direction, factor * a.moment};
}

template <class T>
std::array<T, 6> entries(const Screw<T>& screw) {
    const auto& [w, v] = screw;
    return {w[0], w[1], w[2], v[0], v[1], v[2]};
}

// The Lie bracket [a, b].
template <class T>
Screw<T> bracket(const Screw<T>& a, const Screw<T>& b) {
    return {cross(a.direction, b.direction), cross(a.direction, b.moment) + cross(a.moment, b.direction)};
}

// Column ``number`` of a matrix (6, n) of screws.
template <class T>
Screw<T> column(bifurc::View<T> screws, bifurc::Index number) {
    return {{screws(0, number), screws(1, number), screws(2, number)},
            {screws(3, number), screws(4, number), screws(5, number)}};
}

template <class T>
void set_column(bifurc::View<T> screws, bifurc::Index number, const Screw<T>& screw) {
    for (bifurc::Index row = 0; row < 3; ++row) {
        screws(row, number) = screw.direction[row];
        screws(row + 3, number) = screw.moment[row];
    }
}

// q (c + k s): a quaternion (w, x, y, z), then a turn about z by an angle of which c and s are
// cosine and sine of a half.
template <class T>
std::array<T, 4> about_z(const std::array<T, 4>& q, const T& c, const T& s) {
    return {q[0] * c - q[3] * s, q[1] * c + q[2] * s, q[2] * c - q[1] * s, q[3] * c + q[0] * s};
}

// The same, about x.
template <class T>
std::array<T, 4> about_x(const std::array<T, 4>& q, const T& c, const T& s) {
    return {q[0] * c - q[1] * s, q[1] * c + q[0] * s, q[2] * c + q[3] * s, q[3] * c - q[2] * s};
}

// Cosine and sine of an angle.
template <class T>
struct Turn {
    T cosine;
    T sine;
};

template <class T>
Turn<T> doubled(const Turn<T>& turn) {
    return {turn.cosine * turn.cosine - turn.sine * turn.sine, 2.0 * (turn.cosine * turn.sine)};
}

inline Turn<double> turn_by(double angle) { return {std::cos(angle), std::sin(angle)}; }

inline Turn<Complex> turn_by(const Complex& angle) {
    const double c = std::cos(angle.real()), s = std::sin(angle.real());
    const double growth = std::exp(angle.imag());
    const double cosh = 0.5 * (growth + 1.0 / growth), sinh = 0.5 * (growth - 1.0 / growth);
    return {{c * cosh, -s * sinh}, {s * cosh, c * sinh}};
}

// A link between two joints; the twist as a turn.
template <class T>
struct Link {
    T length;
    T offset;
    Turn<T> twist;
};

// Axes and origin of a frame that goes through a loop, from joint to joint.
template <class T>
struct Frame {
    Vec3<T> x{T(1.0), T(0.0), T(0.0)};
    Vec3<T> y{T(0.0), T(1.0), T(0.0)};
    Vec3<T> z{T(0.0), T(0.0), T(1.0)};
    Vec3<T> origin{};

    // The axis of the joint, and the common normal about which the link is twisted.
    Screw<T> joint() const { return {z, cross(origin, z)}; }
    Screw<T> normal() const { return {x, cross(origin, x)}; }

    // Over a joint and its link; ``L`` is T, or double where only the angle is complex.
    template <class L>
    void advance(const Turn<T>& turn, const Link<L>& link) {
        const Vec3<T> u = turn.cosine * x + turn.sine * y;
        const Vec3<T> w = turn.cosine * y - turn.sine * x;
        origin = origin + link.offset * z + link.length * u;
        x = u;
        y = link.twist.cosine * w + link.twist.sine * z;
        z = link.twist.cosine * z - link.twist.sine * w;
    }

    // How far the frame is from the first one: skew part of the rotation, and translation. It
    // vanishes for half turns, too.
    Screw<T> skew_gap() const {
        const Vec3<T> skew{y[2] - z[1], z[0] - x[2], x[1] - y[0]};
        return {0.5 * skew, origin};
    }

    // The largest entry of the transform from the first frame, less the identity.
    double largest_gap() const {
        double largest = 0.0;
        const std::array<Vec3<T>, 3> axes{x, y, z};
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
                largest = std::max(largest, std::abs(axes[i][j] - (i == j ? 1.0 : 0.0)));
            }
            largest = std::max(largest, std::abs(origin[i]));
        }
        return largest;
    }
};

}  // namespace linkages
