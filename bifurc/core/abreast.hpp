// Numbers of some points side by side: a tape is run through once for all of them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "bifurc/core/arrays.hpp"

namespace bifurc {

// A number of each of some points. What it makes of them is what doubles make of each.
struct Abreast {
    static constexpr Index lanes = 4;
    std::array<double, lanes> at;

    Abreast() : at{} {}
    Abreast(double value) { at.fill(value); }

    template <class F>
    static Abreast each(F of) {
        Abreast out;
        for (Index lane = 0; lane < lanes; ++lane) out.at[lane] = of(lane);
        return out;
    }

    bool are_finite() const {
        return std::all_of(at.begin(), at.end(), [](double value) { return std::isfinite(value); });
    }

    Abreast operator-() const { return each([&](Index lane) { return -at[lane]; }); }
    Abreast& operator+=(const Abreast& other) { return *this = *this + other; }
    Abreast& operator-=(const Abreast& other) { return *this = *this - other; }

    friend Abreast operator+(const Abreast& a, const Abreast& b) { return both(a, b, std::plus<>()); }
    friend Abreast operator-(const Abreast& a, const Abreast& b) { return both(a, b, std::minus<>()); }
    friend Abreast operator*(const Abreast& a, const Abreast& b) { return both(a, b, std::multiplies<>()); }
    friend Abreast operator/(const Abreast& a, const Abreast& b) { return both(a, b, std::divides<>()); }

    template <class F>
    static Abreast both(const Abreast& a, const Abreast& b, F of) {
        return each([&](Index lane) { return of(a.at[lane], b.at[lane]); });
    }
};

}  // namespace bifurc
