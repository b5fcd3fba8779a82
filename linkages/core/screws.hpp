// Vectors in space, quaternions and screws, over any kind of number.
#pragma once

#include <array>

#include "bifurc/core/arrays.hpp"

namespace linkages {

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

}  // namespace linkages
