// Sheets of configurations that are not real, followed as one joint turns, in balls in which the
// theorem of Newton and Kantorovich leaves a single solution: `linkages.slices.nonreal_tracking`
// has the bounds.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "bifurc/core/arrays.hpp"
#include "bifurc/core/deadline.hpp"
#include "bifurc/core/least_squares.hpp"
#include "bifurc/core/null_vector.hpp"
#include "linkages/core/screws.hpp"

namespace linkages {

namespace sheets {

// rad: a sheet that advances by less than this in a step has come to a halt
constexpr double shortest = 1e-9;
// rad: where steps in the angle of the joint are shorter, the sheet is followed along its curve
constexpr double slow = 1e-5;
constexpr int most_steps = 10'000;  // in the angle of the joint
constexpr int most_along = 500;     // along the curve
constexpr double arrived = 1e-12;   // rad: distance to the end
// rad: what is proved around a fold must reach farther than the rounding of its angle
constexpr double smallest = 1e-9;
constexpr double corrected = 1e-8;  // rad: a correction after which the error is of rounding
constexpr int corrections = 8;
constexpr int coefficients = 32;                          // of the angle as a power series about a fold
constexpr int circles = 60;                               // on which the terms of that series are compared
constexpr double first_circle = 1e-3, last_circle = 0.5;  // over the reach of the series

}  // namespace sheets

// Columns of joint screws over a row that singles out one solution.
template <std::size_t n>
std::array<std::array<Complex, 7>, n> border(const std::array<Screw<Complex>, n>& screws,
                                             const std::array<Complex, n>& along) {
    std::array<std::array<Complex, 7>, n> columns;
    for (std::size_t j = 0; j < n; ++j) {
        const auto& [w, v] = screws[j];
        columns[j] = {w[0], w[1], w[2], v[0], v[1], v[2], along[j]};
    }
    return columns;
}

// The pseudo-inverse of joint screws over a row that singles out one solution.
template <std::size_t n>
class BorderedScrews {
public:
    using Configuration = std::array<Complex, n>;

    // Gram-Schmidt, twice.
    BorderedScrews(const std::array<Screw<Complex>, n>& screws, const Configuration& along)
        : orthonormal_(border(screws, along)) {
        for (std::size_t j = 0; j < n; ++j) {
            std::array<Complex, 7>& column = orthonormal_[j];
            for (std::size_t i = 0; i < j; ++i) upper_(i, j) = 0.0;
            for (int time = 0; time < 2; ++time) {
                for (std::size_t i = 0; i < j; ++i) {
                    const Complex inner = bifurc::inner_product(orthonormal_[i], column);
                    upper_(i, j) += inner;
                    for (int k = 0; k < 7; ++k) column[k] -= inner * orthonormal_[i][k];
                }
            }
            const double size = std::sqrt(bifurc::squared_size(column));
            for (Complex& entry : column) entry /= size;
            inverse_diagonal_[j] = 1.0 / size;
        }
    }

    // All columns: the first six for a twist, the last one for the row.
    std::array<Configuration, 7> inverse() const {
        std::array<Configuration, 7> out;
        for (int k = 0; k < 7; ++k) {
            for (std::size_t i = n; i-- > 0;) {
                Complex value = std::conj(orthonormal_[i][k]);
                for (std::size_t j = i + 1; j < n; ++j) value -= upper_(i, j) * out[k][j];
                out[k][i] = value * inverse_diagonal_[i];
            }
        }
        return out;
    }

private:
    std::array<std::array<Complex, 7>, n> orthonormal_;
    bifurc::SmallMatrix<Complex, n, n> upper_;
    std::array<double, n> inverse_diagonal_;
};

// A ball around a configuration, in a norm that divides each joint by its weight: in it ``bound``
// bounds the second derivative, and there is at most one solution for every value of a coordinate.
template <std::size_t n>
struct Ball {
    std::array<double, n> weight;
    double radius;
    double bound;
};

// A dead point of a joint on a known motion, and the neighbourhood in which only its own pair of
// sheets meets: less than ``along`` from it in the direction of the tangent, less than ``away`` in
// all, and less than ``across`` in the angle of the joint.
template <std::size_t n>
struct Fold {
    std::array<double, n> configuration;
    std::array<double, n> tangent;
    std::array<double, n> weight;
    double away;
    double along;
    double across;
};

// The second derivatives of P F at a configuration, P the first six columns of ``inverse``: of
// joints i < j, one pair after the other, P of half the bracket of their screws.
template <std::size_t n>
struct SecondDerivatives {
    static constexpr std::size_t pairs = n * (n - 1) / 2;

