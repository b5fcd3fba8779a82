// Dense arrays by rows: what the numerical headers work on.
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

namespace bifurc {

using Index = std::ptrdiff_t;

// A vector that belongs to somebody else.
template <class T>
using Vector = std::span<T>;

// A matrix that belongs to somebody else; rows lie one after the other.
template <class T>
struct View {
    T* data;
    Index rows;
    Index columns;

    T& operator()(Index row, Index column) const { return data[row * columns + column]; }
    Vector<T> row(Index number) const {
        return {data + number * columns, static_cast<std::size_t>(columns)};
    }
    View<T> first_rows(Index count) const { return {data, count, columns}; }
    operator View<const T>() const
        requires(!std::is_const_v<T>)
    {
        return {data, rows, columns};
    }
};

// A matrix with memory of its own, zero at first.
template <class T>
class Matrix {
public:
    Matrix(Index rows, Index columns) : rows_(rows), columns_(columns), values_(rows * columns) {}

    Index rows() const { return rows_; }
    Index columns() const { return columns_; }
    T& operator()(Index row, Index column) { return values_[row * columns_ + column]; }
    const T& operator()(Index row, Index column) const { return values_[row * columns_ + column]; }
    Vector<T> row(Index number) { return view().row(number); }
    Vector<const T> row(Index number) const { return view().row(number); }
    View<T> view() { return {values_.data(), rows_, columns_}; }
    View<const T> view() const { return {values_.data(), rows_, columns_}; }
    operator View<T>() { return view(); }
    operator View<const T>() const { return view(); }

private:
    Index rows_;
    Index columns_;
    std::vector<T> values_;
};

// A matrix of a shape that the compiler knows.
template <class T, Index row_count, Index column_count>
struct SmallMatrix {
    std::array<T, row_count * column_count> values;

    T& operator()(Index row, Index column) { return values[row * column_count + column]; }
    const T& operator()(Index row, Index column) const { return values[row * column_count + column]; }
    operator View<T>() { return {values.data(), row_count, column_count}; }
};

inline double dot(Vector<const double> p, Vector<const double> q) {
    double total = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) total += p[i] * q[i];
    return total;
}

inline double squared_length(Vector<const double> values) { return dot(values, values); }

inline double length(Vector<const double> values) { return std::sqrt(squared_length(values)); }

inline double conjugate_of(double value) { return value; }
inline std::complex<double> conjugate_of(const std::complex<double>& value) { return std::conj(value); }

// p^* q
template <class T, std::size_t n>
T inner_product(const std::array<T, n>& p, const std::array<T, n>& q) {
    T total{};
    for (std::size_t i = 0; i < n; ++i) total += conjugate_of(p[i]) * q[i];
    return total;
}

template <class T, std::size_t n>
double squared_size(const std::array<T, n>& vector) {
    double total = 0.0;
    for (const T& entry : vector) total += std::norm(entry);
    return total;
}

}  // namespace bifurc
