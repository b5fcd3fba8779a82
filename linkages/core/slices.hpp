// All configurations of a closed loop of four to six joints with one joint angle given:
// candidates of an elimination, brought to closure.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "bifurc/core/least_squares.hpp"
#include "linkages/core/elimination.hpp"

namespace linkages {

namespace slices {

// a configuration closes: error, lengths in characteristic lengths
constexpr double closed = 1e-13;
constexpr double exact = 5e-16;           // an error that no step brings down
constexpr double closed_between = 1e-14;  // error half way between two points of one configuration
constexpr double equal = 1e-6;            // rad: two configurations that agree to this are one
constexpr double neighbours = 1e-2;       // rad: two that may be one singular configuration
constexpr double real = 1e-7;             // rad: imaginary parts that are rounding
constexpr double maybe_real = 0.1;        // of the modulus of exp(i theta)
constexpr double unmoved = 1e-3;          // rad: a candidate that closes where it is
constexpr double largest_defect = 0.02;   // of the moduli of a candidate
constexpr double negligible = 1e-9;       // of a pivot to the first: a direction without a step
constexpr double longest_step = 0.5;      // rad
constexpr int most_steps = 60;
constexpr int steps_in_hope = 10;                // that need not bring the error down
constexpr std::size_t most_configurations = 40;  // more than four only where a continuum is sampled
constexpr int starts = 48;      // of Gauss-Newton in a slice that the elimination cannot decide
constexpr Index most_held = 4;  // candidates that close where they are, without a continuum

}  // namespace slices

// As in `linkages.slices.elimination`.
enum class SliceStatus { complete = 0, continuum = 1, undecided = 2 };

template <class T, std::size_t n>
using Angles = std::array<T, n>;

template <class T, std::size_t n>
double largest_size(const std::array<T, n>& vector) {
    double largest = 0.0;
    for (const T& entry : vector) largest = std::max(largest, std::norm(entry));
    return std::sqrt(largest);
}

// The angle in (-pi, pi].
inline double wrapped(double angle) {
    constexpr double turn = 2.0 * std::numbers::pi;
    const double out = angle - turn * std::nearbyint(angle / turn);
    return out <= -std::numbers::pi ? std::numbers::pi : out;
}

inline Complex wrapped(const Complex& angle) { return {wrapped(angle.real()), angle.imag()}; }

inline double angle_size(double gap) { return std::abs(wrapped(gap)); }
inline double angle_size(const Complex& gap) {
    return std::max(angle_size(gap.real()), std::abs(gap.imag()));
}

// The largest difference of angles, real and imaginary part, modulo the period.
template <class T, class S, std::size_t n>
double angle_distance(const std::array<T, n>& p, const std::array<S, n>& q) {
    double largest = 0.0;
    for (std::size_t i = 0; i < n; ++i) largest = std::max(largest, angle_size(p[i] - q[i]));
    return largest;
}

// The closure error after Gauss-Newton on the angles of a chain, in place.
template <class T, std::size_t m>
double polish(const Links<m>& links, std::array<T, m>& angles) {
    double previous = std::numeric_limits<double>::infinity();
    for (int i = 0; i < slices::most_steps; ++i) {
        auto closure = close_chain(links, angles);
        const double size = largest_size(closure.error);
        if (size < slices::exact || (size < slices::closed && size > 0.5 * previous)) return size;
        if (i > slices::steps_in_hope && (size > 1e-3 || size > 0.9 * previous)) return size;
        previous = size;
        const auto step = bifurc::least_squares(closure.derivatives, closure.error, slices::negligible);
        const double factor = std::min(1.0, slices::longest_step / (largest_size(step) + 1e-300));
        for (std::size_t j = 0; j < m; ++j) angles[j] -= factor * step[j];
    }
    return largest_size(close_chain(links, angles).error);
}

// Whether angles are those of a configuration of the list. At a singular configuration
// Gauss-Newton stops at different points that all close: two points whose middle closes too are
// one.
template <class T, std::size_t m>
bool contains(const std::vector<std::array<T, m>>& list, const std::array<T, m>& angles,
              const Links<m>& links) {
    for (const auto& known : list) {
        const double distance = angle_distance(angles, known);
        if (distance < slices::equal) return true;
        if (distance >= slices::neighbours) continue;
        std::array<T, m> middle;
        for (std::size_t j = 0; j < m; ++j) middle[j] = angles[j] - 0.5 * wrapped(angles[j] - known[j]);
        if (largest_size(close_chain(links, middle).error) < slices::closed_between) return true;
    }
    return false;
}

template <class T, std::size_t m>
void add_new(std::vector<std::array<T, m>>& list, const std::array<T, m>& angles, const Links<m>& links) {
    if (contains(list, angles, links) || list.size() >= slices::most_configurations) return;
    list.push_back(angles);
    for (T& angle : list.back()) angle = wrapped(angle);
}

// Configurations of a chain, real ones and others.
template <Index m>
struct ChainConfigurations {
    std::vector<Angles<double, m>> real;
    std::vector<Angles<Complex, m>> nonreal;
    SliceStatus status = SliceStatus::complete;
};

// The configurations of one closed chain with these links.
template <Index m>
class ChainSolver {
public:
    explicit ChainSolver(const Links<m>& links) : links_(links) {}

