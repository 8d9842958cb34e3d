// The up direction of a model.
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

/// Names on the command line.
inline constexpr std::array<std::pair<std::string_view, UpAxis>, 6> kUpAxes{{{"x", UpAxis::x},
                                                                             {"y", UpAxis::y},
                                                                             {"z", UpAxis::z},
                                                                             {"-x", UpAxis::minusX},
                                                                             {"-y", UpAxis::minusY},
                                                                             {"-z", UpAxis::minusZ}}};
std::string_view nameOf(UpAxis up);

/// Unit.
DVec3 directionOf(UpAxis up);
/// Unit: from the model towards a viewer in front of it: +z if y is up, and rotated with up.
DVec3 frontOf(UpAxis up);

struct Upright {
  UpAxis up = UpAxis::y;
  std::string why;  ///< a few words that follow "up is y:"
};

/// The up axis in a file's comments, as in `comment up: -y`; empty if they do not contain one.
std::optional<UpAxis> upSaidIn(std::span<const std::string> comments);

/// The up axis of cameras, from the mean of their unit up vectors; empty if they disagree too much, or lie between two
/// axes.
std::optional<UpAxis> upOfCameras(const DVec3& meanUp);

/// The axis in the file's comments; otherwise found from the shape: ground lies flat and is seen from above; a room
/// stands on its floor, seen from one side or from inside; a camera at the origin that looks along z has y down; a scan
/// from the air has one height over each position; a body that was cut off is open below; and standing objects have a
/// wide base under their centre. An ambiguous shape has y up. Deterministic.
Upright findUp(const PointCloud& cloud);

}  // namespace palpate
