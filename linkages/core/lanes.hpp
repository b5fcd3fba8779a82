// Four numbers at a time: the same operation on all of them, which compilers turn into vector
// instructions without a change in any bit.
#pragma once

#include <array>

namespace linkages {

struct Lanes : std::array<double, 4> {
    static constexpr int width = 4;
};

inline Lanes operator+(const Lanes& a, const Lanes& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]};
}

inline Lanes operator-(const Lanes& a, const Lanes& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]};
}

inline Lanes operator*(const Lanes& a, const Lanes& b) {
    return {a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]};
}

inline double sum(const Lanes& a) { return (a[0] + a[1]) + (a[2] + a[3]); }

}  // namespace linkages
