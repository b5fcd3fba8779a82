// Equations as data: a list of operations, one interpreter over any kind of number.
//
// A tape is what is left of a user's equations once they are recorded (`bifurc.recording`).
// Every operation writes one slot. Values come from one sweep over the slots; exact first
// derivatives from a second sweep with the partial derivatives of each operation, forwards or
// backwards; second derivatives and Taylor series from one rule for each kind of operation.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bifurc/core/abreast.hpp"
#include "bifurc/core/arrays.hpp"
#include "bifurc/core/bordered.hpp"
#include "bifurc/core/damped.hpp"
#include "bifurc/core/interval.hpp"
#include "bifurc/core/series.hpp"

namespace bifurc {

// As in `bifurc.recording.Operation`. ``left`` and ``right`` are slots, ``constant`` is a number.
enum class Operation : int {
    unknown,   // number ``left``
    constant,  // ``constant``
    add,       // left + right
    subtract,  // left - right
    multiply,  // left * right
    divide,    // left / right
    shift,     // left + constant
    scale,     // left * constant
    over,      // left / constant
    power,     // left ^ constant
    exp,
    expm1,
    log,
    log1p,
    sqrt,
    cbrt,
    sin,
    cos,
    tan,
    asin,
    acos,
    atan,
    sinh,
    cosh,
    tanh,
    asinh,
    acosh,
    atanh,
    angle,  // atan2(left, right)
};
constexpr int operation_count = 29;

// How the derivative of an operation y of x = left comes about. ``rule`` is the slot of w or r.
enum class Rule {
    leaf,          // no operand
    sum,           // y = left + right
    difference,    // y = left - right
    shifted,       // y' = left'
    scaled,        // y' = c left'
    product,       // y = left * right
    quotient,      // y = left / right
    rate,          // y' = w x'
    inverse_rate,  // r y' = x'
    angle,         // r y' = right left' - left right'
};

struct Instruction {
    Operation operation;
    Index left;
    Index right;
    Index rule;
    double constant;
};

inline Rule rule_of(Operation operation) {
    switch (operation) {
        case Operation::unknown:
        case Operation::constant: return Rule::leaf;
        case Operation::add: return Rule::sum;
        case Operation::subtract: return Rule::difference;
        case Operation::shift: return Rule::shifted;
        case Operation::scale:
        case Operation::over: return Rule::scaled;
        case Operation::multiply: return Rule::product;
        case Operation::divide: return Rule::quotient;
        case Operation::angle: return Rule::angle;
        case Operation::power:
        case Operation::exp:
        case Operation::expm1:
        case Operation::sin:
        case Operation::cos:
        case Operation::tan:
        case Operation::sinh:
        case Operation::cosh:
        case Operation::tanh: return Rule::rate;
        default: return Rule::inverse_rate;
    }
}

// --- functions that the library has not for every kind of number ---------------------------------

namespace functions {

using Complex = std::complex<double>;

inline double square(double x) { return x * x; }
inline Complex square(const Complex& z) { return z * z; }
inline Complex expm1(const Complex& z) {
    const double half = std::sin(0.5 * z.imag());
    const double real = std::expm1(z.real()) * std::cos(z.imag()) - 2.0 * half * half;
    return {real, std::exp(z.real()) * std::sin(z.imag())};
}
inline Complex log1p(const Complex& z) {
    const double x = z.real(), y = z.imag();
    return {0.5 * std::log1p(x * (2.0 + x) + y * y), std::atan2(y, 1.0 + x)};
}
// Real on the real line on both sides of 0.
inline Complex cbrt(const Complex& z) {
    constexpr double third = 1.0 / 3.0;
    return z.real() < 0.0 ? -std::pow(-z, third) : std::pow(z, third);
}
inline bool is_infinite(double x) { return std::isinf(x); }
inline bool is_infinite(const Complex& z) { return std::isinf(z.real()) || std::isinf(z.imag()); }
inline bool is_infinite(const Interval&) { return false; }
inline bool is_infinite(const Abreast&) { return false; }  // where doubles end points are looked at one by one
// The angle of the vector (x, z), analytic in both; by the larger of them, so that small
// imaginary parts are kept.
inline Complex atan2(const Complex& z, const Complex& x) {
    constexpr double pi = std::numbers::pi;
    if (std::abs(x.real()) < std::abs(z.real())) return std::copysign(0.5 * pi, z.real()) - std::atan(x / z);
    const double turn = x.real() < 0.0 ? std::copysign(pi, z.real()) : 0.0;
    return std::atan(z / x) + turn;
}

}  // namespace functions

inline bool is_linear(Rule rule) { return rule >= Rule::sum && rule <= Rule::scaled; }

// What an operation makes of the values of its operands.
template <class T>
T value_of(const Instruction& instruction, const T& left, const T& right) {
    using functions::atan2, functions::cbrt, functions::expm1, functions::log1p, functions::square;
    using std::acos, std::acosh, std::asin, std::asinh, std::atan, std::atan2, std::atanh, std::cbrt, std::cos,
        std::cosh, std::exp, std::expm1, std::log, std::log1p, std::pow, std::sin, std::sinh, std::sqrt, std::tan,
        std::tanh;
    switch (instruction.operation) {
        case Operation::add: return left + right;
        case Operation::subtract: return left - right;
        case Operation::multiply: return instruction.left == instruction.right ? square(left) : left * right;
        case Operation::divide: return left / right;
        case Operation::shift: return left + T(instruction.constant);
        case Operation::scale: return left * T(instruction.constant);
        case Operation::over: return left / T(instruction.constant);
        case Operation::power: return pow(left, instruction.constant);
        case Operation::exp: return exp(left);
        case Operation::expm1: return expm1(left);
        case Operation::log: return log(left);
        case Operation::log1p: return log1p(left);
        case Operation::sqrt: return sqrt(left);
        case Operation::cbrt: return cbrt(left);
        case Operation::sin: return sin(left);
        case Operation::cos: return cos(left);
        case Operation::tan: return tan(left);
        case Operation::asin: return asin(left);
        case Operation::acos: return acos(left);
        case Operation::atan: return atan(left);
        case Operation::sinh: return sinh(left);
        case Operation::cosh: return cosh(left);
        case Operation::tanh: return tanh(left);
        case Operation::asinh: return asinh(left);
        case Operation::acosh: return acosh(left);
        case Operation::atanh: return atanh(left);
        case Operation::angle: return atan2(left, right);
        default: return T(instruction.constant);
    }
}

// Operations other than of arithmetic are made at one point after the other.
template <>
inline Abreast value_of(const Instruction& instruction, const Abreast& left, const Abreast& right) {
    switch (instruction.operation) {
        case Operation::add: return left + right;
        case Operation::subtract: return left - right;
        case Operation::multiply: return left * right;
        case Operation::divide: return left / right;
        case Operation::shift: return left + Abreast(instruction.constant);
        case Operation::scale: return left * Abreast(instruction.constant);
        case Operation::over: return left / Abreast(instruction.constant);
        default: break;
    }
    return Abreast::both(left, right, [&](double one, double other) { return value_of(instruction, one, other); });
}

// --- the tape --------------------------------------------------------------------------------------

// Partial derivatives of one operation by its operands.
template <class T>
struct Partials {
    T left{};
    T right{};
};

class Tape {
public:
    // Raises `std::invalid_argument` unless every operand stands before the operation on it.
    Tape(Index unknowns, std::vector<Instruction> instructions, std::vector<Index> outputs)
        : unknowns_(unknowns), instructions_(std::move(instructions)), outputs_(std::move(outputs)) {
        for (Index slot = 0; slot < slots(); ++slot) check(slot);
        for (Index output : outputs_) check_slot(output, slots());
        for (const Instruction& instruction : instructions_) rules_.push_back(rule_of(instruction.operation));
        find_cones();
    }

