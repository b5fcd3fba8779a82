// Four numbers at a time: the same operation on all of them, in vector registers where the compiler
// knows how, and without a change in any bit.
#pragma once

#include <array>
#include <cstring>

// A function that is compiled twice where the processor may have wider registers. The bits are the
// same either way: nothing is contracted or reordered.
#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && !defined(__clang__)
#define LINKAGES_VECTORISED __attribute__((target_clones("avx2", "default"), noinline))
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

using Packed = double __attribute__((vector_size(lane_count * sizeof(double))));

#else

struct Packed {
    double lanes[lane_count];
};

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
