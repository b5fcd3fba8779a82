// Coefficient k of truncated Taylor series, from the coefficients before it.
//
// The recurrences of Moore (1966), as in Griewank and Walther (2008), chapter 13. Every
// elementary function here obeys y' = w x' or r y' = x' with a series w or r that is made of the
// same few operations: two rules serve all of them.
#pragma once

#include "bifurc/core/arrays.hpp"

namespace bifurc::series {

// Of a * b; only the coefficients of a from ``first`` to ``last`` have others of b that are not zero.
template <class T>
T product(const T* a, const T* b, Index k, Index first, Index last) {
    T total = a[first] * b[k - first];
    for (Index j = first + 1; j <= last; ++j) total += a[j] * b[k - j];
    return total;
}

// Of a * a: every mixed product counts twice.
template <class T>
T square(const T* a, Index k) {
    if (k == 0) return a[0] * a[0];
    T total = a[0] * a[k];
    for (Index j = 1; 2 * j < k; ++j) total += a[j] * a[k - j];
    total = total + total;
    if (k % 2 == 0) total += a[k / 2] * a[k / 2];
    return total;
}

// Of y = a / b, whose earlier coefficients are known.
template <class T>
T quotient(const T* a, const T* b, const T* y, Index k) {
    T total = a[k];
    for (Index j = 0; j < k; ++j) total -= y[j] * b[k - j];
    return total / b[0];
}

// Of y with y' = w x', k > 0; w is known before its coefficient k.
template <class T>
T from_rate(const T* w, const T* x, Index k) {
    T total = w[0] * (static_cast<double>(k) * x[k]);
    for (Index j = 1; j < k; ++j) total += w[k - j] * (static_cast<double>(j) * x[j]);
    return total / static_cast<double>(k);
}

// Of y with r y' = x', k > 0, whose earlier coefficients are known; so is r before its
// coefficient k.
template <class T>
T from_inverse_rate(const T* r, const T* x, const T* y, Index k) {
    T total = static_cast<double>(k) * x[k];
    for (Index j = 1; j < k; ++j) total -= r[k - j] * (static_cast<double>(j) * y[j]);
    return total / (static_cast<double>(k) * r[0]);
}

// Of the angle y of the vector (x, z), with r y' = x z' - z x' and r = x x + z z, k > 0.
template <class T>
T angle(const T* z, const T* x, const T* r, const T* y, Index k) {
    T total = static_cast<double>(k) * (x[0] * z[k] - z[0] * x[k]);
    for (Index j = 1; j < k; ++j) {
        total += static_cast<double>(j) * (x[k - j] * z[j] - z[k - j] * x[j] - r[k - j] * y[j]);
    }
    return total / (static_cast<double>(k) * r[0]);
}

}  // namespace bifurc::series
