// The part of bifurc._core that is about surfaces.
#include "bifurc/core/sheet_module.hpp"

#include <limits>
#include <memory>
#include <utility>

#include "bifurc/core/deadline.hpp"
#include "bifurc/core/equations_bindings.hpp"
#include "bifurc/core/cover.hpp"
#include "bifurc/core/gram.hpp"
#include "bifurc/core/rank_deflation.hpp"
#include "bifurc/core/sheet.hpp"
#include "bifurc/core/tape.hpp"

namespace bifurc::python {

namespace {

// Equations that functions of Python make: from points (k, n) to F (k, m), to F' (k, m, n) and to F'' (k, m, n,
// n), all over the magnitude.
class CalledEquations : public Equations {
public:
    CalledEquations(Index unknowns, nb::object residuals, nb::object jacobians, nb::object hessians)
        : unknowns_(unknowns),
          residuals_(std::move(residuals)),
          jacobians_(std::move(jacobians)),
          hessians_(std::move(hessians)) {}

    Index unknowns() const override { return unknowns_; }
    Index at_once() const override { return many; }

    void fill(View<const double> points, bool has_jacobians, Values& values) const override {
        if (points.rows == 0) return;
        const nb::object at = array_of(points);
        const auto residuals = nb::cast<Table>(residuals_(at));
        values.reserve(points.rows, static_cast<Index>(residuals.shape(1)), has_jacobians);
        check_unknowns("residuals", residuals.shape(0), points.rows);
        std::copy_n(residuals.data(), residuals.size(), values.residual(0).data());
        if (!has_jacobians) return;
        const auto jacobians = nb::cast<numpy::CubeIn<double>>(jacobians_(at));
        check_unknowns("jacobians", jacobians.size(), residuals.size() * unknowns_);
        std::copy_n(jacobians.data(), jacobians.size(), values.jacobian(0).data);
    }

    void bend(Vector<const double> point, View<const double> directions, View<double> out) const override {
        const auto hessians = nb::cast<nb::ndarray<const double, nb::ndim<4>, nb::c_contig, nb::device::cpu>>(
            hessians_(array_of({point.data(), 1, unknowns_})));
        const auto rows = static_cast<Index>(hessians.shape(1)) * unknowns_;
        check_unknowns("hessians", hessians.size(), rows * unknowns_);
        bend_by({hessians.data(), rows, unknowns_}, directions, out);
    }

private:
    static nb::object array_of(View<const double> points) {
        numpy::Array<double> copy({points.rows, points.columns});
        copy.fill({points.data, static_cast<std::size_t>(points.rows * points.columns)});
        return copy.release();
    }

    static constexpr Index many = 2048;  // whose derivatives fit into memory with those of their functions