    ChainConfigurations<m> solve() {
        const Candidates candidates = find_candidates(links_);
        Index held = 0;
        for (const Candidate& candidate : candidates.list) held += collect(candidate);
        if (candidates.is_crowded) {
            out_.status = SliceStatus::undecided;
            sample();
        } else if (candidates.sampled > 0 && held > slices::most_held) {
            out_.status = SliceStatus::continuum;
        }
        return out_;
    }

private:
    // Brings a candidate to closure; whether it is a real one that closes where it is.
    bool collect(const Candidate& candidate) {
        double smallest = 1.0, away = 0.0;
        for (Index j = 0; j < m; ++j) {
            const double modulus = std::sqrt(std::norm(candidate.turns[j]));
            smallest = std::min(smallest, modulus);
            away = std::max(away, std::abs(modulus - 1.0));
        }
        if (smallest < elimination::infinite || candidate.defect > slices::largest_defect) return false;
        Angles<Complex, m> start;
        for (Index j = 0; j < m; ++j) {
            start[j] = {std::arg(candidate.turns[j]), -0.5 * std::log(std::norm(candidate.turns[j]))};
        }
        if (away < slices::maybe_real) {
            Angles<double, m> angles;
            for (Index j = 0; j < m; ++j) angles[j] = start[j].real();
            if (polish(links_, angles) < 0.5 * slices::closed) {
                add_new(out_.real, angles, links_);
                if (angle_distance(angles, start) < slices::unmoved) return true;
            }
        }
        collect_nonreal(start);
        return false;
    }

    void collect_nonreal(Angles<Complex, m> angles) {
        const double error = polish(links_, angles);
        double imaginary = 0.0, growth = 1.0;  // of the entries, and of the rounding with them
        for (const Complex& angle : angles) {
            imaginary = std::max(imaginary, std::abs(angle.imag()));
            growth *= std::exp(std::abs(angle.imag()));
        }
        const bool is_finite = imaginary < -std::log(elimination::infinite);
        if (imaginary > slices::real && is_finite && error < slices::closed * growth) {
            add_new(out_.nonreal, angles, links_);
        }
    }

    // Gauss-Newton from fixed, well spread starts: the Weyl sequence of square roots of primes.
    void sample() {
        constexpr std::array primes = {2.0, 3.0, 5.0, 7.0, 11.0};
        for (int i = 1; i <= slices::starts; ++i) {
            Angles<double, m> angles;
            for (Index j = 0; j < m; ++j) {
                angles[j] = 2.0 * std::numbers::pi * std::fmod(i * std::sqrt(primes[j]), 1.0);
            }
            if (polish(links_, angles) < 0.5 * slices::closed) add_new(out_.real, angles, links_);
        }
    }

    Links<m> links_;
    ChainConfigurations<m> out_;
};

// Slices of one loop of n joints.
template <Index n>
class Slicer {
public:
    struct Slice {
        std::vector<Angles<double, n>> real;
        std::vector<Angles<Complex, n>> nonreal;
        SliceStatus status;
    };

    // ``geometry`` (6, n) as for `Closure`.
    explicit Slicer(bifurc::View<const double> geometry) {
        for (Index i = 0; i < n; ++i) {
            const Turn<double> half_twist{geometry(4, i), geometry(5, i)};
            frames_[i] = {geometry(0, i), geometry(1, i), {geometry(2, i), geometry(3, i)}};
            links_[i] = link_quaternion(geometry(0, i), geometry(1, i), half_twist);
        }
    }

    // All configurations with ``joint`` (from 0) at an angle.
    Slice slice(Index joint, double angle) const {
        Links<n - 1> chain;  // after the joint, whose links at either side are one
        for (Index i = 0; i < n - 1; ++i) chain[i] = links_[(joint + 1 + i) % n];
        chain[n - 2] = chain[n - 2] * turned(turn_by(0.5 * angle), links_[joint]);
        const ChainConfigurations<n - 1> found = ChainSolver<n - 1>(chain).solve();
        Slice out{{}, {}, found.status};
        for (const auto& rest : found.real) out.real.push_back(with_joint(joint, wrapped(angle), rest));
        for (const auto& rest : found.nonreal) {
            out.nonreal.push_back(with_joint(joint, Complex(wrapped(angle)), rest));
        }
        return out;
    }

    // The largest entry of T_1 ... T_n - I, lengths in characteristic lengths.
    double closure_error(const Angles<double, n>& angles) const {
        Frame<double> frame;
        for (Index i = 0; i < n; ++i) frame.advance(turn_by(angles[i]), frames_[i]);
        return frame.largest_gap();
    }

private:
    template <class T>
    static Angles<T, n> with_joint(Index joint, const T& angle, const Angles<T, n - 1>& rest) {
        Angles<T, n> out;
        out[joint] = angle;
        for (Index j = 0; j < n - 1; ++j) out[(joint + 1 + j) % n] = rest[j];
        return out;
    }

    Links<n> links_;
    std::array<Link<double>, n> frames_;
};

}  // namespace linkages
