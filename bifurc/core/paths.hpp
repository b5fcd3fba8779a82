// Solutions of a square system over the complex numbers, followed while its parameters move:
// `bifurc.paths` says what for.
//
// The next point is predicted by the Taylor series of the path, whose last coefficients bound how far
// it is trusted, and corrected by Newton's method (Allgower and Georg 1990). A path that comes to a
// singular end is led round it, where its mean is that end (Cauchy's integral: Morgan, Sommese and
// Wampler 1991).
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "bifurc/core/arrays.hpp"
#include "bifurc/core/lu.hpp"
#include "bifurc/core/tape.hpp"
#include "bifurc/core/twofold.hpp"

namespace bifurc {

namespace paths {

using Complex = std::complex<double>;

// Of the estimated radius of convergence: a longer step is not tried.
constexpr double longest_share = 0.6;
constexpr double shorter = 0.4;        // by which a step that failed is shortened
constexpr double shortest = 1e-13;     // step, over the size of the rest or of the way
constexpr double shortest_turn = 1e-3; // step in the logarithm, over the rest
constexpr double contraction = 0.05;   // of a correction to the next, on an accepted step
constexpr double rounding = 1e-9;      // a correction that may be one of rounding
constexpr double exact = 1e-14;        // a correction after which no other is made
constexpr int last_corrections = 6;    // at the end of a path
constexpr double far_away = 1e8;       // unknown beyond which a path runs to infinity
// Where what is left of a path is less than this, it is led round its end, and again whenever it is
// less by the factor; what is left at last is nothing.
constexpr double near_end = 1e-2, nearer = 0.2, last_rest = 1e-13;
constexpr int corners = 8;             // of a way round the end
// Round the end until the path is where it was: at the first look, as nearer to it there are fewer other
// singularities inside; and at any.
constexpr int first_turns = 4, most_turns = 24;
constexpr int steps_of_turn = 64;      // more are taken only beside other singularities, or where digits end
constexpr double closed = 1e-7;        // gap of a way round the end that is closed
constexpr double agreement = 1e-9;     // of two means, over their size
constexpr double solved = 1e-10;       // residual of a mean, over 1 + its size
constexpr double growth = 1.1;         // by which the way round an end at infinity grows
// What is left of a path that has an end at infinity. Where parameters are of different sizes, a path
// may run away until what is left is as small as the least of them, and come back.
constexpr double rest_at_infinity = 1e-11;
// What is left of a path that is given up where it is too far away to be of interest.
constexpr double rest_outside = 1e-6;

}  // namespace paths

// How a path ended; as in `bifurc.paths`.
enum class PathEnd { regular = 0, singular = 1, at_infinity = 2, stuck = 3, too_long = 4, no_start = 5, out_of_time = 6 };

struct PathSettings {
    Index order;       // of the predictor
    double tolerance;  // of a prediction, over 1 + the size of the point
    int most_steps;
    // Of homogeneous coordinates, the first unknowns, over the first of them: what is larger is of no
    // interest.
    Index places;
    double farthest;
    // Whether residuals are computed with twice the digits of doubles from the start, and not only from where no
    // step is short enough: far from 1, and near singular points, points are corrected to the last digits with
    // them only.
    bool is_precise;
    // Whether all ends are known to be regular: then no path is led round its own.
    bool ends_regular;
};

// A place on a path: t, or its logarithm, in which a path round a singular end is smooth.
struct PathPlace {
    paths::Complex value;
    bool is_logarithm = false;

    paths::Complex t() const { return is_logarithm ? std::exp(value) : value; }
};

// F(x; p) = 0 with x the first unknowns of a tape and p the others, on the line of parameters
// last + t (first - last). With more equations than unknowns ``combinations`` (n, m) of them are solved.
// Residuals of `linearize` are ``precise`` where that is set.
class PathSystem {
public:
    using Complex = paths::Complex;

    PathSystem(const Tape& tape, Index unknowns, View<const Complex> combinations, Index order)
        : tape_(tape),
          n_(unknowns),
          combinations_(combinations),
          first_(tape.unknowns() - unknowns),
          last_(first_.size()),
          change_(first_.size()),
          point_(tape.unknowns()),
          row_(unknowns),
          equations_(tape.equations()),
          precise_point_(tape.unknowns()),
          precise_values_(tape.slots()),
          sweep_(tape),
          series_(tape, order, unknowns),
          series_of_logarithm_(tape, order, unknowns, Change::exponentially),
          is_standing_(tape.unknowns()) {
        for (Index row = 0; row < tape.equations(); ++row) {
            std::vector<Index>& cone = cones_.emplace_back();
            for (Index slot : tape.cone(row)) {
                if (series_.is_moving(slot)) cone.push_back(slot);
            }
        }
    }