    Index unknowns() const { return unknowns_; }
    Index equations() const { return static_cast<Index>(outputs_.size()); }
    Index slots() const { return static_cast<Index>(instructions_.size()); }
    Index output(Index equation) const { return outputs_[equation]; }
    const Instruction& operator[](Index slot) const { return instructions_[slot]; }
    Rule rule(Index slot) const { return rules_[slot]; }

    // Slots of the values that an equation is made of, the last first.
    Vector<const Index> cone(Index equation) const { return cones_[equation]; }
    // Numbers of the unknowns that an equation is made of, in order.
    Vector<const Index> unknowns_of(Index equation) const { return unknowns_of_[equation]; }
    // Where F' has entries.
    SparsityPattern pattern() const {
        SparsityPattern pattern{unknowns_, {0}, {}};
        for (const std::vector<Index>& row : unknowns_of_) {
            pattern.entries.insert(pattern.entries.end(), row.begin(), row.end());
            pattern.starts.push_back(static_cast<Index>(pattern.entries.size()));
        }
        return pattern;
    }
    // That, and the order in which columns are eliminated. Not for two threads at once when it is called
    // first.
    const Sparsity& sparsity() const {
        if (!sparsity_) sparsity_ = std::make_unique<Sparsity>(pattern());
        return *sparsity_;
    }
    // Operations that a gradient of all equations takes, one after the other.
    Index reverse_cost() const { return reverse_cost_; }

    // Values of the equations alone, in ``values`` (slots).
    template <class T>
    void evaluate(Vector<const T> point, Vector<T> values) const {
        for (Index slot : needed_) set_value(slot, point, values);
    }

    // Values of all slots, also of those that derivatives only are made of.
    template <class T>
    void evaluate_all(Vector<const T> point, Vector<T> values) const {
        for (Index slot = 0; slot < slots(); ++slot) set_value(slot, point, values);
    }

    // Whether the ``value`` of a slot is infinite because doubles end there, and not because it has a
    // pole. What is finite and made of it, as 1 / (1 + exp(1000)) is, does not depend on it any more: its
    // derivatives count as zero.
    template <class T>
    bool is_overflow(Index slot, const T& value) const {
        if (!functions::is_infinite(value)) return false;
        switch (instructions_[slot].operation) {
            case Operation::multiply:
            case Operation::exp:
            case Operation::expm1:
            case Operation::sinh:
            case Operation::cosh: return true;
            case Operation::power: return instructions_[slot].constant > 0.0;
            default: return false;
        }
    }

