// The Python module bifurc._core.
#include "bifurc/core/curve.hpp"
#include "bifurc/core/numpy.hpp"

namespace nb = nanobind;
using namespace bifurc;
using numpy::Array;
using numpy::CubeIn;
using numpy::MatrixIn;
using numpy::VectorIn;

namespace {

Curve curve_of(const VectorIn<double>& breaks, const VectorIn<double>& centers, const VectorIn<double>& radii,
               const CubeIn<double>& pieces, const VectorIn<double>& travel) {
    return {numpy::view(breaks), numpy::view(centers), numpy::view(radii), numpy::rows(pieces),
            numpy::view(travel)};
}

nb::object evaluate_curve(const VectorIn<double>& breaks, const VectorIn<double>& centers,
                          const VectorIn<double>& radii, const CubeIn<double>& pieces,
                          const VectorIn<double>& travel, const VectorIn<double>& s, int derivative) {
    const Curve curve = curve_of(breaks, centers, radii, pieces, travel);
    Array<double> out({static_cast<Index>(s.shape(0)), curve.unknowns()});
    evaluate(curve, numpy::view(s), derivative, out.matrix());
    return out.release();
}

nb::tuple feet_on_curve(const VectorIn<double>& breaks, const VectorIn<double>& centers,
                        const VectorIn<double>& radii, const CubeIn<double>& pieces,
                        const VectorIn<double>& travel, const MatrixIn<double>& points,
                        const VectorIn<double>& s, double reach, const VectorIn<double>& periods,
                        int iterations) {
    const Curve curve = curve_of(breaks, centers, radii, pieces, travel);
    const auto count = static_cast<Index>(points.shape(0));
    Array<double> at({count}), distances({count});
    at.fill(numpy::view(s));
    feet(curve, numpy::view(points), at.vector(), distances.vector(), reach, numpy::view(periods), iterations);
    return nb::make_tuple(at.release(), distances.release());
}

}  // namespace

NB_MODULE(_core, module) {
    module.doc() = "Compiled parts of bifurc.";
    module.def("evaluate", &evaluate_curve, nb::arg("breaks"), nb::arg("centers"), nb::arg("radii"),
               nb::arg("pieces"), nb::arg("travel"), nb::arg("s"), nb::arg("derivative"));
    module.def("feet", &feet_on_curve, nb::arg("breaks"), nb::arg("centers"), nb::arg("radii"), nb::arg("pieces"),
               nb::arg("travel"), nb::arg("points"), nb::arg("s"), nb::arg("reach"), nb::arg("periods"),
               nb::arg("iterations"));
}
