// NumPy arrays as the views of `arrays.hpp`, and back.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <complex>
#include <initializer_list>
#include <memory>
#include <vector>

#include "bifurc/core/arrays.hpp"

namespace bifurc::numpy {

namespace nb = nanobind;

template <class T>
using VectorIn = nb::ndarray<const T, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
template <class T>
using MatrixIn = nb::ndarray<const T, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
template <class T>
using CubeIn = nb::ndarray<const T, nb::ndim<3>, nb::c_contig, nb::device::cpu>;

template <class T>
Vector<const T> view(const VectorIn<T>& array) {
    return {array.data(), array.shape(0)};
}

template <class T>
View<const T> view(const MatrixIn<T>& array) {
    return {array.data(), static_cast<Index>(array.shape(0)), static_cast<Index>(array.shape(1))};
}

// A cube (k, r, c) as a matrix (k * r, c).
template <class T>
View<const T> rows(const CubeIn<T>& array) {
    return {array.data(), static_cast<Index>(array.shape(0) * array.shape(1)), static_cast<Index>(array.shape(2))};
}

// A new array, zero at first, that is handed over to Python.
template <class T>
class Array {
public:
    explicit Array(std::initializer_list<Index> shape) {
        std::size_t size = 1;
        for (Index extent : shape) {
            shape_.push_back(static_cast<std::size_t>(extent));
            size *= static_cast<std::size_t>(extent);
        }
        values_ = std::make_unique<T[]>(size);
        size_ = size;
    }

    T* data() { return values_.get(); }
    Vector<T> vector() { return {data(), size_}; }
    // All but the last axis as rows.
    View<T> matrix() {
        const auto columns = static_cast<Index>(shape_.back());
        return {data(), columns ? static_cast<Index>(size_) / columns : 0, columns};
    }
    // Entry ``number`` of the first axis, its last axis as columns.
    View<T> entry(Index number) {
        const auto columns = static_cast<Index>(shape_.back());
        const Index of_entry = static_cast<Index>(size_ / shape_.front());
        return {data() + number * of_entry, columns ? of_entry / columns : 0, columns};
    }
    void fill(Vector<const T> values) { std::copy(values.begin(), values.end(), data()); }

    // The array as a NumPy array; nothing is left here.
    nb::object release() {
        T* const data = values_.release();
        nb::capsule owner(data, [](void* memory) noexcept { delete[] static_cast<T*>(memory); });
        return nb::cast(nb::ndarray<nb::numpy, T>(data, shape_.size(), shape_.data(), owner));
    }

private:
    std::vector<std::size_t> shape_;
    std::unique_ptr<T[]> values_;
    std::size_t size_ = 0;
};

}  // namespace bifurc::numpy