    // The partial derivatives of the operation of a slot, from the values of all.
    template <class T>
    Partials<T> partials(Index slot, Vector<const T> values) const {
        const Instruction& instruction = instructions_[slot];
        if (is_overflow(slot, values[slot])) return {};
        const T& rule = values[instruction.rule];
        switch (rules_[slot]) {
            case Rule::sum: return {T(1.0), T(1.0)};
            case Rule::difference: return {T(1.0), T(-1.0)};
            case Rule::shifted: return {T(1.0), T(0.0)};
            case Rule::scaled: {
                const T factor(instruction.constant);
                return {instruction.operation == Operation::scale ? factor : T(1.0) / factor, T(0.0)};
            }
            case Rule::product: return {values[instruction.right], values[instruction.left]};
            case Rule::quotient: {
                const T inverse = T(1.0) / values[instruction.right];
                return {inverse, -(values[slot] * inverse)};
            }
            case Rule::rate: return {rule, T(0.0)};
            case Rule::inverse_rate: return {T(1.0) / rule, T(0.0)};
            case Rule::angle: return {values[instruction.right] / rule, -(values[instruction.left] / rule)};
            default: return {};
        }
    }

    static bool has_left(Operation operation) {
        return operation != Operation::unknown && operation != Operation::constant;
    }
    static bool has_right(Operation operation) {
        return operation == Operation::add || operation == Operation::subtract || operation == Operation::multiply ||
               operation == Operation::divide || operation == Operation::angle;
    }

private:
    template <class T>
    void set_value(Index slot, Vector<const T> point, Vector<T> values) const {
        const Instruction& instruction = instructions_[slot];
        if (instruction.operation == Operation::unknown) {
            values[slot] = point[instruction.left];
        } else {
            values[slot] = value_of(instruction, values[instruction.left], values[instruction.right]);
        }
    }

    void check(Index slot) const {
        const Instruction& instruction = instructions_[slot];
        const int code = static_cast<int>(instruction.operation);
        if (code < 0 || code >= operation_count) throw std::invalid_argument("there is no such operation");
        if (instruction.operation == Operation::unknown) {
            check_slot(instruction.left, unknowns_);
        } else if (has_left(instruction.operation)) {
            check_slot(instruction.left, slot);
        }
        if (has_right(instruction.operation)) check_slot(instruction.right, slot);
        check_slot(instruction.rule, slots());
    }

    static void check_slot(Index slot, Index end) {
        if (slot < 0 || slot >= end) {
            throw std::invalid_argument("operand " + std::to_string(slot) + " is not allowed; it must be from 0 to " +
                                        std::to_string(end - 1));
        }
    }

    void find_cones() {
        std::vector<Index> seen(instructions_.size(), -1);  // the last equation whose cone has the slot
        std::vector<bool> is_needed(instructions_.size(), false);
        for (Index equation = 0; equation < equations(); ++equation) {
            std::vector<Index> cone{outputs_[equation]}, unknowns;
            seen[outputs_[equation]] = equation;
            const auto visit = [&](Index slot) {
                if (seen[slot] == equation) return;
                seen[slot] = equation;
                cone.push_back(slot);
            };
            for (std::size_t next = 0; next < cone.size(); ++next) {
                const Instruction instruction = instructions_[cone[next]];
                is_needed[cone[next]] = true;
                if (instruction.operation == Operation::unknown) unknowns.push_back(instruction.left);
                if (has_left(instruction.operation)) visit(instruction.left);
                if (has_right(instruction.operation)) visit(instruction.right);
            }
            std::sort(cone.rbegin(), cone.rend());
            std::sort(unknowns.begin(), unknowns.end());
            unknowns.erase(std::unique(unknowns.begin(), unknowns.end()), unknowns.end());
            reverse_cost_ += static_cast<Index>(cone.size());
            cones_.push_back(std::move(cone));
            unknowns_of_.push_back(std::move(unknowns));
        }
        for (Index slot = 0; slot < slots(); ++slot) {
            if (is_needed[slot]) needed_.push_back(slot);
        }
    }

    Index unknowns_;
    std::vector<Instruction> instructions_;
    std::vector<Rule> rules_;
    std::vector<Index> outputs_;
    std::vector<Index> needed_;
    std::vector<std::vector<Index>> cones_, unknowns_of_;
    Index reverse_cost_ = 0;
    mutable std::unique_ptr<Sparsity> sparsity_;
};

// --- derivatives at a point ------------------------------------------------------------------------

// Values and derivatives of the equations of one tape at one point after the other.
template <class T>
class Sweep {
public:
    explicit Sweep(const Tape& tape) : tape_(tape), values_(tape.slots()) {}

    Vector<const T> values() const { return values_; }
    Vector<const Partials<T>> partials() const { return partials_; }

    T value(Index equation) const { return values_[tape_.output(equation)]; }

    void evaluate(Vector<const T> point) { tape_.evaluate<T>(point, values_); }