    std::array<std::array<Complex, n>, pairs> of_pair;

    SecondDerivatives(const std::array<Screw<Complex>, n>& screws,
                      const std::array<std::array<Complex, n>, 7>& inverse) {
        std::size_t number = 0;
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = i + 1; j < n; ++j, ++number) {
                const auto half_bracket = entries(0.5 * bracket(screws[i], screws[j]));
                for (std::size_t a = 0; a < n; ++a) {
                    Complex value = 0.0;
                    for (int k = 0; k < 6; ++k) value += inverse[k][a] * half_bracket[k];
                    of_pair[number][a] = value;
                }
            }
        }
    }

    // The quadratic form at a direction.
    std::array<Complex, n> at(const std::array<Complex, n>& direction) const {
        std::array<Complex, n> out{};
        std::size_t number = 0;
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = i + 1; j < n; ++j, ++number) {
                const Complex product = 2.0 * (direction[i] * direction[j]);
                for (std::size_t a = 0; a < n; ++a) out[a] += product * of_pair[number][a];
            }
        }
        return out;
    }

    // A bound of the largest singular value in the norm with these weights.
    double size(const std::array<double, n>& weight) const {
        auto scaled = of_pair;
        std::size_t number = 0;
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = i + 1; j < n; ++j, ++number) {
                for (std::size_t a = 0; a < n; ++a) scaled[number][a] *= weight[i] * weight[j] / weight[a];
            }
        }
        double trace = 0.0;
        std::array<double, n> rows{};  // sums of the entries of the Gram matrix
        for (std::size_t a = 0; a < n; ++a) {
            for (std::size_t b = 0; b <= a; ++b) {
                Complex entry = 0.0;
                for (std::size_t k = 0; k < pairs; ++k) entry += scaled[k][a] * std::conj(scaled[k][b]);
                const double size = 2.0 * (a == b ? entry.real() : std::sqrt(std::norm(entry)));
                rows[a] += size;
                if (a == b)
                    trace += size;
                else
                    rows[b] += size;
            }
        }
        return std::sqrt(std::min(trace, *std::max_element(rows.begin(), rows.end())));
    }
};

// The ball around a configuration with these screws.
template <std::size_t n>
Ball<n> find_ball(const std::array<Screw<Complex>, n>& screws,
                  const std::array<std::array<Complex, n>, 7>& inverse, const SecondDerivatives<n>& second) {
    const auto size_of = [](const Vec3<Complex>& part) {
        double real = 0.0, imaginary = 0.0;
        for (const Complex& entry : part) {
            real += entry.real() * entry.real();
            imaginary += entry.imag() * entry.imag();
        }
        return std::sqrt(real) + std::sqrt(imaginary);
    };
    Ball<n> ball;
    double total = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        const double m = 0.5 * (size_of(screws[i].direction) + size_of(screws[i].moment));
        // a joint with a large screw may move less; the root takes the fewest steps
        ball.weight[i] = 1.0 / std::sqrt(m);
        total += m;
    }
    double square = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        double row = 0.0;
        for (int k = 0; k < 6; ++k) row += std::norm(inverse[k][i]);
        square += row / (ball.weight[i] * ball.weight[i]);
    }
    const double center = second.size(ball.weight);
    const double growth = 2.0 * std::sqrt(square) * total, rate = std::sqrt(total);
    const auto bound_at = [&](double radius) { return center + growth * std::expm1(rate * radius); };
    ball.radius = std::min(0.5 / center, 1.0);
    ball.bound = bound_at(ball.radius);
    while (ball.bound * ball.radius > 0.5) {  // the bound grows with the radius
        ball.radius *= 0.8;
        ball.bound = bound_at(ball.radius);
    }
    return ball;
}

// The complex curve of solutions through a configuration, t the coordinate along its unit
// tangent: the only one in the ball, in which |t| < ``reach`` lies. A joint turns by
// g_1 t + g_2 t^2 + ..., ``terms`` are |g_k|, at most ``largest`` in all; ``slope`` is g_1.
template <std::size_t n>
struct SheetCurve {
    static constexpr int count = sheets::coefficients;
    using Circles = std::array<double, sheets::circles>;

    std::array<Complex, n> at;
    std::array<Complex, n> tangent;
    Ball<n> ball;
    double reach;
    std::array<double, count> terms;
    Complex slope;
    double largest;

    // Radii of circles.
    Circles radii() const {
        Circles out;
        const double ratio = std::log(sheets::last_circle / sheets::first_circle) / (sheets::circles - 1);
        for (int i = 0; i < sheets::circles; ++i) out[i] = reach * sheets::first_circle * std::exp(i * ratio);
        return out;
    }

