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
#include "bifurc/core/null_vector.hpp"
#include "linkages/core/complex_lanes.hpp"
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

// The pseudo-inverse of joint screws over a row that singles out one solution; ``T`` is one complex
// number, or four.
template <class T, std::size_t n>
class BorderedScrews {
public:
    using Configuration = std::array<T, n>;

    // Gram-Schmidt, twice.
    BorderedScrews(const std::array<Screw<T>, n>& screws, const Configuration& along) {
        for (std::size_t j = 0; j < n; ++j) {
            const auto& [w, v] = screws[j];
            std::array<T, 7>& column = orthonormal_[j];
            column = {w[0], w[1], w[2], v[0], v[1], v[2], along[j]};
            for (std::size_t i = 0; i < j; ++i) upper_[i][j] = 0.0;
            for (int time = 0; time < 2; ++time) {
                for (std::size_t i = 0; i < j; ++i) {
                    T inner = 0.0;
                    for (int k = 0; k < 7; ++k) inner += conj(orthonormal_[i][k]) * column[k];
                    upper_[i][j] += inner;
                    for (int k = 0; k < 7; ++k) column[k] -= inner * orthonormal_[i][k];
                }
            }
            RealOf<T> square = norm(column[0]);
            for (int k = 1; k < 7; ++k) square = square + norm(column[k]);
            inverse_diagonal_[j] = 1.0 / root(square);
            for (T& entry : column) entry = inverse_diagonal_[j] * entry;
        }
    }

    // All columns: the first six for a twist, the last one for the row.
    std::array<Configuration, 7> inverse() const {
        std::array<Configuration, 7> out;
        for (int k = 0; k < 7; ++k) {
            Configuration right;
            for (std::size_t i = 0; i < n; ++i) right[i] = conj(orthonormal_[i][k]);
            out[k] = times_inverse_of_upper(right);
        }
        return out;
    }

    // What it makes of a twist.
    Configuration solve(const std::array<T, 6>& twist) const {
        Configuration right;
        for (std::size_t i = 0; i < n; ++i) {
            right[i] = conj(orthonormal_[i][0]) * twist[0];
            for (int k = 1; k < 6; ++k) right[i] += conj(orthonormal_[i][k]) * twist[k];
        }
        return times_inverse_of_upper(right);
    }

private:
    Configuration times_inverse_of_upper(Configuration right) const {
        for (std::size_t i = n; i-- > 0;) {
            for (std::size_t j = i + 1; j < n; ++j) right[i] -= upper_[i][j] * right[j];
            right[i] = inverse_diagonal_[i] * right[i];
        }
        return right;
    }

    std::array<std::array<T, 7>, n> orthonormal_;
    std::array<std::array<T, n>, n> upper_;
    std::array<RealOf<T>, n> inverse_diagonal_;
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
template <class T, std::size_t n>
struct SecondDerivatives {
    static constexpr std::size_t pairs = n * (n - 1) / 2;

    std::array<std::array<T, n>, pairs> of_pair;

    SecondDerivatives(const std::array<Screw<T>, n>& screws, const std::array<std::array<T, n>, 7>& inverse) {
        std::size_t number = 0;
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = i + 1; j < n; ++j, ++number) {
                const auto half_bracket = entries(0.5 * bracket(screws[i], screws[j]));
                for (std::size_t a = 0; a < n; ++a) {
                    T value = 0.0;
                    for (int k = 0; k < 6; ++k) value += inverse[k][a] * half_bracket[k];
                    of_pair[number][a] = value;
                }
            }
        }
    }

    // The quadratic form at a direction.
    std::array<T, n> at(const std::array<T, n>& direction) const {
        std::array<T, n> out{};
        std::size_t number = 0;
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = i + 1; j < n; ++j, ++number) {
                const T product = 2.0 * (direction[i] * direction[j]);
                for (std::size_t a = 0; a < n; ++a) out[a] += product * of_pair[number][a];
            }
        }
        return out;
    }

    // A bound of the largest singular value in the norm with these weights.
    RealOf<T> size(const std::array<RealOf<T>, n>& weight) const {
        auto scaled = of_pair;
        std::size_t number = 0;
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = i + 1; j < n; ++j, ++number) {
                for (std::size_t a = 0; a < n; ++a)
                    scaled[number][a] = weight[i] * weight[j] / weight[a] * scaled[number][a];
            }
        }
        RealOf<T> trace{};
        std::array<RealOf<T>, n> rows{};  // sums of the entries of the Gram matrix
        for (std::size_t a = 0; a < n; ++a) {
            for (std::size_t b = 0; b <= a; ++b) {
                T entry = 0.0;
                for (std::size_t k = 0; k < pairs; ++k) entry += scaled[k][a] * conj(scaled[k][b]);
                const RealOf<T> size = 2.0 * (a == b ? real(entry) : root(norm(entry)));
                rows[a] = rows[a] + size;
                if (a == b)
                    trace = trace + size;
                else
                    rows[b] = rows[b] + size;
            }
        }
        RealOf<T> largest = rows[0];
        for (std::size_t a = 1; a < n; ++a) largest = larger(largest, rows[a]);
        return root(smaller(trace, largest));
    }
};