    // Whether all values on the way to those of the equations are finite.
    bool are_finite() const {
        return std::all_of(values_.begin(), values_.end(), [](const T& value) { return value.are_finite(); });
    }

    // Values and partial derivatives of all operations.
    void linearize(Vector<const T> point) {
        partials_.resize(tape_.slots());
        adjoints_.resize(tape_.slots(), T(0.0));
        tape_.evaluate_all<T>(point, values_);
        for (Index slot = 0; slot < tape_.slots(); ++slot) partials_[slot] = tape_.partials<T>(slot, values_);
    }

    // Calls ``visit(unknown, derivative)`` for every unknown that an equation is made of, once for
    // each of its slots, backwards from the equation (Griewank and Walther 2008, chapter 3).
    template <class Visitor>
    void gradient(Index equation, Visitor visit) {
        gradient(equation, tape_.cone(equation), visit);
    }

    // The same for some unknowns, by the slots of the ``cone`` that depend on these: always the same ones, as what
    // comes to others is not taken away.
    template <class Visitor>
    void gradient(Index equation, Vector<const Index> cone, Visitor visit) {
        adjoints_[tape_.output(equation)] = T(1.0);
        for (Index slot : cone) {
            const Instruction& instruction = tape_[slot];
            const T adjoint = adjoints_[slot];
            adjoints_[slot] = T(0.0);
            switch (tape_.rule(slot)) {
                case Rule::leaf:
                    if (instruction.operation == Operation::unknown) visit(instruction.left, adjoint);
                    break;
                case Rule::sum:
                    adjoints_[instruction.left] += adjoint;
                    adjoints_[instruction.right] += adjoint;
                    break;
                case Rule::difference:
                    adjoints_[instruction.left] += adjoint;
                    adjoints_[instruction.right] -= adjoint;
                    break;
                case Rule::shifted: adjoints_[instruction.left] += adjoint; break;
                default:
                    adjoints_[instruction.left] += adjoint * partials_[slot].left;
                    if (Tape::has_right(instruction.operation)) adjoints_[instruction.right] += adjoint * partials_[slot].right;
            }
        }
    }

    // F' (m, n) at the point of `linearize`: backwards from each equation or forwards from all
    // unknowns, whichever takes fewer operations.
    void jacobian(View<T> jacobian) {
        if (tape_.reverse_cost() <= tape_.unknowns() * tape_.slots()) {
            std::fill_n(jacobian.data, jacobian.rows * jacobian.columns, T(0.0));
            for (Index row = 0; row < tape_.equations(); ++row) {
                gradient(row, [&](Index unknown, const T& entry) { jacobian(row, unknown) += entry; });
            }
            return;
        }
        const Matrix<T> gradients = forward_gradients();
        for (Index row = 0; row < tape_.equations(); ++row) {
            for (Index j = 0; j < tape_.unknowns(); ++j) jacobian(row, j) = gradients(tape_.output(row), j);
        }
    }

    // The entries of F' at the point of `linearize`, in the order of the pattern of the tape.
    void entries(Vector<T> entries) {
        std::vector<T> row(tape_.unknowns(), T(0.0));
        auto next = entries.begin();
        for (Index equation = 0; equation < tape_.equations(); ++equation) {
            gradient(equation, [&](Index unknown, const T& entry) { row[unknown] += entry; });
            for (Index unknown : tape_.unknowns_of(equation)) {
                *next++ = row[unknown];
                row[unknown] = T(0.0);
            }
        }
    }

    // F'' (m * n, n) at the point of `linearize`.
    void hessian(View<T> hessian) const {
        const Index n = tape_.unknowns();
        const Matrix<T> gradients = forward_gradients();
        Matrix<T> bends(tape_.slots(), n * (n + 1) / 2);  // lower triangles
        for (Index slot = 0; slot < tape_.slots(); ++slot) set_bend(slot, gradients, bends);
        for (Index row = 0; row < tape_.equations(); ++row) {
            Index entry = 0;
            for (Index i = 0; i < n; ++i) {
                for (Index j = 0; j <= i; ++j, ++entry) {
                    const T& bend = bends(tape_.output(row), entry);
                    hessian(row * n + i, j) = hessian(row * n + j, i) = bend;
                }
            }
        }
    }

    // F'' along each of the ``directions`` (d, n), which is F''(v, .) for each: (d * m, n), from the partials that
    // `linearize` left.
    void bends(View<const T> directions, View<T> out) const {
        const Index n = tape_.unknowns(), m = tape_.equations();
        const Matrix<T> gradients = forward_gradients();
        Matrix<T> bends(tape_.slots(), n);
        std::vector<T> along(tape_.slots());
        for (Index d = 0; d < directions.rows; ++d) {
            for (Index slot = 0; slot < tape_.slots(); ++slot) {
                along[slot] = T(0.0);
                for (Index j = 0; j < n; ++j) along[slot] += gradients(slot, j) * directions(d, j);
                set_bend_along(slot, gradients, along, bends);
            }
            for (Index row = 0; row < m; ++row) {
                std::copy_n(bends.row(tape_.output(row)).begin(), n, out.row(d * m + row).begin());
            }
        }
    }

private:
    Matrix<T> forward_gradients() const {
        const Index n = tape_.unknowns();
        Matrix<T> gradients(tape_.slots(), n);
        for (Index slot = 0; slot < tape_.slots(); ++slot) {
            const Instruction& instruction = tape_[slot];
            if (instruction.operation == Operation::unknown) gradients(slot, instruction.left) = T(1.0);
            if (!Tape::has_left(instruction.operation)) continue;
            const Partials<T>& partials = partials_[slot];
            for (Index j = 0; j < n; ++j) gradients(slot, j) = partials.left * gradients(instruction.left, j);
            if (!Tape::has_right(instruction.operation)) continue;
            for (Index j = 0; j < n; ++j) gradients(slot, j) += partials.right * gradients(instruction.right, j);
        }
        return gradients;
    }