    Index unknowns() const { return n_; }
    void set_line(Vector<const Complex> first, Vector<const Complex> last) {
        std::copy(first.begin(), first.end(), first_.begin());
        std::copy(last.begin(), last.end(), last_.begin());
        for (std::size_t i = 0; i < change_.size(); ++i) {
            change_[i] = first_[i] - last_[i];
            is_standing_[n_ + i] = change_[i] == 0.0;
        }
        series_.set_standing(is_standing_);
        series_of_logarithm_.set_standing(is_standing_);
    }
    void set_precise(bool is_precise) { is_precise_ = is_precise; }

    // F at a point and t, and its factored derivatives by x; false where these are singular.
    bool linearize(Vector<const Complex> x, Complex t, Vector<Complex> residual, ComplexLu& lu) {
        place(x, t);
        sweep_.linearize(point_);
        for (Index row = 0; row < tape_.equations(); ++row) equations_[row] = sweep_.value(row);
        if (is_precise_) evaluate_precisely(x, t);
        combine(residual);
        const View<Complex> matrix = lu.matrix();
        std::fill_n(matrix.data, n_ * n_, Complex(0.0));
        for (Index row = 0; row < tape_.equations(); ++row) {
            if (!combinations_.rows) {
                sweep_.gradient(row, cones_[row], [&](Index unknown, const Complex& entry) { matrix(row, unknown) += entry; });
                continue;
            }
            std::fill(row_.begin(), row_.end(), Complex(0.0));
            sweep_.gradient(row, cones_[row], [&](Index unknown, const Complex& entry) { row_[unknown] += entry; });
            for (Index i = 0; i < n_; ++i) {
                for (Index j = 0; j < n_; ++j) matrix(i, j) += combinations_(i, row) * row_[j];
            }
        }
        return lu.factor();
    }

    // Taylor coefficients (order + 1, n) of the path through a point, in powers of t or of its logarithm, with the
    // derivatives of where `linearize` was called last, and lu from there: next to it.
    void series(Vector<const Complex> x, const PathPlace& place, const ComplexLu& lu, View<Complex> coefficients) {
        SeriesSweep<Complex>& series = place.is_logarithm ? series_of_logarithm_ : series_;
        const Complex pace = place.is_logarithm ? place.t() : 1.0;
        for (std::size_t i = 0; i < change_.size(); ++i) series.set_rate(n_ + static_cast<Index>(i), pace * change_[i]);
        series.start(sweep_);
        std::copy(x.begin(), x.end(), coefficients.row(0).begin());
        for (Index k = 1; k < coefficients.rows; ++k) {
            series.advance(k);
            for (Index row = 0; row < tape_.equations(); ++row) equations_[row] = -series.coefficient(row, k);
            const Vector<Complex> solution = coefficients.row(k);
            combine(solution);
            lu.solve(solution);
            if (k + 1 < coefficients.rows) series.correct(k, solution);
        }
    }

private:
    void place(Vector<const Complex> x, Complex t) {
        std::copy(x.begin(), x.end(), point_.begin());
        for (std::size_t i = 0; i < change_.size(); ++i) point_[n_ + i] = last_[i] + t * change_[i];
    }

    // F with twice the digits, also of the parameters at t.
    void evaluate_precisely(Vector<const Complex> x, Complex t) {
        std::copy(x.begin(), x.end(), precise_point_.begin());
        const TwofoldComplex share(t), rest = TwofoldComplex(1.0) - share;
        for (std::size_t i = 0; i < change_.size(); ++i) {
            precise_point_[n_ + i] = rest * TwofoldComplex(last_[i]) + share * TwofoldComplex(first_[i]);
        }
        tape_.evaluate<TwofoldComplex>(precise_point_, precise_values_);
        for (Index row = 0; row < tape_.equations(); ++row) equations_[row] = precise_values_[tape_.output(row)].rounded();
    }