// What bounds the second derivative about a configuration: by ``center`` there, in the norm that divides
// each joint by its weight, and by ``growth`` times exp(``rate`` r) - 1 more at a distance r.
template <class R, std::size_t n>
struct BallTerms {
    std::array<R, n> weight;
    R center, growth, rate;
};

template <class T, std::size_t n>
BallTerms<RealOf<T>, n> ball_terms(const std::array<Screw<T>, n>& screws,
                                   const std::array<std::array<T, n>, 7>& inverse,
                                   const SecondDerivatives<T, n>& second) {
    using R = RealOf<T>;
    const auto size_of = [](const Vec3<T>& part) {
        R squares_of_real{}, squares_of_imaginary{};
        for (const T& entry : part) {
            squares_of_real = squares_of_real + real(entry) * real(entry);
            squares_of_imaginary = squares_of_imaginary + imag(entry) * imag(entry);
        }
        return root(squares_of_real) + root(squares_of_imaginary);
    };
    BallTerms<R, n> terms;
    R total{}, square{};
    for (std::size_t i = 0; i < n; ++i) {
        const R m = 0.5 * (size_of(screws[i].direction) + size_of(screws[i].moment));
        // a joint with a large screw may move less; the root takes the fewest steps
        terms.weight[i] = 1.0 / root(m);
        total = total + m;
        R row{};
        for (int k = 0; k < 6; ++k) row = row + norm(inverse[k][i]);
        square = square + row * m;
    }
    terms.center = second.size(terms.weight);
    terms.growth = 2.0 * root(square) * total;
    terms.rate = root(total);
    return terms;
}

