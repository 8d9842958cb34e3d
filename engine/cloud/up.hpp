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
/// The axis nearest to a direction.
UpAxis axisOf(const DVec3& direction);
/// Unit: from the model towards a viewer in front of it, if nothing is known of its shape: +z if y is up, and rotated
/// with up.
DVec3 frontOf(UpAxis up);
/// The up axis after a rotation of the picture by 90 degrees, clockwise.
UpAxis turnedUp(UpAxis up, const DVec3& front);

/// Of an orientation: stated by the file or the user, measured, or assumed.
enum class Sureness : std::uint8_t { known, likely, guessed };
std::string_view nameOf(Sureness sureness);

struct Upright {
  UpAxis up = UpAxis::y;
  std::string why;  ///< a few words that follow "up is y:"
  Sureness sureness = Sureness::likely;
  DVec3 front{0, 0, 1};  ///< unit: towards a viewer who sees its face, or its wider side
  Sureness frontSureness = Sureness::guessed;
  bool isInterior = false;  ///< of a room or a street that was scanned from inside: its walls face in

  /// `front` for the up axis that was found, frontOf() for another.
  DVec3 frontFor(UpAxis shown) const { return shown == up ? front : frontOf(shown); }
};

/// The up axis in a file's comments, as in `comment up: -y`; empty if they do not contain one.
std::optional<UpAxis> upSaidIn(std::span<const std::string> comments);

/// Writes the axis into the comments, replacing any other.
void setUp(std::vector<std::string>& comments, UpAxis up);

/// For a part of a model: adds the touch scale and the up axis of the whole to the comments, unless these state a scale
/// or an axis. Returns whether something was added.
bool keepPose(std::vector<std::string>& comments, double mm_per_unit, UpAxis up);

/// The up axis of cameras, from the mean of their unit up vectors; empty if they disagree too much, or lie between two
/// axes.
std::optional<UpAxis> upOfCameras(const DVec3& meanUp);

/// The axis in the file's comments; otherwise found from the shape: ground lies flat and is seen from above; a room
/// stands on its floor, seen from one side or from inside; a camera at the origin that looks along z has y down; a scan
/// from the air has one height over each position; a body that was cut off is open below; and standing objects have a
/// wide base under their centre. A shape without one is smoother above than below, as a skull is; else y is up.
/// A standing object has its front where it is seen from outside and open behind; else its wider side is the front, of
/// two the one with more detail. Deterministic.
Upright findUp(const PointCloud& cloud);

}  // namespace palpate
