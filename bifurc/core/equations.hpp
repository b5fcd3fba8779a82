// F and F' at many points at once, whatever makes them: compiled code, or a function of Python that
// takes long to be called.
#pragma once

#include <algorithm>
#include <vector>

#include "bifurc/core/valley.hpp"

namespace bifurc {

// F (m) and F' (m, n) at some points.
class Values {
public:
    explicit Values(Index unknowns) : unknowns_(unknowns) {}

    // Makes room for so many points, with F' or without.
    void reserve(Index points, Index equations, bool has_jacobians) {
        equations_ = equations;
        residuals_.resize(points * equations);
        if (has_jacobians) jacobians_.resize(points * equations * unknowns_);
    }

    Index equations() const { return equations_; }
    Vector<double> residual(Index point) { return {residuals_.data() + point * equations_, size(equations_)}; }
    View<double> jacobian(Index point) {
        return {jacobians_.data() + point * equations_ * unknowns_, equations_, unknowns_};
    }

private:
    static std::size_t size(Index count) { return static_cast<std::size_t>(count); }

    Index unknowns_, equations_ = 0;
    std::vector<double> residuals_, jacobians_;
};

// F: R^n -> R^m, over its magnitude.
class Equations {
public:
    virtual ~Equations() = default;

    virtual Index unknowns() const = 0;
    // As many points as are best taken at a time.
    virtual Index at_once() const = 0;
    // Whether F at two points next to each other are values of one function.
    virtual bool is_continuous() const { return true; }
    // F at points (k, n), with F' or without.
    virtual void fill(View<const double> points, bool has_jacobians, Values& values) const = 0;
    // F''(v, .) at a point for each v of ``directions`` (d, n): (d * m, n).
    virtual void bend(Vector<const double> point, View<const double> directions, View<double> out) const = 0;
};

// F''(v, .) for each v of ``directions`` (d, n), from F'' (m * n, n): (d * m, n).
inline void bend_by(View<const double> hessian, View<const double> directions, View<double> out) {
    const Index n = directions.columns, m = hessian.rows / n;
    std::fill_n(out.data, out.rows * n, 0.0);
    for (Index d = 0; d < directions.rows; ++d) {
        for (Index row = 0; row < m; ++row) {
            for (Index i = 0; i < n; ++i) {
                for (Index j = 0; j < n; ++j) out(d * m + row, j) += directions(d, i) * hessian(row * n + i, j);
            }
        }
    }
}

// Those of a compiled system over a ``magnitude``; ``Owner`` holds what the system refers to.
template <CurvedSystem S, class Owner>
class EquationsOf : public Equations {
public:
    // ``make`` gives the system of an owner.
    template <class Make>
    EquationsOf(Owner owner, Make make, double magnitude)
        : owner_(std::move(owner)), system_(make(owner_)), magnitude_(magnitude) {}

    Index unknowns() const override { return system_.unknowns(); }
    Index at_once() const override { return few; }

    void fill(View<const double> points, bool has_jacobians, Values& values) const override {
        values.reserve(points.rows, system_.equations(), has_jacobians);
        const Index count = points.rows, m = system_.equations();
        const View<double> residuals{values.residual(0).data(), count, m};
        const View<double> jacobians{values.jacobian(0).data, has_jacobians ? count * m : 0, unknowns()};
        linearize_all<S>(system_, points, residuals, jacobians);
        divide({residuals.data, static_cast<std::size_t>(count * m)});
        divide({jacobians.data, static_cast<std::size_t>(jacobians.rows * unknowns())});
    }

    void bend(Vector<const double> point, View<const double> directions, View<double> out) const override {
        if constexpr (requires { system_.bends(point, directions, out); }) {
            system_.bends(point, directions, out);
        } else {
            const Index m = system_.equations(), n = unknowns();
            Matrix<double> hessian(m * n, n);
            system_.hessian(point, hessian);
            bend_by(hessian, directions, out);
        }
        divide({out.data, static_cast<std::size_t>(out.rows * out.columns)});
    }

private:
    static constexpr Index few = 32;  // whose derivatives stay in the cache of the processor

    void divide(Vector<double> entries) const {
        if (magnitude_ == 1.0) return;
        for (double& entry : entries) entry /= magnitude_;
    }

    Owner owner_;
    S system_;
    double magnitude_;
};

}  // namespace bifurc
