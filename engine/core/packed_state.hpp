// A point's state in 36 bytes, for clouds of less than 2^31 points: as GPUs, the network, checksums and older files
// have it.
#pragma once

#include "engine/core/check.hpp"
#include "engine/core/point_state.hpp"

namespace palpate {

struct PackedState {
  static constexpr std::uint32_t kGone = 0x80000000u;

  Vec3 position{0};
  std::uint32_t id = 0;  ///< the number, with kGone
  Vec3 normal{0};
  std::uint32_t color = 0;
  std::uint32_t parent = 0;
};
static_assert(sizeof(PackedState) == 36);

inline PointState stateOf(const PackedState& packed) {
  return {.position = packed.position,
          .gone = (packed.id & PackedState::kGone) != 0,
          .number = packed.id & ~PackedState::kGone,
          .normal = packed.normal,
          .color = packed.color,
          .parent = packed.parent};
}

/// The state's number must be below PackedState::kGone, and its layer the first.
inline PackedState packedState(const PointState& state) {
  PALPATE_CHECK_LT(state.number, std::uint64_t{PackedState::kGone});
  PALPATE_CHECK_EQ(state.layer, 0);
  return {.position = state.position,
          .id = static_cast<std::uint32_t>(state.number) | (state.gone ? PackedState::kGone : 0),
          .normal = state.normal,
          .color = state.color,
          .parent = static_cast<std::uint32_t>(state.parent)};
}

}  // namespace palpate
