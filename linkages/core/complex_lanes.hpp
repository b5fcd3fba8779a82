// Four complex numbers at a time.
#pragma once

#include <cmath>

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

inline ComplexLanes operator+(const ComplexLanes& a, const ComplexLanes& b) { return {a.re + b.re, a.im + b.im}; }

inline ComplexLanes operator-(const ComplexLanes& a, const ComplexLanes& b) { return {a.re - b.re, a.im - b.im}; }

inline ComplexLanes operator*(const ComplexLanes& a, const ComplexLanes& b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

inline ComplexLanes operator*(double factor, const ComplexLanes& a) {
    const Packed all{factor, factor, factor, factor};
    return {all * a.re, all * a.im};
}

inline ComplexLanes inverse(const ComplexLanes& a) {
    const Packed square = a.re * a.re + a.im * a.im;
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

}  // namespace linkages