    // By how much term k exceeds the rest on a circle of radius t: Cauchy bounds what follows the
    // last.
    double margin(int k, double t) const {
        double power = 1.0, total = 0.0, own = 0.0, ratios = 1.0;
        const double ratio = t / reach;
        for (int i = 0; i < count; ++i) {
            total += terms[i] * power;
            if (i == k) own = terms[i] * power;
            power *= t;
            ratios *= ratio;
        }
        const double beyond = largest * ratios / (1.0 - ratio);
        // the terms themselves are off by as little as what comes after the last
        return 2.0 * own - total - 2.0 * beyond;
    }

    // Whether the imaginary part of some joint keeps its sign where the coordinate is at most t.
    bool stays_nonreal(double t) const {
        double speed = 0.0;
        for (std::size_t i = 0; i < n; ++i)
            speed += std::norm(tangent[i]) / (ball.weight[i] * ball.weight[i]);
        const double step = 4.0 / 3.0 * t * std::sqrt(speed);
        const double strayed = 0.5 * ball.bound * step * step;
        for (std::size_t i = 0; i < n; ++i) {
            if (std::abs(at[i].imag()) - std::abs(tangent[i]) * t - ball.weight[i] * strayed > 0.0)
                return true;
        }
        return false;
    }
};

// Follows sheets of a loop of n joints as ``joint`` (from 0) turns.
template <std::size_t n>
class SheetTracker {
public:
    using Configuration = std::array<Complex, n>;
    using Folds = std::vector<const Fold<n>*>;

    // ``geometry`` (6, n) as for `Closure`.
    SheetTracker(bifurc::View<const double> geometry, std::size_t joint) : joint_(joint) {
        for (std::size_t i = 0; i < n; ++i) {
            links_[i] = {geometry(0, i), geometry(1, i), {geometry(2, i), geometry(3, i)}};
        }
        of_joint_[joint] = 1.0;
    }

    // Joint screws and the closure error.
    struct Linearization {
        std::array<Screw<Complex>, n> screws;
        Screw<Complex> error;
    };

    Linearization linearize(const Configuration& z) const {
        Linearization out;
        Frame<Complex> frame;
        for (std::size_t i = 0; i < n; ++i) {
            out.screws[i] = frame.joint();
            frame.advance(turn_by(z[i]), links_[i]);
        }
        out.error = frame.skew_gap();
        return out;
    }

    // The ball around a configuration for the coordinate ``along``.
    Ball<n> ball_around(const Configuration& z, const Configuration& along) const {
        const auto screws = linearize(z).screws;
        const auto inverse = BorderedScrews<n>(screws, along).inverse();
        return find_ball(screws, inverse, SecondDerivatives<n>(screws, inverse));
    }

    // Whether a sheet, moved in place, gets to ``end`` without becoming real, or joins one of the
    // folds. It stops where it is when the time is over.
    bool follow(Configuration& z, double end, const Folds& folds, bifurc::Deadline& deadline) const {
        for (int i = 0; i < sheets::most_along; ++i) {
            if (deadline.has_passed()) return false;
            if (follow_in_angle(z, end, folds)) return true;
            if (!advance_along(z, end)) return false;
        }
        return false;
    }

    // Moves a sheet towards ``end`` by one step along its curve; false where none can be proved.
    // Near a fold the steps in the angle of the joint get short. The coordinate along the tangent
    // does not mind: where the first term of the series exceeds the rest by m on a circle, every
    // angle nearer than m is taken once within.
    bool advance_along(Configuration& z, double end) const {
        const auto curve = curve_through(z);
        if (!curve) return false;
        double margin = -std::numeric_limits<double>::infinity(), radius = 0.0;
        for (double t : curve->radii()) {
            const double here = curve->margin(1, t);
            if (!(here > margin) || !curve->stays_nonreal(t)) continue;
            margin = here;
            radius = t;
        }
        const double left = end - z[joint_].real();
        const double size = std::min(0.9 * margin, std::abs(left));
        if (!(size >= std::min(sheets::shortest, std::abs(left)))) return false;
        const double step = std::copysign(size, left);
        Configuration after = z;
        for (std::size_t i = 0; i < n; ++i) after[i] += step / curve->slope * curve->tangent[i];
        after[joint_] = z[joint_].real() + step;
        if (!correct(after, of_joint_)) return false;
        Complex moved = 0.0;
        for (std::size_t i = 0; i < n; ++i) moved += std::conj(curve->tangent[i]) * (after[i] - z[i]);
        if (std::abs(moved) >= radius) return false;
        z = after;
        return true;
    }