    void combine(Vector<Complex> out) const {
        if (!combinations_.rows) {
            std::copy(equations_.begin(), equations_.end(), out.begin());
            return;
        }
        for (Index i = 0; i < n_; ++i) {
            out[i] = 0.0;
            for (Index row = 0; row < tape_.equations(); ++row) out[i] += combinations_(i, row) * equations_[row];
        }
    }

    const Tape& tape_;
    Index n_;
    View<const Complex> combinations_;
    bool is_precise_ = false;
    std::vector<Complex> first_, last_, change_, point_, row_, equations_;
    std::vector<TwofoldComplex> precise_point_, precise_values_;
    Sweep<Complex> sweep_;
    SeriesSweep<Complex> series_, series_of_logarithm_;
    std::vector<char> is_standing_;          // which unknowns of the tape do not change on the line
    std::vector<std::vector<Index>> cones_;  // of every equation, of what depends on x
};

class PathTracker {
public:
    using Complex = paths::Complex;
    using Point = std::vector<Complex>;

    PathTracker(PathSystem& system, const PathSettings& settings)
        : system_(system),
          settings_(settings),
          lu_(system.unknowns()),
          coefficients_(settings.order + 1, system.unknowns()),
          correction_(system.unknowns()) {}

    struct Outcome {
        Point point;
        double rest = 1.0;  // t where the path was left
        PathEnd end = PathEnd::no_start;
        int winding = 1;  // turns after which a path round its end is where it was
        int steps = 0;
        bool is_over = false;
    };

    // From a solution at t = 1 towards t = 0.
    Outcome follow(Vector<const Complex> start) {
        Outcome out{{start.begin(), start.end()}};
        steps_ = 0;
        set_precise(settings_.is_precise);
        PathPlace place{1.0};
        if (!begin(out.point, place)) return out;
        const double near_end = settings_.ends_regular ? 0.0 : paths::near_end;
        while (!out.is_over && (place.t().real() > near_end || trusted_length() >= place.t().real())) advance(out, place, 0.0);
        Circuit before;
        for (int turns = paths::first_turns; !out.is_over; turns += paths::first_turns) {
            const double t = place.t().real();
            const Circuit circuit = go_round(out.point, t, std::min(turns, paths::most_turns));
            if (circuit.winding && circuit.winding == before.winding) judge(out, circuit, before);
            before = circuit;
            if (out.is_over) break;
            place = {t};
            if (!begin(out.point, place)) {
                finish(out, PathEnd::stuck);
            } else if (trusted_length() >= t) {
                advance(out, place, 0.0);
            } else {
                place = {std::log(t), true};
                expand(out.point, place);
                const Complex goal = std::log(paths::nearer * t);
                while (place.value != goal && !out.is_over) advance(out, place, goal);
            }
        }
        out.steps = steps_;
        return out;
    }

private:
    // Round the end of a path: the mean of the points, how far they are from it, and after how many
    // turns the path was back; none where it did not come back. Where a power -``pole`` of the root of t
    // that has this winding is the largest term, those of lower powers come to ``beyond`` of it.
    struct Circuit {
        int winding = 0;
        Point mean;
        double extent = 0.0;
        int pole = 0;
        double beyond = 0.0;
    };

    static void finish(Outcome& out, PathEnd end) {
        out.end = end;
        out.is_over = true;
    }

    // One step towards a place on the straight way; at t = 0 it is over, and where it cannot go on, or has gone
    // far enough.
    void advance(Outcome& out, PathPlace& place, Complex goal) {
        const bool is_ahead = step(out.point, place, goal);
        out.rest = place.t().real();
        const bool is_short = out.rest < paths::rest_outside;
        if (!is_ahead) {
            finish(out, PathEnd::stuck);
        } else if (out.rest == 0.0) {
            polish(out.point);
            finish(out, PathEnd::regular);
        } else if (largest(out.point) > paths::far_away || (is_short && is_outside(out.point))) {
            finish(out, PathEnd::at_infinity);
        } else if (steps_ >= settings_.most_steps || out.rest < paths::last_rest) {
            finish(out, PathEnd::too_long);
        }
    }

