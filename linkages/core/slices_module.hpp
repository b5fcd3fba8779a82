// What the module linkages._core has for `linkages.slices`.
#pragma once

#include <nanobind/nanobind.h>

namespace linkages {

void define_slices(nanobind::module_& module);

}  // namespace linkages