    // What second derivatives have beside those of the operands: ``factor`` times the symmetric
    // product of the gradients of two slots.
    struct Cross {
        Index first;
        Index second;
        T factor;
    };

    Cross cross_of(Index slot) const {
        const Instruction& instruction = tape_[slot];
        const T half(0.5);
        switch (tape_.rule(slot)) {
            case Rule::product: return {instruction.left, instruction.right, T(1.0)};
            case Rule::quotient: return {slot, instruction.right, -partials_[slot].left};
            case Rule::rate: return {instruction.rule, instruction.left, half};
            case Rule::inverse_rate:
            case Rule::angle: return {instruction.rule, slot, -half / values_[instruction.rule]};
            default: return {0, 0, T(0.0)};
        }
    }

    void set_bend(Index slot, const Matrix<T>& gradients, Matrix<T>& bends) const {
        const Instruction& instruction = tape_[slot];
        if (!Tape::has_left(instruction.operation)) return;
        const Index n = tape_.unknowns(), count = bends.columns();
        const Partials<T>& partials = partials_[slot];
        for (Index entry = 0; entry < count; ++entry) bends(slot, entry) = partials.left * bends(instruction.left, entry);
        if (Tape::has_right(instruction.operation)) {
            for (Index entry = 0; entry < count; ++entry) {
                bends(slot, entry) += partials.right * bends(instruction.right, entry);
            }
        }
        if (is_linear(tape_.rule(slot))) return;
        const Cross cross = cross_of(slot);
        Index entry = 0;
        for (Index i = 0; i < n; ++i) {
            for (Index j = 0; j <= i; ++j, ++entry) {
                const T both = gradients(cross.first, i) * gradients(cross.second, j) +
                               gradients(cross.first, j) * gradients(cross.second, i);
                bends(slot, entry) += cross.factor * both;
            }
        }
    }

    // The same along a direction, ``along`` which the slots change by so much.
    void set_bend_along(Index slot, const Matrix<T>& gradients, const std::vector<T>& along, Matrix<T>& bends) const {
        const Instruction& instruction = tape_[slot];
        const Vector<T> bend = bends.row(slot);
        std::fill(bend.begin(), bend.end(), T(0.0));
        if (!Tape::has_left(instruction.operation)) return;
        const Index n = tape_.unknowns();
        const Partials<T>& partials = partials_[slot];
        for (Index j = 0; j < n; ++j) bend[j] = partials.left * bends(instruction.left, j);
        if (Tape::has_right(instruction.operation)) {
            for (Index j = 0; j < n; ++j) bend[j] += partials.right * bends(instruction.right, j);
        }
        if (is_linear(tape_.rule(slot))) return;
        const Cross cross = cross_of(slot);
        const T first = cross.factor * along[cross.first], second = cross.factor * along[cross.second];
        for (Index j = 0; j < n; ++j) {
            bend[j] += first * gradients(cross.second, j) + second * gradients(cross.first, j);
        }
    }

    const Tape& tape_;
    std::vector<T> values_;
    std::vector<Partials<T>> partials_;
    std::vector<T> adjoints_;
};

// --- many points ---------------------------------------------------------------------------------------

// F and F' of one tape at many points.
class ManyPoints {
public:
    explicit ManyPoints(const Tape& tape)
        : tape_(tape), one_(tape), many_(tape), point_(tape.unknowns()), jacobian_(0, 0) {}

    // F (k, m) at points (k, n), and F' (k * m, n) where there is room for it.
    void fill(View<const double> points, View<double> values, View<double> jacobians) {
        Index begin = 0;
        for (; begin + few <= points.rows; begin += std::min(Abreast::lanes, points.rows - begin)) {
            const Index count = std::min(Abreast::lanes, points.rows - begin);
            if (!fill_some(points, begin, count, values, jacobians)) fill_each(points, begin, count, values, jacobians);
        }
        fill_each(points, begin, points.rows - begin, values, jacobians);
    }

private:
    static constexpr Index few = 2;  // points from which on it is worth while

