// The part of bifurc._core that is about surfaces.
#pragma once

#include <nanobind/nanobind.h>

namespace bifurc::python {

void bind_sheets(nanobind::module_& module);

}  // namespace bifurc::python
