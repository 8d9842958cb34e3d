#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "engine/core/vec.hpp"

namespace palpate {

/// A point at one moment of an edited cloud. It is known by its layer and its number there, which is that in the file;
/// new points are numbered after those. A back end may number its own points with fewer bits.
struct PointState {
  Vec3 position{0};  ///< model units, relative to the cloud's origin
  std::uint16_t layer = 0;
  bool gone = false;  ///< it does not exist (any more)
  std::uint64_t number = 0;
  Vec3 normal{0};           ///< unit
  std::uint32_t color = 0;  ///< RGBA8; 0 if the cloud has no colours
  std::uint64_t parent =
      0;  ///< number of the point from which it took its other properties; its own if it is in the file

  bool operator==(const PointState&) const = default;
};

/// Compares bits: zero has two signs.
inline bool isSameToTheBit(const PointState& a, const PointState& b) {
  const auto bits = [](const Vec3& v) {
    return std::array{std::bit_cast<std::uint32_t>(v.x), std::bit_cast<std::uint32_t>(v.y),
                      std::bit_cast<std::uint32_t>(v.z)};
  };
  return a.layer == b.layer && a.gone == b.gone && a.number == b.number && a.color == b.color && a.parent == b.parent &&
         bits(a.position) == bits(b.position) && bits(a.normal) == bits(b.normal);
}

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
