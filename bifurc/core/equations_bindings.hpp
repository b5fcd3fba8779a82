// Equations on the way through Python, from the module that has them to the one that has methods over them.
#pragma once

#include <memory>
#include <utility>

#include "bifurc/core/bindings.hpp"
#include "bifurc/core/equations.hpp"

namespace bifurc::python {

inline constexpr const char* equations_name = "bifurc.Equations";

inline nb::capsule hand_over(std::unique_ptr<Equations> equations) {
    return {equations.release(), equations_name,
            [](void* memory) noexcept { delete static_cast<Equations*>(memory); }};
}

inline const Equations& equations_in(const nb::capsule& capsule) {
    return *static_cast<const Equations*>(capsule.data(equations_name));
}

}  // namespace bifurc::python