    // Whether a path is over whose last two circuits have the same winding.
    void judge(Outcome& out, const Circuit& circuit, const Circuit& before) {
        out.winding = circuit.winding;
        const bool has_grown = out.rest < paths::rest_at_infinity && circuit.extent > paths::growth * before.extent;
        // A place at e < t from which the path comes back has terms of lower powers, e / t of the largest.
        const bool is_at_pole = circuit.pole && circuit.pole == before.pole && circuit.beyond * out.rest < paths::rest_at_infinity;
        if (has_grown || is_at_pole) {
            finish(out, PathEnd::at_infinity);
        } else if (distance(circuit.mean, before.mean) < paths::agreement && is_solution(circuit.mean)) {
            out.rest = 0.0;
            out.point = circuit.mean;
            finish(out, PathEnd::singular);
            Point regular = circuit.mean;
            if (circuit.winding == 1 && is_corrected(regular, 0.0)) {
                polish(regular);
                out.point = regular;
                out.end = PathEnd::regular;
            }
        }
    }

    void set_precise(bool is_precise) {
        is_precise_ = is_precise;
        system_.set_precise(is_precise);
    }

    static double largest(const Point& point) {
        double size = 0.0;
        for (const Complex& entry : point) size = std::max(size, rough_size(entry));
        return size;
    }

    // Whether a point in homogeneous coordinates is too far away to be of interest.
    bool is_outside(const Point& point) const {
        if (!std::isfinite(settings_.farthest)) return false;
        double size = 0.0;
        for (Index i = 1; i < settings_.places; ++i) size = std::max(size, rough_size(point[i]));
        return rough_size(point[0]) * settings_.farthest < size;
    }

    static double distance(const Point& point, const Point& other) {
        double size = 0.0, scale = 1.0;
        for (std::size_t i = 0; i < point.size(); ++i) {
            size = std::max(size, rough_size(point[i] - other[i]));
            scale = std::max(scale, rough_size(point[i]));
        }
        return size / scale;
    }

    // One step of Newton's method, with derivatives that stay in `lu_`; its size over that of the point,
    // infinite where it cannot be made.
    double correct(Point& point, Complex t) {
        constexpr double infinity = std::numeric_limits<double>::infinity();
        if (!system_.linearize(point, t, correction_, lu_)) return infinity;
        lu_.solve(correction_);
        const double size = largest(correction_);
        if (!std::isfinite(size)) return infinity;
        for (std::size_t i = 0; i < point.size(); ++i) point[i] -= correction_[i];
        return size / (1.0 + largest(point));
    }

    // Corrects a predicted point, by two steps of which the second is much smaller than the first: a
    // theorem of Newton and Kantorovich in small.
    bool is_corrected(Point& point, Complex t) {
        const double first = correct(point, t);
        if (!(first <= trust())) return false;
        const double second = correct(point, t);
        return second <= std::max(paths::contraction * first, paths::rounding) && second <= settings_.tolerance;
    }

    // The largest first correction that is trusted.
    double trust() const { return 10.0 * settings_.tolerance; }

    void expand(const Point& point, const PathPlace& place) { system_.series(point, place, lu_, coefficients_); }

    // Corrects a start and expands the path there.
    bool begin(Point& point, const PathPlace& place) {
        if (!is_corrected(point, place.t())) return false;
        expand(point, place);
        return true;
    }

    // Whether a point solves the equations at the end. Where two paths meet beside the end, their mean
    // round it is between them.
    bool is_solution(const Point& point) {
        system_.linearize(point, 0.0, correction_, lu_);
        return largest(correction_) < paths::solved * (1.0 + largest(point));
    }

    // How far the series is trusted: what the terms that are left out come to is below the tolerance, and
    // a share of the radius of convergence is not exceeded. That keeps a path from one that it passes
    // closely, which prediction and correction may well reach: between them is a singularity. By the
    // first terms nothing is told of it.
    double trusted_length() const {
        const Index order = settings_.order;
        const double last = std::max({size_of(order), size_of(order - 1), 1e-300});
        const double before = std::max(size_of(order - 4), size_of(order - 5));
        const double radius = std::sqrt(std::sqrt(before / last));
        const double allowed = settings_.tolerance * (1.0 + size_of(0));
        const double length = std::pow(allowed / std::max(size_of(order), 1e-300), 1.0 / static_cast<double>(order));
        return std::min(length, before > 0.0 ? paths::longest_share * radius : length);
    }

    double size_of(Index k) const {
        double size = 0.0;
        for (const Complex& entry : coefficients_.row(k)) size = std::max(size, rough_size(entry));
        return size;
    }