    Index unknowns_;
    nb::object residuals_, jacobians_, hessians_;
};

nb::capsule called_equations(Index unknowns, nb::object residuals, nb::object jacobians, nb::object hessians) {
    return hand_over(std::make_unique<CalledEquations>(unknowns, std::move(residuals), std::move(jacobians),
                                                       std::move(hessians)));
}

// `RankDeflatedEquations` with the equations that they refer to.
class OwnedRankDeflation : public RankDeflatedEquations {
public:
    OwnedRankDeflation(const nb::capsule& equations, Index rank)
        : RankDeflatedEquations(equations_in(equations), rank), equations_(equations) {}

private:
    nb::capsule equations_;
};

nb::capsule rank_deflated(const nb::capsule& equations, Index rank) {
    if (rank < 0 || rank > equations_in(equations).unknowns()) throw nb::value_error("no such rank");
    return hand_over(std::make_unique<OwnedRankDeflation>(equations, rank));
}

// F (k, m) at points (k, n).
nb::object residuals_at(const nb::capsule& equations, const Table& points) {
    const Equations& own = equations_in(equations);
    check_unknowns("points", points.shape(1), own.unknowns());
    Values values(own.unknowns());
    own.fill(numpy::view(points), false, values);
    const auto count = static_cast<Index>(points.shape(0));
    numpy::Array<double> out({count, values.equations()});
    if (count) out.fill({values.residual(0).data(), static_cast<std::size_t>(count * values.equations())});
    return out.release();
}

// F' (k, m, n) at points (k, n).
nb::object jacobians_at(const nb::capsule& equations, const Table& points) {
    const Equations& own = equations_in(equations);
    check_unknowns("points", points.shape(1), own.unknowns());
    const auto count = static_cast<Index>(points.shape(0)), n = own.unknowns(), at_once = own.at_once();
    Values values(n);
    own.fill(numpy::view(points).first_rows(0), true, values);
    std::vector<double> all;
    for (Index begin = 0; begin < count; begin += at_once) {
        const Index some = std::min(at_once, count - begin);
        own.fill({numpy::view(points).row(begin).data(), some, n}, true, values);
        const double* const first = values.jacobian(0).data;
        all.insert(all.end(), first, first + some * values.equations() * n);
    }
    numpy::Array<double> out({count, values.equations(), n});
    out.fill(all);
    return out.release();
}

// A tape, with what its system refers to.
struct OwnedTape {
    nb::object tape;
    std::vector<double> units, weights;
};

nb::capsule tape_equations(const nb::object& tape, double magnitude) {
    const Tape& own = nb::cast<const Tape&>(tape);
    OwnedTape owner{tape, std::vector<double>(own.unknowns(), 1.0), std::vector<double>(own.equations(), 1.0)};
    const auto make = [&](const OwnedTape& of) { return TapeSystem(own, of.units, of.weights); };
    return hand_over(std::make_unique<EquationsOf<TapeSystem, OwnedTape>>(std::move(owner), make, magnitude));
}

// --- methods over them ---------------------------------------------------------------------------------------

// Arrays of as many points, planes or positions as there are rows.
void check_rows(const char* name, std::size_t given, std::size_t needed) {
    if (given != needed) throw nb::value_error((std::string(name) + ": there must be one for each point").c_str());
}

void check_spaces(const numpy::CubeIn<double>& planes, std::size_t count, Index unknowns) {
    check_rows("planes", planes.shape(0), count);
    check_unknowns("planes", planes.shape(1), unknowns);
}

void check_planes(const numpy::CubeIn<double>& planes, std::size_t count, Index unknowns) {
    check_spaces(planes, count, unknowns);
    if (planes.shape(2) < 1 || static_cast<Index>(planes.shape(2)) > Gram::most) {
        throw nb::value_error("planes must have one to eight columns each");
    }
}

// Calls ``work(begin, some)`` for some of ``count`` points after the others; Ctrl-C gets through in between.
template <class Work>
void in_parts(Index count, const Equations& equations, Work work) {
    constexpr Index few = 256;
    const Index most = std::max(equations.at_once(), few);
    Deadline deadline(std::numeric_limits<double>::infinity(), raise_signals);
    for (Index begin = 0; begin < count; begin += most) {
        work(begin, std::min(most, count - begin));
        deadline.has_passed();
    }
}

// (points (k, n), gaps (k), is settled (k)): `Correction`.
nb::tuple normal_corrections(const nb::capsule& equations, double scale, const Table& points,
                                    const numpy::CubeIn<double>& planes) {
    const Equations& own = equations_in(equations);
    const Index n = own.unknowns(), count = static_cast<Index>(points.shape(0));
    check_unknowns("points", points.shape(1), n);
    check_spaces(planes, points.shape(0), n);
    numpy::Array<double> at({count, n}), gaps({count});
    numpy::Array<bool> is_settled({count});
    at.fill({points.data(), points.size()});
    std::vector<Correction> corrections;
    const View<const double> bases = numpy::rows(planes);
    NormalCorrector corrector(own, scale);
    in_parts(count, own, [&](Index begin, Index some) {
        corrector.correct({at.data() + begin * n, some, n}, [&](Index i) { return plane_of(bases, begin + i, n); },
                          corrections);
        for (Index i = 0; i < some; ++i) {
            gaps.data()[begin + i] = corrections[i].gap;
            is_settled.data()[begin + i] = corrections[i].is_settled(scale);
        }
    });
    return nb::make_tuple(at.release(), gaps.release(), is_settled.release());
}

// (k, n, d): `Slopes`.
nb::object slopes_above(const nb::capsule& equations, const Table& points, const numpy::CubeIn<double>& planes) {
    const Equations& own = equations_in(equations);
    const Index n = own.unknowns();
    check_unknowns("points", points.shape(1), n);
    check_planes(planes, points.shape(0), n);
    const auto d = static_cast<Index>(planes.shape(2));
    numpy::Array<double> out({static_cast<Index>(points.shape(0)), n, d});
    const View<const double> bases = numpy::rows(planes);
    Slopes slopes(own);
    in_parts(static_cast<Index>(points.shape(0)), own, [&](Index begin, Index some) {
        slopes.at({points.data() + begin * n, some, n}, [&](Index i) { return plane_of(bases, begin + i, n); },
                  sheet::any_rank, [&](Index i, View<const double> derivatives) {
                      std::copy_n(derivatives.data, d * n, out.entry(begin + i).data);
                  });
    });
    return out.release();
}

// (ends (k, n), reached (k), passed (k, s, n), are there (k, s)): `RayEnds`.
nb::tuple follow_rays(const nb::capsule& equations, double scale, const Table& centers,
                             const numpy::CubeIn<double>& planes, const Table& positions, const Doubles& shares) {
    const Equations& own = equations_in(equations);
    const Index n = own.unknowns();
    const auto count = static_cast<Index>(centers.shape(0)), s = static_cast<Index>(shares.shape(0));
    check_unknowns("centers", centers.shape(1), n);
    check_planes(planes, centers.shape(0), n);
    check_rows("positions", positions.shape(0), centers.shape(0));
    check_unknowns("positions", positions.shape(1), static_cast<Index>(planes.shape(2)));
    numpy::Array<double> ends({count, n}), reached({count}), passed({count, s, n});
    numpy::Array<bool> are_there({count, s});
    Deadline deadline(std::numeric_limits<double>::infinity(), raise_signals);
    const RayBundle bundle{numpy::view(centers), numpy::rows(planes), numpy::view(positions), numpy::view(shares)};
    RayFollower(own, scale).follow(bundle, {ends.matrix(), reached.vector(), passed.matrix(), are_there.vector()},
                                   [&] { deadline.has_passed(); });
    return nb::make_tuple(ends.release(), reached.release(), passed.release(), are_there.release());
}

// --- the front of a covering ---------------------------------------------------------------------------------

using Labels = numpy::VectorIn<std::int64_t>;

// (vertices (v, 2), labels (v))
nb::tuple arrays_of(const ConvexPolygon& polygon) {
    const auto count = static_cast<Index>(polygon.labels.size());
    numpy::Array<double> vertices({count, 2});
    numpy::Array<std::int64_t> labels({count});
    for (Index i = 0; i < count; ++i) {
        vertices.matrix()(i, 0) = polygon.vertices[i][0];
        vertices.matrix()(i, 1) = polygon.vertices[i][1];
        labels.data()[i] = polygon.labels[i];
    }
    return nb::make_tuple(vertices.release(), labels.release());
}

// A cover with the equations that it refers to.
template <Index d>
class OwnedCover : public Cover<d> {
public:
    OwnedCover(const nb::capsule& equations, double scale, const Doubles& periods, const Table& bounds,
               double agree, double smooth, const DiskLimits& disks)
        : Cover<d>(equations_in(equations), scale, numpy::view(periods), numpy::view(bounds), agree, smooth, disks),
          unknowns(equations_in(equations).unknowns()),
          equations_(equations) {}