    // Whether that is done: derivatives are not taken abreast where a number on the way is not finite.
    bool fill_some(View<const double> points, Index begin, Index count, View<double> values, View<double> jacobians) {
        const Index m = tape_.equations(), n = tape_.unknowns();
        for (Index j = 0; j < n; ++j) {
            point_[j] = Abreast::each([&](Index lane) { return points(begin + std::min(lane, count - 1), j); });
        }
        const bool has_jacobians = jacobians.rows > 0;
        if (has_jacobians) many_.linearize(point_);
        else many_.evaluate(point_);
        if (has_jacobians && !many_.are_finite()) return false;
        for (Index row = 0; row < m; ++row) {
            const Abreast value = many_.value(row);
            for (Index lane = 0; lane < count; ++lane) values(begin + lane, row) = value.at[lane];
        }
        if (!has_jacobians) return true;
        if (jacobian_.rows() != m) jacobian_ = Matrix<Abreast>(m, n);
        many_.jacobian(jacobian_);
        for (Index row = 0; row < m; ++row) {
            for (Index lane = 0; lane < count; ++lane) {
                const Vector<double> out = jacobians.row((begin + lane) * m + row);
                for (Index j = 0; j < n; ++j) out[j] = jacobian_(row, j).at[lane];
            }
        }
        return true;
    }

    void fill_each(View<const double> points, Index begin, Index count, View<double> values, View<double> jacobians) {
        const Index m = tape_.equations();
        for (Index k = begin; k < begin + count; ++k) {
            if (jacobians.rows == 0) one_.evaluate(points.row(k));
            else one_.linearize(points.row(k));
            for (Index row = 0; row < m; ++row) values(k, row) = one_.value(row);
            if (jacobians.rows != 0) one_.jacobian({jacobians.row(k * m).data(), m, jacobians.columns});
        }
    }

    const Tape& tape_;
    Sweep<double> one_;
    Sweep<Abreast> many_;
    std::vector<Abreast> point_;
    Matrix<Abreast> jacobian_;
};

// --- series ----------------------------------------------------------------------------------------

// How unknowns change along a curve that are no coordinates of it.
enum class Change { evenly, exponentially };

// Taylor coefficients of all slots along a curve, one order after the other. Only so many of the unknowns are
// ``free``; of the others the ``change`` is known.
template <class T>
class SeriesSweep {
public:
    SeriesSweep(const Tape& tape, Index order, Index free, Change change = Change::evenly)
        : tape_(tape),
          free_(free),
          change_(change),
          rates_(tape.unknowns()),
          coefficients_(tape.slots(), order + 1),
          steps_(tape.slots()),
          is_zero_(tape.slots()),
          is_standing_(tape.unknowns()) {
        find_degrees();
    }

    const T& coefficient(Index equation, Index k) const { return coefficients_(tape_.output(equation), k); }

    // Whether an operation depends on free unknowns.
    bool is_moving(Index slot) const { return is_moving_[slot]; }

    // Which of the unknowns that are not free do not change.
    void set_standing(const std::vector<char>& is_standing) {
        if (is_standing == is_standing_) return;
        is_standing_ = is_standing;
        find_degrees();
    }

    // How fast an unknown that is not free changes at first.
    void set_rate(Index unknown, const T& rate) { rates_[unknown] = rate; }

    // From the point at which a sweep was linearized, to be kept as it is until the last coefficient.
    void start(const Sweep<T>& sweep) {
        const Vector<const T> values = sweep.values();
        partials_ = sweep.partials().data();
        for (Index slot = 0; slot < tape_.slots(); ++slot) {
            coefficients_(slot, 0) = values[slot];
            is_zero_[slot] = tape_.is_overflow(slot, values[slot]);
        }
    }

    // Coefficients k > 0 of all slots where those of the free unknowns are 0.
    void advance(Index k) {
        for (Index slot = 0; slot < tape_.slots(); ++slot) {
            if (k <= degrees_[slot]) coefficients_(slot, k) = is_zero_[slot] ? T(0.0) : next(slot, k);
        }
    }

    // Coefficients k of all slots once those of the free ``unknowns`` are known: they depend on them
    // linearly, by the first derivatives.
    void correct(Index k, Vector<const T> unknowns) {
        for (Index slot : moving_) {
            coefficients_(slot, k) += steps_[slot] = change(slot, unknowns);
        }
    }

private:
    // Of every slot the number of the last coefficient that is not zero, and whether it depends on free unknowns.
    void find_degrees() {
        degrees_.clear();
        is_moving_.clear();
        moving_.clear();
        const View<T> all = coefficients_.view();
        std::fill_n(all.data, all.rows * all.columns, T(0.0));
        for (Index slot = 0; slot < tape_.slots(); ++slot) find_degree(slot, coefficients_.columns() - 1);
    }

    void find_degree(Index slot, Index order) {
        const Instruction& instruction = tape_[slot];
        const Operation operation = instruction.operation;
        const Rule rule = tape_.rule(slot);
        Index degree = 0;
        bool is_moving = false;
        if (operation == Operation::unknown) {
            is_moving = instruction.left < free_;
            degree = is_moving || change_ == Change::exponentially ? order : 1;
            if (is_standing_[instruction.left]) degree = 0;
        }
        if (Tape::has_left(operation)) {
            is_moving = is_moving_[instruction.left];
            degree = degrees_[instruction.left];
        }
        if (Tape::has_right(operation)) {
            const Index other = degrees_[instruction.right];
            is_moving = is_moving || is_moving_[instruction.right];
            degree = rule == Rule::product ? degree + other : std::max(degree, other);
        }
        if (degree && !is_linear(rule) && rule != Rule::product && rule != Rule::leaf) degree = order;
        degrees_.push_back(std::min(degree, order));
        is_moving_.push_back(is_moving);
        if (is_moving) moving_.push_back(slot);
    }

