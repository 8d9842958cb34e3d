#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "shaders/shared/contact.h"

namespace palpate {

/// What the points around a place define.
enum class SurfaceKind : std::uint32_t {
  average = shared::kSurfaceAverage,  ///< weighted mean position and normal: simple, sinks into curvature
  sphere = shared::kSurfaceSphere,    ///< the algebraic sphere that fits places and normals: no such bias
  sharp = shared::kSurfaceSharp,      ///< the points' planes, reweighted by normal and height: keeps edges
};

/// The kinds by the names that users know.
inline constexpr std::array<std::pair<std::string_view, SurfaceKind>, 3> kSurfaceKinds{{
    {"average", SurfaceKind::average},
    {"sphere", SurfaceKind::sphere},
    {"sharp", SurfaceKind::sharp},
}};

}  // namespace palpate
