// PointCloud2 of ROS, which says itself what stands at which byte of a point: from a cloud, and to one. Nothing of DDS
// is seen here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/log.hpp"
#include "engine/core/point_state.hpp"

namespace palpate {

/// A number, or several, that each point has.
struct RosField {
  enum Type : std::uint8_t { i8 = 1, u8, i16, u16, i32, u32, f32, f64 };

  std::string_view name;
  std::uint32_t offset = 0;  ///< from the beginning of the point, bytes
  std::uint8_t type = f32;   ///< a Type, unless somebody lies
  std::uint32_t count = 1;
};

/// The message as it came, of which nothing has been looked at, or as it goes. What it refers to outlives it.
struct RosPoints {
  std::uint32_t height = 0, width = 0;
  std::span<const RosField> fields;
  bool isBigEndian = false;
  std::uint32_t pointStep = 0, rowStep = 0;  ///< bytes
  std::span<const std::uint8_t> data;
  bool isDense = false;
};

/// What a message of a cloud has for each point: place and normal as float32, and the colour, whose bytes stand in one,
/// too, as ROS has it.
std::span<const RosField> fieldsOfRosPoints();
inline constexpr std::uint32_t kRosPointStep = 28;  // bytes

/// Data of such a message of the points that are there: metres, of coordinates of the file. Points without a colour are
/// shown as kUnpainted.
std::vector<std::uint8_t> rosDataOf(std::span<const PointState> points, const DVec3& origin, double mm_per_unit);

struct TakenRosPoints {
  PointCloud cloud;           ///< in metres; other numbers of its points, one by one, are attributes of that name
  std::uint64_t skipped = 0;  ///< points without a place: NaN, or beyond 1e30
  /// Of a message of several rows: where in it each point stood, row * width + column.
  std::vector<std::uint32_t> cells;
};
/// Throws NetworkError where the message contradicts itself, or has no places. Memory is taken for what is there, and
/// not for what is claimed. `log` may hear of normals that are missing.
TakenRosPoints takeRosPoints(const RosPoints& points, Log* log = nullptr);

}  // namespace palpate