    // The neighbourhood of a dead point. Where the second term of the series of the angle exceeds
    // the rest by m on a circle, every angle nearer than m to that of the dead point is taken twice
    // within (Rouche).
    std::optional<Fold<n>> find_fold(const std::array<double, n>& configuration) const {
        Configuration at;
        std::copy(configuration.begin(), configuration.end(), at.begin());
        const auto curve = curve_through(at);
        if (!curve) return {};
        Fold<n> fold{configuration, {}, curve->ball.weight, curve->ball.radius, 0.0, sheets::smallest};
        for (std::size_t i = 0; i < n; ++i) fold.tangent[i] = curve->tangent[i].real();
        for (double t : curve->radii()) {
            const double margin = curve->margin(2, t);
            if (!(margin > fold.across)) continue;
            fold.across = margin;
            fold.along = t;
        }
        if (!(fold.across > sheets::smallest)) return {};
        return fold;
    }

private:
    // Newton's method at right angles to ``along``, in place; false where it does not converge.
    bool correct(Configuration& z, const Configuration& along) const {
        for (int i = 0; i < sheets::corrections; ++i) {
            const Linearization at = linearize(z);
            auto columns = border(at.screws, along);
            const auto& [rotation, translation] = at.error;
            std::array<Complex, 7> error{rotation[0],    rotation[1],    rotation[2], translation[0],
                                         translation[1], translation[2], 0.0};
            const Configuration step = bifurc::least_squares(columns, error, 0.0);
            double largest = 0.0;
            for (std::size_t j = 0; j < n; ++j) {
                const double square = std::norm(step[j]);
                if (!std::isfinite(square)) return false;
                z[j] -= step[j];
                largest = std::max(largest, square);
            }
            // the error after it is of the order of its square
            if (largest < sheets::corrected * sheets::corrected) return true;
        }
        return false;
    }

    // Whether a sheet, moved in place, gets to ``end`` or into the neighbourhood of a fold without
    // short steps.
    bool follow_in_angle(Configuration& z, double end, const Folds& folds) const {
        Passed before;
        for (int i = 0; i < sheets::most_steps; ++i) {
            for (const Fold<n>* fold : folds) {
                if (has_joined(z, *fold)) return true;
            }
            const double left = end - z[joint_].real();
            if (std::abs(left) < sheets::arrived) return true;
            if (!advance_in_angle(z, left, before)) return false;
        }
        return false;
    }

    // A configuration of a sheet, its rates, and the step that was taken from it; 0 where there is none.
    struct Passed {
        Configuration at, slope;
        double step = 0.0;
    };

    // One step in the angle of the joint, at most by ``left``; false where none can be proved that
    // is not short. The polynomial through the place ``before`` predicts where it leads.
    bool advance_in_angle(Configuration& z, double left, Passed& before) const {
        const auto screws = linearize(z).screws;
        const auto inverse = BorderedScrews<n>(screws, of_joint_).inverse();
        const SecondDerivatives<n> second(screws, inverse);
        const Ball<n> ball = find_ball(screws, inverse, second);
        const Configuration& slope = inverse[6];
        const double speed = weighted_size(slope, ball);
        double step = std::copysign(std::min(0.75 * ball.radius / speed, std::abs(left)), left);
        while (!stays_nonreal(z, slope, ball, step, speed)) {
            step *= 0.5;
            if (!(std::abs(step) >= sheets::slow)) return false;  // nor not a number
        }
        if (!(std::abs(step) >= std::min(sheets::slow, std::abs(left)))) return false;
        const Configuration bend = second.at(slope);
        Configuration after = z, moved;
        const double h = before.step, ratio = h == 0.0 ? 0.0 : step / h;
        const double third = ratio * ratio * ratio;
        for (std::size_t i = 0; i < n; ++i) {
            after[i] += step * (slope[i] - 0.5 * step * bend[i]);
            // what the second order misses of the step before, in its place and in its rate
            const Complex missed = z[i] - before.at[i] - h * (slope[i] + 0.5 * h * bend[i]);
            const Complex turned = h * (before.slope[i] - slope[i] - h * bend[i]);
            const Complex fourth = 3.0 * missed - turned;
            after[i] += third * (missed + fourth + ratio * fourth);
        }
        after[joint_] = z[joint_] + step;
        if (!correct(after, of_joint_)) return false;
        for (std::size_t i = 0; i < n; ++i) moved[i] = after[i] - z[i];
        if (!(weighted_size(moved, ball) < ball.radius)) return false;  // in the ball there is only one
        before = {z, slope, step};
        z = after;
        z[joint_] = z[joint_].real();
        return true;
    }

