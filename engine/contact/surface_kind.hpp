#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "shaders/shared/contact.h"

namespace palpate {

/// The surface that the points around a position define.
enum class SurfaceKind : std::uint32_t {
  average = shared::kSurfaceAverage,  ///< weighted mean position and normal: simple, sinks into curvature
  sphere = shared::kSurfaceSphere,    ///< the algebraic sphere fitted to positions and normals: no such bias
  sharp = shared::kSurfaceSharp,      ///< the points' planes, reweighted by normal and height: keeps edges
};

/// The kinds by the names on the command line.
inline constexpr std::array<std::pair<std::string_view, SurfaceKind>, 3> kSurfaceKinds{{
    {"average", SurfaceKind::average},
    {"sphere", SurfaceKind::sphere},
    {"sharp", SurfaceKind::sharp},
}};

}  // namespace palpate
