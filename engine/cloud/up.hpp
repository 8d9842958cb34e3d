// Which way is up in a model.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// A direction along an axis of the file's coordinates.
enum class UpAxis : std::uint8_t { x, y, z, minusX, minusY, minusZ };

/// As on the command line.
inline constexpr std::array<std::pair<std::string_view, UpAxis>, 6> kUpAxes{{{"x", UpAxis::x},
                                                                             {"y", UpAxis::y},
                                                                             {"z", UpAxis::z},
                                                                             {"-x", UpAxis::minusX},
                                                                             {"-y", UpAxis::minusY},
                                                                             {"-z", UpAxis::minusZ}}};
std::string_view nameOf(UpAxis up);

/// Unit.
DVec3 directionOf(UpAxis up);
/// Unit: from the model towards whoever looks at it from the front. That is +z where y is up, and turns with up.
DVec3 frontOf(UpAxis up);

struct Upright {
  UpAxis up = UpAxis::y;
  std::string why;  ///< a few words that follow "up is y:"
};

/// What a file's comments say, as in `comment up: -y`; nothing where none says it.
std::optional<UpAxis> upSaidIn(std::span<const std::string> comments);

/// The axis that cameras take for up, from the mean of their unit ups; nothing where they disagree too much, or hang
/// between two axes.
std::optional<UpAxis> upOfCameras(const DVec3& meanUp);

/// What the file says; else looks at the shape: ground lies flat and is seen from above; a room stands on its floor,
/// seen from one side or from within; a camera at the origin that looks along z has y down; a scan from the air has one
/// height over each place; a body that was cut off is open below; and what stands does so on a wide base under its
/// middle. A shape that says nothing, or the same in two directions, has y up. The same answer for
/// the same cloud.
Upright findUp(const PointCloud& cloud);

}  // namespace palpate
