#include "haptics/sharing/served_file.hpp"

#include <fmt/format.h>

#include <vector>

#include "engine/cloud/estimated_normals.hpp"

namespace palpate::sharing {

namespace {

/// In words that fit into Facts.
std::string unsentOf(const PointCloud& cloud) {
  std::vector<std::string> parts;
  if (!cloud.exactPositions.empty()) parts.emplace_back("coordinates in double precision");
  for (const Attribute& attribute : cloud.extra) parts.push_back(printable(attribute.name.c_str()));
  if (cloud.storedAs.baggage && !cloud.storedAs.baggage->sentence.empty())
    parts.push_back(cloud.storedAs.baggage->sentence);
  constexpr std::size_t kRoomForCount = 20;
  std::string words;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::string next = (i == 0 ? "" : ", ") + parts[i];
    if (words.size() + next.size() + kRoomForCount > sizeof(Facts::unsent))
      return fmt::format("{}{}{} more", words, i == 0 ? "" : " and ", parts.size() - i);
    words += next;
  }
  return words;
}

}  // namespace

ServedFile servedFileOf(const PointCloud& cloud) {
  return {.unit = unitSaidIn(cloud.storedAs.comments),
          .grid = cloud.storedAs.grid,
          .estimatedNormals = areNormalsEstimated(cloud),
          .unsent = unsentOf(cloud)};
}

void put(Facts& facts, const ServedFile& file) {
  facts.unit = static_cast<std::uint8_t>(file.unit);
  facts.gridded = file.grid.has_value();
  const CoordinateGrid grid = file.grid.value_or(CoordinateGrid{});
  for (int axis = 0; axis < 3; ++axis) {
    facts.step[axis] = grid.step[axis];
    facts.offset[axis] = grid.offset[axis];
  }
  facts.estimated_normals = file.estimatedNormals;
  put(facts.unsent, file.unsent);
}

std::optional<ServedFile> servedFileIn(const Facts& facts) {
  constexpr double kMin = 1e-30, kMax = 1e30;
  ServedFile file{.unit = static_cast<LengthUnit>(facts.unit),
                  .estimatedNormals = facts.estimated_normals,
                  .unsent = printable(facts.unsent)};
  if (file.unit > LengthUnit::foot) return std::nullopt;
  if (!facts.gridded) return file;
  const CoordinateGrid grid{.step = DVec3(facts.step[0], facts.step[1], facts.step[2]),
                            .offset = DVec3(facts.offset[0], facts.offset[1], facts.offset[2])};
  for (int axis = 0; axis < 3; ++axis) {
    const double step = std::abs(grid.step[axis]);
    if (!(step >= kMin && step <= kMax && std::abs(grid.offset[axis]) <= kMax)) return std::nullopt;
  }
  file.grid = grid;
  return file;
}

void describe(PointCloud& cloud, const ServedFile& file) {
  sayUnit(cloud.storedAs.comments, file.unit);
  cloud.storedAs.grid = file.grid;
  markNormalsAsEstimated(cloud, file.estimatedNormals);
}

}  // namespace palpate::sharing
