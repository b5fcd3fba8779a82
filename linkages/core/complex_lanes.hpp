// Four complex numbers at a time, and what is written the same for one of them and for four.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "linkages/core/lanes.hpp"
#include "linkages/core/screws.hpp"

namespace linkages {

// Real and imaginary parts apart, so that a product needs no shuffles.
struct ComplexLanes {
    Packed re, im;

    ComplexLanes() = default;
    ComplexLanes(double value) : re{value, value, value, value}, im{} {}
    ComplexLanes(const Packed& real, const Packed& imaginary) : re(real), im(imaginary) {}
    explicit ComplexLanes(const Complex& value) {
        for (int lane = 0; lane < lane_count; ++lane) set(lane, value);
    }

    Complex at(int lane) const { return {re[lane], im[lane]}; }

    void set(int lane, const Complex& value) {
        re[lane] = value.real();
        im[lane] = value.imag();
    }

    ComplexLanes operator-() const { return {Packed{} - re, Packed{} - im}; }
};

inline ComplexLanes operator+(const ComplexLanes& a, const ComplexLanes& b) {
    return {a.re + b.re, a.im + b.im};
}

inline ComplexLanes operator-(const ComplexLanes& a, const ComplexLanes& b) {
    return {a.re - b.re, a.im - b.im};
}

inline ComplexLanes operator*(const ComplexLanes& a, const ComplexLanes& b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

inline ComplexLanes operator*(double factor, const ComplexLanes& a) {
    const Packed all{factor, factor, factor, factor};
    return {all * a.re, all * a.im};
}

inline ComplexLanes operator*(const Packed& factor, const ComplexLanes& a) {
    return {factor * a.re, factor * a.im};
}

inline ComplexLanes& operator+=(ComplexLanes& a, const ComplexLanes& b) { return a = a + b; }
inline ComplexLanes& operator-=(ComplexLanes& a, const ComplexLanes& b) { return a = a - b; }

// As those of one complex number.
inline Packed real(const ComplexLanes& a) { return a.re; }
inline Packed imag(const ComplexLanes& a) { return a.im; }
inline Packed norm(const ComplexLanes& a) { return a.re * a.re + a.im * a.im; }
inline ComplexLanes conj(const ComplexLanes& a) { return {a.re, Packed{} - a.im}; }

inline ComplexLanes inverse(const ComplexLanes& a) {
    const Packed square = norm(a);
    return {a.re / square, (Packed{} - a.im) / square};
}

// |re| + |im|.
inline Packed rough_size(const ComplexLanes& a) {
    const Packed zero{};
    return where_less(a.re, zero, zero - a.re, a.re) + where_less(a.im, zero, zero - a.im, a.im);
}

// 1, or -1 where the real part is negative.
inline ComplexLanes sign_of_real_part(const ComplexLanes& a) {
    const Packed zero{}, one{1.0, 1.0, 1.0, 1.0};
    return {where_less(a.re, zero, zero - one, one), zero};
}

// The real numbers that belong to complex ones: a double, or one of each lane.
template <class T>
using RealOf = decltype(norm(std::declval<T>()));

inline double root(double a) { return std::sqrt(a); }
inline double larger(double a, double b) { return std::max(a, b); }
inline double smaller(double a, double b) { return std::min(a, b); }

inline Packed root(const Packed& a) {
    Packed out;
    for (int lane = 0; lane < lane_count; ++lane) out[lane] = std::sqrt(a[lane]);
    return out;
}
inline Packed larger(const Packed& a, const Packed& b) { return where_less(a, b, b, a); }
inline Packed smaller(const Packed& a, const Packed& b) { return where_less(a, b, a, b); }

}  // namespace linkages
