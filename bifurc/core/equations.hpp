// F and F' at many points at once, whatever makes them: compiled code, or a function of Python that
// takes long to be called.
#pragma once

#include <algorithm>
#include <vector>

#include "bifurc/core/valley.hpp"

namespace bifurc {

// F (m), F' (m, n) and F'' (m * n, n) at some points.
class Values {
public:
    explicit Values(Index unknowns) : unknowns_(unknowns) {}

    // Makes room for so many points, with F' or without.
    void reserve(Index points, Index equations, bool has_jacobians) {
        equations_ = equations;
        residuals_.resize(points * equations);
        if (has_jacobians) jacobians_.resize(points * equations * unknowns_);
    }

    // Makes room for second derivatives.
    void reserve_second(Index points) { hessians_.resize(points * equations_ * unknowns_ * unknowns_); }

    Index equations() const { return equations_; }
    Vector<double> residual(Index point) { return {residuals_.data() + point * equations_, size(equations_)}; }
    View<double> jacobian(Index point) {
        return {jacobians_.data() + point * equations_ * unknowns_, equations_, unknowns_};
    }
    View<double> hessian(Index point) {
        const Index rows = equations_ * unknowns_;
        return {hessians_.data() + point * rows * unknowns_, rows, unknowns_};
    }

private:
    static std::size_t size(Index count) { return static_cast<std::size_t>(count); }

    Index unknowns_, equations_ = 0;
    std::vector<double> residuals_, jacobians_, hessians_;
};

// F: R^n -> R^m, over its magnitude.
class Equations {
public:
    virtual ~Equations() = default;

    virtual Index unknowns() const = 0;
    // As many points as are best taken at a time.
    virtual Index at_once() const = 0;
    // F at points (k, n), with F' or without.
    virtual void fill(View<const double> points, bool has_jacobians, Values& values) const = 0;
    // F'' beside F and F'.
    virtual void fill_second(View<const double> points, Values& values) const = 0;
};

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
        for (Index k = 0; k < points.rows; ++k) {
            if (has_jacobians) system_.linearize(points.row(k), values.residual(k), values.jacobian(k));
            else system_.residual(points.row(k), values.residual(k));
            divide(values.residual(k));
            if (has_jacobians) divide({values.jacobian(k).data, static_cast<std::size_t>(system_.equations() * system_.unknowns())});
        }
    }

    void fill_second(View<const double> points, Values& values) const override {
        fill(points, true, values);
        values.reserve_second(points.rows);
        for (Index k = 0; k < points.rows; ++k) {
            const View<double> hessian = values.hessian(k);
            system_.hessian(points.row(k), hessian);
            divide({hessian.data, static_cast<std::size_t>(hessian.rows * hessian.columns)});
        }
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
