#include "linkages/core/slices_module.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bifurc/core/bindings.hpp"
#include "bifurc/core/deadline.hpp"
#include "linkages/core/assemblies.hpp"
#include "linkages/core/sheets.hpp"
#include "linkages/core/slices.hpp"

namespace nb = nanobind;
namespace python = bifurc::python;

namespace linkages {

namespace {

using bifurc::Deadline;
using bifurc::numpy::Array;
using bifurc::numpy::view;
using python::Doubles;
using python::Table;
using Complexes = bifurc::numpy::VectorIn<Complex>;
using ComplexTableIn = bifurc::numpy::MatrixIn<Complex>;
using Integers = bifurc::numpy::VectorIn<std::int64_t>;

void check_extent(const char* name, Index given, Index needed) {
    if (given == needed) return;
    const std::string text = std::string(name) + ": " + std::to_string(given) +
                             " is not allowed; there must be " + std::to_string(needed);
    throw nb::value_error(text.c_str());
}

// ``run`` with the number of joints as a constant: 4, 5 or 6.
template <class Run>
auto with_joints(const Table& geometry, Index joint, Run run) {
    const auto n = static_cast<Index>(geometry.shape(1));
    if (geometry.shape(0) != 6) throw nb::value_error("geometry: there must be 6 rows");
    if (joint < 0 || joint >= n) throw nb::value_error("joint: it must be one of the loop, from 0");
    switch (n) {
        case 4: return run.template operator()<4>();
        case 5: return run.template operator()<5>();
        case 6: return run.template operator()<6>();
        default: throw nb::value_error("geometry: there must be 4, 5 or 6 joints");
    }
}

template <class T, std::size_t n>
nb::object array_of(const std::vector<std::array<T, n>>& rows) {
    Array<T> out({static_cast<Index>(rows.size()), static_cast<Index>(n)});
    for (std::size_t i = 0; i < rows.size(); ++i)
        std::copy(rows[i].begin(), rows[i].end(), &out.data()[i * n]);
    return out.release();
}

template <class T>
nb::object array_of(const std::vector<T>& values) {
    Array<T> out({static_cast<Index>(values.size())});
    std::copy(values.begin(), values.end(), out.data());
    return out.release();
}

template <std::size_t n, class T>
std::array<T, n> array_from(const T* values) {
    std::array<T, n> out;
    std::copy_n(values, n, out.begin());
    return out;
}

// (configurations (p, n), index (p), closure errors (p), those that are not real (q, n), index (q),
// statuses (m)) of slices at angles (m).
nb::tuple slice_configurations(const Table& geometry, Index joint, const Doubles& angles) {
    return with_joints(geometry, joint, [&]<std::size_t n>() {
        std::vector<Angles<double, n>> real;
        std::vector<Angles<Complex, n>> nonreal;
        std::vector<std::int64_t> index, nonreal_index, statuses;
        std::vector<double> errors;
        {
            nb::gil_scoped_release release;
            const Slicer<n> slicer(view(geometry));
            Deadline endless(std::numeric_limits<double>::infinity(), python::raise_signals);
            for (std::size_t i = 0; i < angles.shape(0); ++i) {
                endless.has_passed();
                const auto slice = slicer.slice(joint, angles.data()[i]);
                real.insert(real.end(), slice.real.begin(), slice.real.end());
                nonreal.insert(nonreal.end(), slice.nonreal.begin(), slice.nonreal.end());
                index.insert(index.end(), slice.real.size(), i);
                nonreal_index.insert(nonreal_index.end(), slice.nonreal.size(), i);
                statuses.push_back(static_cast<std::int64_t>(slice.status));
            }
            for (const auto& configuration : real) errors.push_back(slicer.closure_error(configuration));
        }
        return nb::make_tuple(array_of(real), array_of(index), array_of(errors), array_of(nonreal),
                              array_of(nonreal_index), array_of(statuses));
    });
}

ComplexTable table_of(const char* name, const ComplexTableIn& table) {
    check_extent(name, table.shape(0), 3);
    check_extent(name, table.shape(1), path_joints);
    return ComplexTable::from(view(table));
}

// (angles (k, 6), rests (k), `PathEnd` numbers (k)) of paths from configurations (k, 6), each where a
// share (k) of the way from the first to the last table is left; none is begun when the time is over.
nb::tuple follow_paths(const ComplexTableIn& starts, const ComplexTableIn& first, const ComplexTableIn& last,
                       const Doubles& shares, double seconds) {
    check_extent("starts", starts.shape(1), path_joints);
    check_extent("shares", shares.shape(0), starts.shape(0));
    const auto count = static_cast<Index>(starts.shape(0));
    const PathTracker tracker(table_of("first", first), table_of("last", last));
    Array<Complex> angles({count, static_cast<Index>(path_joints)});
    Array<double> rests({count});
    Array<std::int64_t> ends({count});
    {
        nb::gil_scoped_release release;
        Deadline deadline(seconds, python::raise_signals);
        std::vector<Path> all;
        for (Index k = 0; k < count; ++k) {
            all.emplace_back(array_from<path_joints>(starts.data() + k * path_joints), shares.data()[k]);
        }
        tracker.follow(all, deadline);
        for (Index k = 0; k < count; ++k) {
            std::copy(all[k].angles().begin(), all[k].angles().end(), angles.data() + k * path_joints);
            rests.data()[k] = all[k].rest();
            ends.data()[k] = static_cast<std::int64_t>(all[k].end());
        }
    }
    return nb::make_tuple(angles.release(), rests.release(), ends.release());
}

// The smallest singular value (k) of F' at configurations (k, 6) of a loop with this table (3, 6).
nb::object smallest_singular_values(const ComplexTableIn& configurations, const ComplexTableIn& table) {
    check_extent("configurations", configurations.shape(1), path_joints);
    const auto loop = complex_loop(table_of("table", table));
    std::vector<double> values;
    for (std::size_t k = 0; k < configurations.shape(0); ++k) {
        const auto angles = array_from<path_joints>(configurations.data() + k * path_joints);
        values.push_back(bifurc::smallest_singular_value(loop.close(half_turns(angles)).derivatives).value);
    }
    return array_of(values);
}

// Closure errors (k, 6) of configurations (k, 6), in quaternions.
nb::object quaternion_closure(const ComplexTableIn& configurations, const ComplexTableIn& table) {
    check_extent("configurations", configurations.shape(1), path_joints);
    const auto loop = complex_loop(table_of("table", table));
    std::vector<std::array<Complex, 6>> errors;
    for (std::size_t k = 0; k < configurations.shape(0); ++k) {
        const auto angles = array_from<path_joints>(configurations.data() + k * path_joints);
        errors.push_back(loop.close(half_turns(angles)).error);
    }
    return array_of(errors);
}

// Folds from shapes (f, 3, n), of each configuration, tangent and weight, and limits (f, 3), of
// each away, along and across.
template <std::size_t n>
std::vector<Fold<n>> folds_of(const bifurc::numpy::CubeIn<double>& shapes, const Table& limits) {
    check_extent("shapes", shapes.shape(2), n);
    check_extent("shapes", shapes.shape(1), 3);
    check_extent("limits", limits.shape(0), shapes.shape(0));
    check_extent("limits", limits.shape(1), 3);
    std::vector<Fold<n>> folds;
    for (std::size_t f = 0; f < shapes.shape(0); ++f) {
        const double* const shape = shapes.data() + 3 * f * n;
        const double* const limit = limits.data() + 3 * f;
        folds.push_back({array_from<n>(shape), array_from<n>(shape + n), array_from<n>(shape + 2 * n),
                         limit[0], limit[1], limit[2]});
    }
    return folds;
}

// (cleared (k), where each one stopped (k, n)) of sheets from ``starts`` (k, n) to ``ends`` (k);
// sheet k may join those of the folds that have the numbers near[first[k]] to near[first[k + 1]].
nb::tuple follow_sheets(const Table& geometry, Index joint, const ComplexTableIn& starts, const Doubles& ends,
                        const bifurc::numpy::CubeIn<double>& shapes, const Table& limits,
                        const Integers& near, const Integers& first, double seconds) {
    return with_joints(geometry, joint, [&]<std::size_t n>() {
        const auto count = static_cast<Index>(starts.shape(0));
        check_extent("starts", starts.shape(1), n);
        check_extent("ends", ends.shape(0), count);
        check_extent("first", first.shape(0), count + 1);
        const std::vector<Fold<n>> folds = folds_of<n>(shapes, limits);
        const SheetTracker<n> tracker(view(geometry), joint);
        Array<bool> cleared({count});
        Array<Complex> last({count, static_cast<Index>(n)});
        {
            nb::gil_scoped_release release;
            Deadline deadline(seconds, python::raise_signals);
            std::vector<Sheet<n>> sheets;
            for (Index k = 0; k < count; ++k) {
                sheets.push_back({array_from<n>(starts.data() + k * n), ends.data()[k], {}});
                for (std::int64_t i = first.data()[k]; i < first.data()[k + 1]; ++i) {
                    sheets.back().folds.push_back(&folds.at(near.data()[i]));
                }
            }
            tracker.follow(sheets, deadline);
            for (Index k = 0; k < count; ++k) {
                cleared.data()[k] = sheets[k].is_cleared;
                std::copy(sheets[k].at.begin(), sheets[k].at.end(), last.data() + k * n);
            }
        }
        return nb::make_tuple(cleared.release(), last.release());
    });
}

// (tangent (n), weight (n), away, along, across) of the fold at a dead point (n), or None.
nb::object find_fold(const Table& geometry, Index joint, const Doubles& configuration) {
    return with_joints(geometry, joint, [&]<std::size_t n>() -> nb::object {
        check_extent("configuration", configuration.shape(0), n);
        const SheetTracker<n> tracker(view(geometry), joint);
        const auto fold = tracker.find_fold(array_from<n>(configuration.data()));
        if (!fold) return nb::none();
        const std::vector tangent(fold->tangent.begin(), fold->tangent.end());
        const std::vector weight(fold->weight.begin(), fold->weight.end());
        return nb::make_tuple(array_of(tangent), array_of(weight), fold->away, fold->along, fold->across);
    });
}

// (whether it was moved, the sheet (n)) one step along its curve towards ``end``.
nb::tuple advance_along(const Table& geometry, Index joint, const Complexes& sheet, double end) {
    return with_joints(geometry, joint, [&]<std::size_t n>() {
        check_extent("sheet", sheet.shape(0), n);
        auto moved = array_from<n>(sheet.data());
        const bool is_moved = SheetTracker<n>(view(geometry), joint).advance_along(moved, end);
        return nb::make_tuple(is_moved, array_of(std::vector(moved.begin(), moved.end())));
    });
}

// (joint screws (n, 6), closure error (6)) at a configuration (n).
nb::tuple screws_and_error(const Table& geometry, const Complexes& configuration) {
    return with_joints(geometry, 0, [&]<std::size_t n>() {
        check_extent("configuration", configuration.shape(0), n);
        const auto at = SheetTracker<n>(view(geometry), 0).linearize(array_from<n>(configuration.data()));
        std::vector<std::array<Complex, 6>> screws;
        for (const auto& screw : at.screws) screws.push_back(entries(screw));
        const auto error = entries(at.error);
        return nb::make_tuple(array_of(screws), array_of(std::vector(error.begin(), error.end())));
    });
}

// (weights (n), radius, bound, second derivatives (n, n, n)) of the ball around a configuration (n)
// for the coordinate ``along`` (n).
nb::tuple ball_around(const Table& geometry, const Complexes& configuration, const Complexes& along) {
    return with_joints(geometry, 0, [&]<std::size_t n>() {
        check_extent("configuration", configuration.shape(0), n);
        check_extent("along", along.shape(0), n);
        const auto row = array_from<n>(along.data());
        const auto screws =
            SheetTracker<n>(view(geometry), 0).linearize(array_from<n>(configuration.data())).screws;
        const auto inverse = BorderedScrews<Complex, n>(screws, row).inverse();
        const SecondDerivatives<Complex, n> second(screws, inverse);
        const Ball<n> ball = find_ball(ball_terms(screws, inverse, second));
        constexpr auto size = static_cast<Index>(n);
        Array<Complex> derivatives({size, size, size});
        std::size_t number = 0;
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = i + 1; j < n; ++j, ++number) {
                for (std::size_t a = 0; a < n; ++a) {
                    const Complex value = second.of_pair[number][a];
                    derivatives.data()[(a * n + i) * n + j] = derivatives.data()[(a * n + j) * n + i] = value;
                }
            }
        }
        const std::vector weight(ball.weight.begin(), ball.weight.end());
        return nb::make_tuple(array_of(weight), ball.radius, ball.bound, derivatives.release());
    });
}

}  // namespace