    static double weighted_size(const Configuration& change, const Ball<n>& ball) {
        double total = 0.0;
        for (std::size_t i = 0; i < n; ++i) total += std::norm(change[i]) / (ball.weight[i] * ball.weight[i]);
        return std::sqrt(total);
    }

    // Whether the imaginary part of some joint keeps its sign on a step of this ``speed``.
    static bool stays_nonreal(const Configuration& z, const Configuration& slope, const Ball<n>& ball,
                              double step, double speed) {
        const double length = 4.0 / 3.0 * speed * step;
        const double strayed = 0.5 * ball.bound * length * length;  // from the tangent
        for (std::size_t i = 0; i < n; ++i) {
            const double here = z[i].imag() / ball.weight[i];
            const double there = (z[i].imag() + slope[i].imag() * step) / ball.weight[i];
            if (here * there > 0.0 && std::min(std::abs(here), std::abs(there)) > strayed) return true;
        }
        return false;
    }

    // Whether a sheet is so near a fold that it is one of its pair.
    bool has_joined(const Configuration& z, const Fold<n>& fold) const {
        constexpr double turn = 2.0 * std::numbers::pi;
        double away = 0.0;
        Complex along = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
            Complex apart = z[i] - fold.configuration[i];
            apart -= turn * std::nearbyint(apart.real() / turn);
            if (i == joint_ && std::abs(apart) >= fold.across) return false;
            away += std::norm(apart) / (fold.weight[i] * fold.weight[i]);
            along += fold.tangent[i] * apart;
        }
        return std::sqrt(away) < fold.away && std::abs(along) < fold.along;
    }

    // The unit tangent of the solutions through a configuration, real where that is; its largest
    // entry is positive.
    Configuration tangent(const Configuration& z) const {
        const auto screws = linearize(z).screws;
        std::array<std::array<Complex, 6>, n> columns;
        for (std::size_t j = 0; j < n; ++j) columns[j] = entries(screws[j]);
        Configuration out = bifurc::smallest_singular_value(columns).vector;
        const auto is_smaller = [](const Complex& p, const Complex& q) {
            return std::norm(p) < std::norm(q);
        };
        const Complex largest = *std::max_element(out.begin(), out.end(), is_smaller);
        for (Complex& entry : out) entry *= std::conj(largest) / std::abs(largest);
        return out;
    }

    // The curve through a configuration, its series from values on a circle; none where no ball is
    // proved.
    std::optional<SheetCurve<n>> curve_through(const Configuration& z) const {
        constexpr int count = sheets::coefficients;
        SheetCurve<n> curve{.at = z, .tangent = tangent(z)};
        Configuration along;
        for (std::size_t i = 0; i < n; ++i) along[i] = std::conj(curve.tangent[i]);
        curve.ball = ball_around(z, along);
        if (!(curve.ball.radius > 0.0)) return {};
        curve.reach = 0.75 * curve.ball.radius / weighted_size(curve.tangent, curve.ball);
        const double radius = 0.5 * curve.reach;
        Configuration bend{};  // of the curve, as the point before shows it
        std::array<Complex, count> roots, turned;
        for (int k = 0; k < count; ++k) {
            roots[k] = std::polar(1.0, 2.0 * std::numbers::pi * k / count);
            const Complex t = radius * roots[k];
            Configuration point = z, moved;
            for (std::size_t i = 0; i < n; ++i) point[i] += t * (curve.tangent[i] + t * bend[i]);
            if (!correct(point, along)) return {};
            for (std::size_t i = 0; i < n; ++i) moved[i] = point[i] - z[i];
            if (!(weighted_size(moved, curve.ball) <= curve.ball.radius)) return {};
            turned[k] = moved[joint_];
            for (std::size_t i = 0; i < n; ++i) bend[i] = (moved[i] / t - curve.tangent[i]) / t;
        }
        double power = 1.0;
        for (int k = 0; k < count; ++k) {
            Complex total = 0.0;
            for (int j = 0; j < count; ++j) total += turned[j] * std::conj(roots[j * k % count]);
            total /= count * power;
            if (k == 1) curve.slope = total;
            curve.terms[k] = std::abs(total);
            power *= radius;
        }
        const double strayed = 0.5 * curve.ball.bound * curve.ball.radius * curve.ball.radius;
        curve.largest = curve.reach * std::abs(curve.tangent[joint_]) + curve.ball.weight[joint_] * strayed;
        return curve;
    }

    std::array<Link<double>, n> links_;
    Configuration of_joint_{};
    std::size_t joint_;
};

}  // namespace linkages
