// What clients learn of the file that a served cloud was read from, so that a copy can be saved like it.
#pragma once

#include <optional>
#include <string>

#include "engine/cloud/length_unit.hpp"
#include "engine/cloud/point_cloud.hpp"
#include "haptics/sharing/messages.hpp"

namespace palpate::sharing {

struct ServedFile {
  LengthUnit unit = LengthUnit::unknown;
  std::optional<CoordinateGrid> grid = {};
  bool estimatedNormals = false;  ///< the normals are not of the file
  std::string unsent = {};        ///< what clients do not get of the file, in words; empty: nothing
  bool operator==(const ServedFile&) const = default;
};

ServedFile servedFileOf(const PointCloud& cloud);
void put(Facts& facts, const ServedFile& file);
/// Empty if the message is invalid.
std::optional<ServedFile> servedFileIn(const Facts& facts);
/// Describes a received cloud by it.
void describe(PointCloud& cloud, const ServedFile& file);

}  // namespace palpate::sharing