void define_slices(nb::module_& module) {
    module.def("slice_configurations", &slice_configurations, nb::arg("geometry"), nb::arg("joint"),
               nb::arg("angles"));
    module.def("follow_paths", &follow_paths, nb::arg("starts"), nb::arg("first"), nb::arg("last"),
               nb::arg("shares"), nb::arg("seconds"));
    module.def("smallest_singular_values", &smallest_singular_values, nb::arg("configurations"),
               nb::arg("table"));
    module.def("quaternion_closure", &quaternion_closure, nb::arg("configurations"), nb::arg("table"));
    module.def("follow_sheets", &follow_sheets, nb::arg("geometry"), nb::arg("joint"), nb::arg("starts"),
               nb::arg("ends"), nb::arg("shapes"), nb::arg("limits"), nb::arg("near"), nb::arg("first"),
               nb::arg("seconds"));
    module.def("find_fold", &find_fold, nb::arg("geometry"), nb::arg("joint"), nb::arg("configuration"));
    module.def("advance_along", &advance_along, nb::arg("geometry"), nb::arg("joint"), nb::arg("sheet"),
               nb::arg("end"));
    module.def("screws_and_error", &screws_and_error, nb::arg("geometry"), nb::arg("configuration"));
    module.def("ball_around", &ball_around, nb::arg("geometry"), nb::arg("configuration"), nb::arg("along"));
}

}  // namespace linkages