    void predict(Complex way, Point& point) const {
        for (std::size_t i = 0; i < point.size(); ++i) {
            Complex value = coefficients_(settings_.order, i);
            for (Index k = settings_.order - 1; k >= 0; --k) value = coefficients_(k, i) + way * value;
            point[i] = value;
        }
    }

    // From a point whose series is known towards ``goal``; false where no step is short enough.
    bool step(Point& point, PathPlace& place, Complex goal) {
        const Complex rest = goal - place.value;
        const double length = std::abs(rest);
        const double least = place.is_logarithm ? paths::shortest_turn : paths::shortest * std::max(1.0, 1.0 / length);
        double share = trusted_length() / length;
        Point ahead(point.size());
        while (steps_ < settings_.most_steps) {
            ++steps_;
            const bool is_whole = share >= 1.0;
            const Complex way = is_whole ? rest : share * rest;
            const PathPlace next{is_whole ? goal : place.value + way, place.is_logarithm};
            predict(way, ahead);
            if (is_corrected(ahead, next.t())) {
                point.swap(ahead);
                place = next;
                expand(point, place);
                return true;
            }
            share = paths::shorter * std::min(share, 1.0);
            if (share > least) continue;
            if (is_precise_) return false;
            set_precise(true);
            share = std::min(1.0, trusted_length() / length);
        }
        return true;
    }

    // Follows the path on a circle round t = 0, turn after turn, until it is back.
    Circuit go_round(const Point& start, double radius, int most_turns) {
        Circuit out;
        Point point = start;
        std::vector<Point> corners;
        PathPlace place{std::log(radius), true};
        const Complex side(0.0, 2.0 * std::numbers::pi / paths::corners);
        if (!begin(point, place)) return {};
        for (int turn = 1; turn <= most_turns; ++turn) {
            const int most_steps = std::min(steps_ + paths::steps_of_turn, settings_.most_steps);
            for (int corner = 1; corner <= paths::corners; ++corner) {
                const Complex goal = place.value + side;
                while (place.value != goal) {
                    if (!step(point, place, goal) || steps_ >= most_steps) return {};
                }
                corners.push_back(point);
            }
            if (distance(point, start) > paths::closed) continue;
            out.winding = turn;
            out.mean.assign(start.size(), 0.0);
            for (const Point& corner : corners) {
                for (std::size_t i = 0; i < corner.size(); ++i) out.mean[i] += corner[i] / static_cast<double>(corners.size());
            }
            for (const Point& corner : corners) {
                for (std::size_t i = 0; i < corner.size(); ++i) out.extent = std::max(out.extent, rough_size(corner[i] - out.mean[i]));
            }
            tell_pole(corners, out);
            return out;
        }
        return {};
    }

    // The powers of a Laurent series through the ``corners`` of a way round t = 0, by a sum of Fourier's.
    static void tell_pole(const std::vector<Point>& corners, Circuit& out) {
        const int count = static_cast<int>(corners.size()), lowest = 1 - count / 2;
        std::vector<double> sizes;  // of the terms, from the lowest power on
        for (int power = lowest; power <= count / 2; ++power) {
            Point term(corners.front().size());
            for (int k = 0; k < count; ++k) {
                const double angle = -2.0 * std::numbers::pi * power * (k + 1) / count;
                const Complex turn = std::polar(1.0 / count, angle);
                for (std::size_t i = 0; i < term.size(); ++i) term[i] += turn * corners[k][i];
            }
            sizes.push_back(largest(term));
        }
        const auto most = std::max_element(sizes.begin(), sizes.end());
        out.pole = std::max(0, -lowest - static_cast<int>(most - sizes.begin()));
        for (auto size = sizes.begin(); size != most; ++size) out.beyond = std::max(out.beyond, *size / *most);
    }

    // Newton's method at the end, as long as its steps become shorter.
    void polish(Point& point) {
        set_precise(true);
        double former = 1.0;
        for (int i = 0; i < paths::last_corrections; ++i) {
            Point better = point;
            const double size = correct(better, 0.0);
            if (!(size < former)) return;
            point.swap(better);
            former = size;
            if (size < paths::exact) return;
        }
    }

    PathSystem& system_;
    PathSettings settings_;
    ComplexLu lu_;
    Matrix<Complex> coefficients_;
    Point correction_;
    int steps_ = 0;
    bool is_precise_ = false;
};

}  // namespace bifurc