template <std::size_t n>
Ball<n> find_ball(const BallTerms<double, n>& terms) {
    const auto bound_at = [&](double radius) {
        return terms.center + terms.growth * std::expm1(terms.rate * radius);
    };
    Ball<n> ball{terms.weight, std::min(0.5 / terms.center, 1.0), 0.0};
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

// A sheet: where it is, the angle to which it is to be followed, and the folds that it may join.
template <std::size_t n>
struct Sheet {
    std::array<Complex, n> at;
    double end;
    std::vector<const Fold<n>*> folds;
    bool is_cleared = false;  // it got there without becoming real, or joined a fold
    bool is_over = false;
    // the place before, its rates, and the step that was taken from it; 0 where there is none
    std::array<Complex, n> before{}, slope_before{};
    double step_before = 0.0;
    int steps_in_angle = 0, steps_along = 0;
};

// Follows sheets of a loop of n joints as ``joint`` (from 0) turns.
template <std::size_t n>
class SheetTracker {
public:
    using Configuration = std::array<Complex, n>;
    using Links = std::array<Link<double>, n>;

    // ``geometry`` (6, n) as for `Closure`.
    SheetTracker(bifurc::View<const double> geometry, std::size_t joint) : joint_(joint) {
        for (std::size_t i = 0; i < n; ++i) {
            links_[i] = {geometry(0, i), geometry(1, i), {geometry(2, i), geometry(3, i)}};
        }
        of_joint_[joint] = 1.0;
    }

    // Joint screws and the closure error.
    template <class T>
    struct Linearization {
        std::array<Screw<T>, n> screws;
        Screw<T> error;
    };

    Linearization<Complex> linearize(const Configuration& z) const {
        std::array<Turn<Complex>, n> turns;
        for (std::size_t i = 0; i < n; ++i) turns[i] = turn_by(z[i]);
        return linearization(links_, turns);
    }

    // The ball around a configuration for the coordinate ``along``.
    Ball<n> ball_around(const Configuration& z, const Configuration& along) const {
        const auto screws = linearize(z).screws;
        const auto inverse = BorderedScrews<Complex, n>(screws, along).inverse();
        return find_ball(ball_terms(screws, inverse, SecondDerivatives<Complex, n>(screws, inverse)));
    }

    // Follows sheets, four abreast: by steps in the angle of the joint, and where these get short by one
    // along the curve. They stop where they are when the time is over.
    void follow(std::vector<Sheet<n>>& sheets, bifurc::Deadline& deadline) const {
        std::array<Sheet<n>*, lane_count> lanes{};
        std::size_t next = 0;
        Places places{};
        while (true) {
            bool is_any = false;
            for (int lane = 0; lane < lane_count; ++lane) {
                Sheet<n>*& sheet = lanes[lane];
                while (!sheet || !goes_on(*sheet)) {
                    sheet = next < sheets.size() && !deadline.has_passed() ? &sheets[next++] : nullptr;
                    if (!sheet) break;
                }
                if (!sheet) continue;
                is_any = true;
                set_turns(places, lane, sheet->at);
            }
            if (!is_any) return;
            Outlook outlook;
            look(links_, joint_, places, outlook);
            std::array<Step, lane_count> steps;
            for (int lane = 0; lane < lane_count; ++lane) {
                if (!lanes[lane]) continue;
                steps[lane] = step_of(*lanes[lane], outlook, lane);
                if (!steps[lane].is_proved) step_along(*lanes[lane]);
                if (deadline.has_passed()) lanes[lane]->is_over = true;
            }
            correct_all(places, steps);
            for (int lane = 0; lane < lane_count; ++lane) {
                if (lanes[lane] && steps[lane].is_proved) take(*lanes[lane], steps[lane]);
            }
        }
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
    using Places = std::array<Turn<ComplexLanes>, n>;
    using Columns = std::array<ComplexLanes, n>;

    // What is seen from configurations as the joint turns: rates, second derivatives, and balls.
    struct Outlook {
        Columns slope, bend;
        BallTerms<Packed, n> terms;
    };

    // A step of a sheet, whether it is proved, and where it leads.
    struct Step {
        bool is_proved = false, is_correct = false;
        double length;
        Configuration slope, after;
        Ball<n> ball;
    };

    template <class T>
    static Linearization<T> linearization(const Links& links, const std::array<Turn<T>, n>& turns) {
        Linearization<T> out;
        Frame<T> frame;
        for (std::size_t i = 0; i < n; ++i) {
            out.screws[i] = frame.joint();
            frame.advance(turns[i], links[i]);
        }
        out.error = frame.skew_gap();
        return out;
    }

    static void set_turns(Places& places, int lane, const Configuration& z) {
        for (std::size_t i = 0; i < n; ++i) {
            const Turn<Complex> turn = turn_by(z[i]);
            places[i].cosine.set(lane, turn.cosine);
            places[i].sine.set(lane, turn.sine);
        }
    }

    static Configuration of_lane(const Columns& columns, int lane) {
        Configuration out;
        for (std::size_t i = 0; i < n; ++i) out[i] = columns[i].at(lane);
        return out;
    }

    LINKAGES_VECTORISED static void look(const Links& links, std::size_t joint, const Places& places,
                                         Outlook& out) {
        const auto screws = linearization(links, places).screws;
        Columns along{};
        along[joint] = 1.0;
        const auto inverse = BorderedScrews<ComplexLanes, n>(screws, along).inverse();
        const SecondDerivatives<ComplexLanes, n> second(screws, inverse);
        out.slope = inverse[6];
        out.bend = second.at(out.slope);
        out.terms = ball_terms(screws, inverse, second);
    }

    // Corrections by Newton's method with the angle of the joint as it is.
    LINKAGES_VECTORISED static void correct_once(const Links& links, std::size_t joint,
                                                 const Places& places, Columns& out) {
        const auto at = linearization(links, places);
        Columns along{};
        along[joint] = 1.0;
        out = BorderedScrews<ComplexLanes, n>(at.screws, along).solve(entries(at.error));
    }

    // Newton's method at right angles to ``along``, in place; false where it does not converge.
    bool correct(Configuration& z, const Configuration& along) const {
        for (int i = 0; i < sheets::corrections; ++i) {
            const auto at = linearize(z);
            const BorderedScrews<Complex, n> bordered(at.screws, along);
            const double size = subtract(z, bordered.solve(entries(at.error)));
            if (!std::isfinite(size)) return false;
            if (size < sheets::corrected) return true;
        }
        return false;
    }

    // The same for all steps that are proved.
    void correct_all(Places& places, std::array<Step, lane_count>& steps) const {
        Columns corrections;
        for (int i = 0; i < sheets::corrections; ++i) {
            bool is_any = false;
            for (int lane = 0; lane < lane_count; ++lane) {
                if (!steps[lane].is_proved || steps[lane].is_correct) continue;
                set_turns(places, lane, steps[lane].after);
                is_any = true;
            }
            if (!is_any) return;
            correct_once(links_, joint_, places, corrections);
            for (int lane = 0; lane < lane_count; ++lane) {
                if (!steps[lane].is_proved || steps[lane].is_correct) continue;
                const double size = subtract(steps[lane].after, of_lane(corrections, lane));
                if (size < sheets::corrected) steps[lane].is_correct = true;
            }
        }
    }

    // Takes a correction from a configuration; the size of its largest entry, no number where one is
    // none. The error after it is of the order of its square.
    static double subtract(Configuration& z, const Configuration& correction) {
        double largest = 0.0, total = 0.0;
        for (std::size_t j = 0; j < n; ++j) {
            z[j] -= correction[j];
            largest = std::max(largest, std::norm(correction[j]));
            total += std::norm(correction[j]);
        }
        return std::isfinite(total) ? std::sqrt(largest) : total;
    }

    // Whether a sheet is to be followed on: it has not got to its end or into the neighbourhood of a fold.
    bool goes_on(Sheet<n>& sheet) const {
        if (sheet.is_over) return false;
        const bool has_arrived = std::abs(sheet.end - sheet.at[joint_].real()) < sheets::arrived;
        const auto is_joined = [&](const Fold<n>* fold) { return has_joined(sheet.at, *fold); };
        sheet.is_cleared = has_arrived || std::any_of(sheet.folds.begin(), sheet.folds.end(), is_joined);
        sheet.is_over = sheet.is_cleared;
        return !sheet.is_over;
    }

    // A step of a sheet in the angle of the joint, and where the polynomial through the place before
    // predicts that it leads; not proved where it would be short.
    Step step_of(const Sheet<n>& sheet, const Outlook& outlook, int lane) const {
        Step out{.slope = of_lane(outlook.slope, lane)};
        BallTerms<double, n> terms;
        for (std::size_t i = 0; i < n; ++i) terms.weight[i] = outlook.terms.weight[i][lane];
        terms.center = outlook.terms.center[lane];
        terms.growth = outlook.terms.growth[lane];
        terms.rate = outlook.terms.rate[lane];
        out.ball = find_ball(terms);
        const Configuration &z = sheet.at, &slope = out.slope;
        const double left = sheet.end - z[joint_].real(), speed = weighted_size(slope, out.ball);
        double step = std::copysign(std::min(0.75 * out.ball.radius / speed, std::abs(left)), left);
        while (!stays_nonreal(z, slope, out.ball, step, speed)) {
            step *= 0.5;
            if (!(std::abs(step) >= sheets::slow)) return out;  // nor not a number
        }
        if (!(std::abs(step) >= std::min(sheets::slow, std::abs(left)))) return out;
        const double h = sheet.step_before, ratio = h == 0.0 ? 0.0 : step / h;
        const double third = ratio * ratio * ratio;
        for (std::size_t i = 0; i < n; ++i) {
            const Complex bend = outlook.bend[i].at(lane);
            out.after[i] = z[i] + step * (slope[i] - 0.5 * step * bend);
            // what the second order misses of the step before, in its place and in its rate
            const Complex missed = z[i] - sheet.before[i] - h * (slope[i] + 0.5 * h * bend);
            const Complex turned = h * (sheet.slope_before[i] - slope[i] - h * bend);
            const Complex fourth = 3.0 * missed - turned;
            out.after[i] += third * (missed + fourth + ratio * fourth);
        }
        out.after[joint_] = z[joint_] + step;
        out.length = step;
        out.is_proved = true;
        return out;
    }

    // Moves a sheet by a step, where that was corrected to the only solution in the ball.
    void take(Sheet<n>& sheet, const Step& step) const {
        Configuration moved;
        for (std::size_t i = 0; i < n; ++i) moved[i] = step.after[i] - sheet.at[i];
        const bool is_in_ball = step.is_correct && weighted_size(moved, step.ball) < step.ball.radius;
        if (!is_in_ball || ++sheet.steps_in_angle > sheets::most_steps) return step_along(sheet);
        sheet.before = sheet.at;
        sheet.slope_before = step.slope;
        sheet.step_before = step.length;
        sheet.at = step.after;
        sheet.at[joint_] = sheet.at[joint_].real();
    }

    // Moves a sheet by a step along its curve: near a fold those in the angle get short, and the coordinate
    // along the tangent does not mind.
    void step_along(Sheet<n>& sheet) const {
        sheet.step_before = 0.0;
        sheet.steps_in_angle = 0;
        const bool may_move = ++sheet.steps_along <= sheets::most_along;
        sheet.is_over = !(may_move && advance_along(sheet.at, sheet.end));
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