    T change(Index slot, Vector<const T> unknowns) const {
        const Instruction& instruction = tape_[slot];
        switch (tape_.rule(slot)) {
            case Rule::leaf: return unknowns[instruction.left];
            case Rule::sum: return steps_[instruction.left] + steps_[instruction.right];
            case Rule::difference: return steps_[instruction.left] - steps_[instruction.right];
            case Rule::shifted: return steps_[instruction.left];
            case Rule::product:
            case Rule::quotient:
            case Rule::angle:
                return partials_[slot].left * steps_[instruction.left] + partials_[slot].right * steps_[instruction.right];
            default: return partials_[slot].left * steps_[instruction.left];
        }
    }

    T next(Index slot, Index k) const {
        const Instruction& instruction = tape_[slot];
        const T* const left = row(instruction.left);
        const T* const right = row(instruction.right);
        switch (tape_.rule(slot)) {
            case Rule::leaf:
                if (is_moving_[slot]) return T(0.0);
                return k == 1 ? rates_[instruction.left] : row(slot)[k - 1] / static_cast<double>(k);
            case Rule::sum: return left[k] + right[k];
            case Rule::difference: return left[k] - right[k];
            case Rule::shifted: return left[k];
            case Rule::scaled: return left[k] * partials_[slot].left;
            case Rule::product: {
                if (left == right) return series::square(left, k);
                const Index first = std::max<Index>(0, k - degrees_[instruction.right]);
                return series::product(left, right, k, first, std::min(k, degrees_[instruction.left]));
            }
            case Rule::quotient: return series::quotient(left, right, row(slot), k);
            case Rule::rate: return series::from_rate(row(instruction.rule), left, k);
            case Rule::inverse_rate: return series::from_inverse_rate(row(instruction.rule), left, row(slot), k);
            default: return series::angle(left, right, row(instruction.rule), row(slot), k);
        }
    }

    // Operands of leaves are no slots; nothing reads theirs.
    const T* row(Index slot) const { return coefficients_.view().data + slot * coefficients_.columns(); }

    const Tape& tape_;
    Index free_;
    Change change_;
    std::vector<T> rates_;
    Matrix<T> coefficients_;
    const Partials<T>* partials_ = nullptr;
    std::vector<T> steps_;
    std::vector<char> is_zero_, is_moving_, is_standing_;
    std::vector<Index> degrees_, moving_;
};

// Taylor coefficients (order + 1, m) of F along u(s) with coefficients ``curve`` (order + 1, n).
template <class T>
void series_along(const Tape& tape, View<const T> curve, View<T> out) {
    Sweep<T> first(tape);
    SeriesSweep<T> sweep(tape, curve.rows - 1, tape.unknowns());
    first.linearize(curve.row(0));
    sweep.start(first);
    for (Index k = 0; k < curve.rows; ++k) {
        if (k > 0) {
            sweep.advance(k);
            sweep.correct(k, curve.row(k));
        }
        for (Index row = 0; row < tape.equations(); ++row) out(k, row) = sweep.coefficient(row, k);
    }
}

// --- a system --------------------------------------------------------------------------------------

// The equations of a tape in unknowns v = u / units, each times its weight. What is not finite is
// infinitely far from a solution. Not for two threads at once: the sweep is shared.
class TapeSystem {
public:
    using Bordered = DenseBordered;
    using Damped = DenseDamped;

    TapeSystem(const Tape& tape, Vector<const double> units, Vector<const double> weights)
        : tape_(tape), units_(units), weights_(weights), sweep_(tape), many_(tape), point_(tape.unknowns()) {}

    Index unknowns() const { return tape_.unknowns(); }
    Index equations() const { return tape_.equations(); }
    Bordered bordered() const { return {equations(), unknowns()}; }
    Damped damped() const { return {equations(), unknowns()}; }

    void residual(Vector<const double> point, Vector<double> residual) const {
        sweep_.evaluate(in_units(point));
        fill(residual);
    }

    void linearize(Vector<const double> point, Vector<double> residual, View<double> jacobian) const {
        linearize_sweep(point, residual);
        sweep_.jacobian(jacobian);
        for (Index row = 0; row < equations(); ++row) {
            for (Index j = 0; j < unknowns(); ++j) jacobian(row, j) *= weights_[row] * units_[j];
        }
    }

    // Residuals (k, m) at points (k, n), and Jacobians (k * m, n) where there is room for them.
    void fill(View<const double> points, View<double> residuals, View<double> jacobians) const {
        points_.resize(points.rows * points.columns);
        const View<double> in_units{points_.data(), points.rows, points.columns};
        for (Index k = 0; k < points.rows; ++k) {
            for (Index j = 0; j < points.columns; ++j) in_units(k, j) = units_[j] * points(k, j);
        }
        many_.fill(in_units, residuals, jacobians);
        for (Index k = 0; k < points.rows; ++k) {
            for (Index row = 0; row < equations(); ++row) residuals(k, row) = weighted(row, residuals(k, row));
        }
        for (Index k = 0; k < jacobians.rows; ++k) {
            for (Index j = 0; j < unknowns(); ++j) jacobians(k, j) *= weights_[k % equations()] * units_[j];
        }
    }

