// PointCloud2 of ROS, whose messages define the layout of their points: from a cloud, and to one. Independent of DDS.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/log.hpp"
#include "engine/core/point_state.hpp"

namespace palpate {

/// One or several numbers of each point.
struct RosField {
  enum Type : std::uint8_t { i8 = 1, u8, i16, u16, i32, u32, f32, f64 };

  std::string_view name;
  std::uint32_t offset = 0;  ///< from the beginning of the point, bytes
  std::uint8_t type = f32;   ///< a Type, if the message is valid
  std::uint32_t count = 1;
};

/// The message as received, not validated yet, or as sent. What it refers to must outlive it.
struct RosPoints {
  std::uint32_t height = 0, width = 0;
  std::span<const RosField> fields;
  bool isBigEndian = false;
  std::uint32_t pointStep = 0, rowStep = 0;  ///< bytes
  std::span<const std::uint8_t> data;
};

/// Fields of a message of a cloud: position and normal as float32, and the colour, whose bytes are stored as a float32,
/// too, as ROS does.
std::span<const RosField> fieldsOfRosPoints();
inline constexpr std::uint32_t kRosPointStep = 28;  // bytes

/// Data of such a message, without removed points: metres, from coordinates of the file. Points without a colour are
/// shown as kUnpainted.
std::vector<std::uint8_t> rosDataOf(std::span<const PointState> points, const DVec3& origin, double mm_per_unit);

struct TakenRosPoints {
  PointCloud cloud;           ///< in metres; other single numbers of its points are attributes of that name
  std::uint64_t skipped = 0;  ///< points without a valid position: NaN, or beyond 1e30
  /// For a message of several rows: the cell of each point in it, row * width + column.
  std::vector<std::uint32_t> cells;
};
/// Throws NetworkError if the message contradicts itself or has no positions. Allocates memory for the data present,
/// not for what is announced. Missing normals are logged.
TakenRosPoints takeRosPoints(const RosPoints& points, Log* log = nullptr);

}  // namespace palpate