    const Index unknowns;

private:
    nb::capsule equations_;
};

template <Index d>
void check_plane(const OwnedCover<d>& cover, const Doubles& center, const Table& basis) {
    check_unknowns("center", center.shape(0), cover.unknowns);
    check_unknowns("basis", basis.shape(0), cover.unknowns);
    check_unknowns("basis", basis.shape(1), d);
}

template <Index d>
void check_chart(const OwnedCover<d>& cover, Index chart) {
    if (chart < 0 || chart >= cover.front().count()) throw nb::index_error("no such chart");
}

template <Index d>
std::array<double, d> position_in(const double* entries) {
    std::array<double, d> out;
    std::copy_n(entries, d, out.begin());
    return out;
}

// (placement, center (n), basis (n, d), normal (n), largest, radius, is clear, height): `Candidate`.
nb::tuple tuple_of(const Candidate& candidate) {
    const auto n = static_cast<Index>(candidate.center.size());
    const Index d = candidate.plane.basis.columns();
    numpy::Array<double> center({n}), basis({n, d}), normal({n});
    center.fill(candidate.center);
    basis.fill({candidate.plane.basis.view().data, static_cast<std::size_t>(d * n)});
    normal.fill(candidate.plane.normal);
    const FittingDisk& disk = candidate.disk;
    return nb::make_tuple(candidate.placement, center.release(), basis.release(), normal.release(), candidate.largest,
                          disk.radius, disk.is_clear, disk.height);
}

// (growth, None or (candidate, chart, direction (d))): `Cover::Stop`.
template <Index d>
nb::tuple grow(OwnedCover<d>& cover, Index charts, Index undecided, double seconds) {
    Deadline deadline(seconds, raise_signals);
    const typename Cover<d>::Stop stop = cover.grow(charts, undecided, deadline);
    if (!stop.candidate) return nb::make_tuple(stop.growth, nb::none());
    numpy::Array<double> direction({d});
    direction.fill(stop.lead.direction);
    return nb::make_tuple(stop.growth, nb::make_tuple(tuple_of(*stop.candidate), stop.lead.chart, direction.release()));
}

// (radius, is clear, height) between two radii, or None.
template <Index d>
nb::object disk_of(OwnedCover<d>& cover, const Doubles& center, const Table& basis, const Doubles& normal, double largest,
                   double smallest) {
    check_plane(cover, center, basis);
    check_unknowns("normal", normal.shape(0), cover.unknowns);
    const auto disk = cover.disk(numpy::view(center), numpy::view(basis), numpy::view(normal), largest, smallest);
    if (!disk) return nb::none();
    return nb::make_tuple(disk->radius, disk->is_clear, disk->height);
}

template <Index d>
nb::tuple candidate(OwnedCover<d>& cover, const Doubles& center, const Table& near, double radius) {
    check_plane(cover, center, near);
    return tuple_of(cover.candidate(numpy::view(center), numpy::view(near), radius));
}

// The cell of the chart is the part of the one about its ball where normals (c, d) . y <= offsets (c).
template <Index d>
void add_chart(OwnedCover<d>& cover, const Doubles& center, const Table& basis, double radius, bool is_clear,
               double height, const Table& normals, const Doubles& offsets, const Labels& labels) {
    check_plane(cover, center, basis);
    check_unknowns("normals", normals.shape(1), d);
    check_rows("offsets", offsets.shape(0), normals.shape(0));
    check_rows("labels", labels.shape(0), normals.shape(0));
    auto cell = Cover<d>::Cell::around(radius);
    for (std::size_t i = 0; i < labels.shape(0); ++i) {
        cell.clip(position_in<d>(normals.data() + d * i), offsets.data()[i], labels.data()[i]);
    }
    cover.add(numpy::view(center), numpy::view(basis), {radius, height, is_clear}, std::move(cell));
}

template <Index d>
void refuse(OwnedCover<d>& cover, Index chart, const Doubles& direction, bool is_unfit) {
    check_chart(cover, chart);
    check_unknowns("direction", direction.shape(0), d);
    cover.refuse({chart, position_in<d>(direction.data())}, is_unfit);
}

// (k, n): `Cover::holes`.
template <Index d>
nb::object holes(const OwnedCover<d>& cover) {
    const std::vector<double> points = cover.holes();
    numpy::Array<double> out({static_cast<Index>(points.size()) / cover.unknowns, cover.unknowns});
    out.fill(points);
    return out.release();
}

// (centers (c, n), bases (c, n, d), radii (c), are clear (c)) of ``count`` charts from number ``first`` on.
template <Index d>
nb::tuple charts(const OwnedCover<d>& cover, Index first, Index count) {
    const Front<d>& front = cover.front();
    if (first < 0 || count < 0 || first + count > front.count()) throw nb::index_error("no such chart");
    const Index n = front.unknowns();
    numpy::Array<double> centers({count, n}), bases({count, n, d}), radii({count});
    numpy::Array<bool> are_clear({count});
    for (Index i = 0; i < count; ++i) {
        const Vector<const double> center = front.center(first + i);
        std::copy(center.begin(), center.end(), centers.matrix().row(i).begin());
        std::copy_n(front.basis(first + i).data, d * n, bases.entry(i).data);
        radii.data()[i] = front.radius(first + i);
        are_clear.data()[i] = front.is_clear(first + i);
    }
    return nb::make_tuple(centers.release(), bases.release(), radii.release(), are_clear.release());
}

// (vertices (v, 2), labels (v)) of the polygon of a chart; the labels (f) of the facets of a polytope.
template <Index d>
nb::object cell_at(const OwnedCover<d>& cover, Index chart) {
    check_chart(cover, chart);
    const auto& cell = cover.front().polygon(chart);
    if constexpr (d == 2) {
        return arrays_of(cell);
    } else {
        const std::vector<Index> own = cell.labels_of_facets();
        numpy::Array<std::int64_t> labels({static_cast<Index>(own.size())});
        std::copy(own.begin(), own.end(), labels.data());
        return labels.release();
    }
}

template <Index d>
void bind_cover(nb::module_& module, const char* name) {
    using nb::arg;
    using Own = OwnedCover<d>;
    nb::class_<Own>(module, name, "The charts of a component that is being covered.")
        .def(
            "__init__",
            [](Own* place, const nb::capsule& equations, double scale, const Doubles& periods, const Table& bounds,
               double agree, double smooth, double largest, double smallest, double bend, double flat,
               double negligible) {
                const DiskLimits disks{largest, smallest, bend, flat, negligible};
                new (place) Own(equations, scale, periods, bounds, agree, smooth, disks);
            },
            arg("equations"), arg("scale"), arg("periods"), arg("bounds"), arg("agree"), arg("smooth"),
            arg("largest"), arg("smallest"), arg("bend"), arg("flat"), arg("negligible"))
        .def("__len__", [](const Own& cover) { return cover.front().count(); })
        .def_prop_ro("undecided", &Own::undecided)
        .def("grow", &grow<d>, arg("charts"), arg("undecided"), arg("seconds"))
        .def("candidate", &candidate<d>, arg("center"), arg("near"), arg("radius"))
        .def("disk", &disk_of<d>, arg("center"), arg("basis"), arg("normal"), arg("largest"), arg("smallest"))
        .def("add", &add_chart<d>, arg("center"), arg("basis"), arg("radius"), arg("is_clear"), arg("height"),
             arg("normals"), arg("offsets"), arg("labels"))
        .def("refuse", &refuse<d>, arg("chart"), arg("direction"), arg("is_unfit"))
        .def("holes", &holes<d>)
        .def("charts", &charts<d>, arg("first"), arg("count"))
        .def(d == 2 ? "polygon" : "facets", &cell_at<d>, arg("chart"));
}

}  // namespace

void bind_sheets(nb::module_& module) {
    using nb::arg;
    module.def("called_equations", &called_equations, arg("unknowns"), arg("residuals"), arg("jacobians"),
               arg("hessians"));
    module.def("rank_deflated", &rank_deflated, arg("equations"), arg("rank"));
    module.def("residuals_at", &residuals_at, arg("equations"), arg("points"));
    module.def("jacobians_at", &jacobians_at, arg("equations"), arg("points"));
    module.def("tape_equations", &tape_equations, arg("tape"), arg("magnitude"));
    module.def("normal_corrections", &normal_corrections, arg("equations"), arg("scale"), arg("points"), arg("planes"));
    module.def("slopes_above", &slopes_above, arg("equations"), arg("points"), arg("planes"));
    module.def("rim_of", [](Index dimension) {
        const Matrix<double> rim = rim_of(dimension);
        numpy::Array<double> out({rim.rows(), dimension});
        out.fill({rim.view().data, static_cast<std::size_t>(rim.rows() * dimension)});
        return out.release();
    }, arg("dimension"));
    module.def("follow_rays", &follow_rays, arg("equations"), arg("scale"), arg("centers"), arg("planes"),
               arg("positions"), arg("shares"));
    nb::enum_<Placement>(module, "Placement")
        .value("FITS", Placement::fits)
        .value("COVERED", Placement::covered)
        .value("UNFIT", Placement::unfit)
        .value("BESIDE_BOUNDS", Placement::beside_bounds)
        .value("TIGHT", Placement::tight);
    nb::enum_<Growth>(module, "Growth")
        .value("COMPLETE", Growth::complete)
        .value("OUT_OF_TIME", Growth::out_of_time)
        .value("UNDECIDED", Growth::undecided)
        .value("CHART_LIMIT", Growth::chart_limit)
        .value("DOUBT", Growth::doubt);
    bind_cover<2>(module, "Cover");
    bind_cover<3>(module, "Cover3");
    bind_cover<4>(module, "Cover4");
    bind_cover<5>(module, "Cover5");
}

}  // namespace bifurc::python