    // Second derivative (m * n, n).
    void hessian(Vector<const double> point, View<double> hessian) const {
        const Index n = unknowns();
        sweep_.linearize(in_units(point));
        sweep_.hessian(hessian);
        for (Index row = 0; row < equations(); ++row) {
            for (Index i = 0; i < n; ++i) {
                for (Index j = 0; j < n; ++j) hessian(row * n + i, j) *= weights_[row] * units_[i] * units_[j];
            }
        }
    }

    // F'' along directions (d, n): (d * m, n).
    void bends(Vector<const double> point, View<const double> directions, View<double> out) const {
        Matrix<double> scaled(directions.rows, directions.columns);
        for (Index d = 0; d < directions.rows; ++d) {
            for (Index j = 0; j < unknowns(); ++j) scaled(d, j) = units_[j] * directions(d, j);
        }
        sweep_.linearize(in_units(point));
        sweep_.bends(scaled, out);
        for (Index row = 0; row < out.rows; ++row) {
            for (Index j = 0; j < unknowns(); ++j) out(row, j) *= weights_[row % equations()] * units_[j];
        }
    }

    // The solution curve: coefficient k of F along it with nothing for coefficient k of the
    // unknowns is the right-hand side for that coefficient. |dv/ds| = 1 gives the last row.
    template <class Factored>
    void series(Vector<const double> point, Vector<const double> tangent, const Factored& factored,
                View<double> coefficients) const {
        const Index order = coefficients.rows - 1, n = unknowns(), m = equations();
        SeriesSweep<double> sweep(tape_, order, n);
        std::vector<double> right(m + 1), step(n);
        sweep_.linearize(in_units(point));
        sweep.start(sweep_);
        std::copy(point.begin(), point.end(), coefficients.row(0).begin());
        for (Index k = 1; k <= order; ++k) {
            sweep.advance(k);
            const Vector<double> row = coefficients.row(k);
            if (k == 1) {
                std::copy(tangent.begin(), tangent.end(), row.begin());
            } else {
                for (Index i = 0; i < m; ++i) right[i] = -weights_[i] * sweep.coefficient(i, k);
                right[m] = along(coefficients, k);
                factored.solve(right, row);
            }
            for (Index j = 0; j < n; ++j) step[j] = units_[j] * row[j];
            sweep.correct(k, step);
        }
    }

protected:
    void linearize_sweep(Vector<const double> point, Vector<double> residual) const {
        sweep_.linearize(in_units(point));
        fill(residual);
    }

    const Tape& tape_;
    Vector<const double> units_, weights_;
    mutable Sweep<double> sweep_;

private:
    // The component of coefficient k along the tangent for which the speed stays 1.
    static double along(View<const double> coefficients, Index k) {
        double excess = 0.0;
        for (Index j = 2; j < k; ++j) {
            const double factor = static_cast<double>(j * (k + 1 - j));
            double dot = 0.0;
            for (Index i = 0; i < coefficients.columns; ++i) dot += coefficients(j, i) * coefficients(k + 1 - j, i);
            excess += factor * dot;
        }
        return -0.5 * excess / static_cast<double>(k);
    }

    Vector<const double> in_units(Vector<const double> point) const {
        for (Index j = 0; j < unknowns(); ++j) point_[j] = units_[j] * point[j];
        return point_;
    }

    void fill(Vector<double> residual) const {
        for (Index row = 0; row < equations(); ++row) residual[row] = weighted(row, sweep_.value(row));
    }

    double weighted(Index row, double value) const {
        const double out = weights_[row] * value;
        return std::isfinite(out) ? out : std::numeric_limits<double>::infinity();
    }

    mutable ManyPoints many_;
    mutable std::vector<double> point_, points_;
};

// The same with a sparse F'.
class SparseTapeSystem : public TapeSystem {
public:
    using Bordered = SparseBordered;
    using Damped = SparseDamped;

    SparseTapeSystem(const Tape& tape, Vector<const double> units, Vector<const double> weights)
        : TapeSystem(tape, units, weights), sparsity_(tape.sparsity()) {}

    Bordered bordered() const { return Bordered(sparsity_); }
    Damped damped() const { return Damped(sparsity_); }

    void linearize(Vector<const double> point, Vector<double> residual, Vector<double> entries) const {
        linearize_sweep(point, residual);
        sweep_.entries(entries);
        const SparsityPattern& pattern = sparsity_.pattern;
        for (Index row = 0; row < equations(); ++row) {
            for (Index entry = pattern.starts[row]; entry < pattern.starts[row + 1]; ++entry) {
                entries[entry] *= weights_[row] * units_[pattern.entries[entry]];
            }
        }
    }

private:
    const Sparsity& sparsity_;
};

}  // namespace bifurc
