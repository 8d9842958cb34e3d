#pragma once

#include <array>
#include <cstdint>

#include "engine/core/vec.hpp"

namespace palpate {

/// A point at one moment of an edited cloud. Its id is its number in the file; new points are numbered after those.
struct PointState {
  /// Set in the id of a point that does not exist (any more).
  static constexpr std::uint32_t kGone = 0x80000000u;

  Vec3 position{0};  ///< model units, relative to the cloud's origin
  std::uint32_t id = 0;
  Vec3 normal{0};            ///< unit
  std::uint32_t color = 0;   ///< RGBA8; 0 if the cloud has no colours
  std::uint32_t parent = 0;  ///< the point from which it took its other properties; itself for a point of the file

  bool gone() const { return (id & kGone) != 0; }
  std::uint32_t number() const { return id & ~kGone; }
  bool operator==(const PointState&) const = default;
};

/// RGBA8 of points without a colour when they are shown, painted over, or written among coloured points: clay.
inline constexpr std::array<std::uint8_t, 4> kUnpainted{200, 170, 147, 255};

/// Colours as the GPU and the edit log have them: red in the lowest byte.
constexpr std::uint32_t packedColor(const std::array<std::uint8_t, 4>& color) {
  return color[0] | std::uint32_t{color[1]} << 8 | std::uint32_t{color[2]} << 16 | std::uint32_t{color[3]} << 24;
}
constexpr std::array<std::uint8_t, 4> unpackedColor(std::uint32_t color) {
  return {static_cast<std::uint8_t>(color), static_cast<std::uint8_t>(color >> 8),
          static_cast<std::uint8_t>(color >> 16), static_cast<std::uint8_t>(color >> 24)};
}

/// Change of a point from one state to another; both have the same number.
struct PointChange {
  PointState from, to;
};

}  // namespace palpate
