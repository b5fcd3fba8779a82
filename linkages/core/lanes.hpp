// Four numbers at a time: the same operation on all of them, in vector registers where the compiler
// knows how, and without a change in any bit.
#pragma once

#include <array>
#include <cstring>

// A function that is compiled twice, with all that it calls, where the processor may have wider
// registers. The bits are the same either way: nothing is contracted or reordered.
#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && !defined(__clang__)
#define LINKAGES_VECTORISED __attribute__((target_clones("avx2", "default"), noinline, flatten))
#elif defined(__GNUC__)
#define LINKAGES_VECTORISED __attribute__((flatten))
#else
#define LINKAGES_VECTORISED
#endif

namespace linkages {

inline constexpr int lane_count = 4;

// As they lie in memory.
using Lanes = std::array<double, lane_count>;

inline double sum(const Lanes& a) { return (a[0] + a[1]) + (a[2] + a[3]); }

// As they are computed with.
#if defined(__GNUC__)

// functions that take or return them are inlined, whatever registers the processor has
#pragma GCC diagnostic ignored "-Wpsabi"

using Packed = double __attribute__((vector_size(lane_count * sizeof(double))));

// x where a < b, else y.
inline Packed where_less(const Packed& a, const Packed& b, const Packed& x, const Packed& y) {
    return a < b ? x : y;
}

#else

struct Packed {
    double lanes[lane_count];

    double operator[](int lane) const { return lanes[lane]; }
    double& operator[](int lane) { return lanes[lane]; }
};

inline Packed where_less(const Packed& a, const Packed& b, const Packed& x, const Packed& y) {
    Packed out;
    for (int i = 0; i < lane_count; ++i) out.lanes[i] = a.lanes[i] < b.lanes[i] ? x.lanes[i] : y.lanes[i];
    return out;
}

inline Packed operator*(double factor, const Packed& a) {
    Packed out;
    for (int i = 0; i < lane_count; ++i) out.lanes[i] = factor * a.lanes[i];
    return out;
}

inline Packed operator/(double a, const Packed& b) {
    Packed out;
    for (int i = 0; i < lane_count; ++i) out.lanes[i] = a / b.lanes[i];
    return out;
}

inline Packed operator/(const Packed& a, const Packed& b) {
    Packed out;
    for (int i = 0; i < lane_count; ++i) out.lanes[i] = a.lanes[i] / b.lanes[i];
    return out;
}

inline Packed operator+(const Packed& a, const Packed& b) {
    Packed out;
    for (int i = 0; i < lane_count; ++i) out.lanes[i] = a.lanes[i] + b.lanes[i];
    return out;
}

inline Packed operator-(const Packed& a, const Packed& b) {
    Packed out;
    for (int i = 0; i < lane_count; ++i) out.lanes[i] = a.lanes[i] - b.lanes[i];
    return out;
}

inline Packed operator*(const Packed& a, const Packed& b) {
    Packed out;
    for (int i = 0; i < lane_count; ++i) out.lanes[i] = a.lanes[i] * b.lanes[i];
    return out;
}

#endif

}  // namespace linkages
