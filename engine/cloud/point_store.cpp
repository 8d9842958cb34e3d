#include "engine/cloud/point_store.hpp"

#include "engine/core/checksum.hpp"

namespace palpate {

std::uint64_t checksumOf(const Brick& brick) {
  Checksum sum;
  const auto add = [&](const auto& values) {
    sum.addValue(std::uint64_t{values.size()});
    sum.add(std::as_bytes(std::span(values)));
  };
  add(brick.ids);
  add(brick.positions);
  add(brick.normals);
  add(brick.velocities);
  const bool isColored = std::ranges::any_of(brick.colors, [](std::uint32_t color) { return color != 0; });
  if (isColored) add(brick.colors);
  return sum.value();
}

}  // namespace palpate
