#pragma once

#include "engine/cuda/cub_hash_build.hpp"

namespace palpate::cu {

/// Moves every `period`th point, by id and beginning with `phase`, by `offset` along x. Submits only.
void launchMovePoints(const CloudSide& side, std::uint32_t count, std::uint32_t period, std::uint32_t phase,
                      float offset, const Stream& stream);

}  // namespace palpate::cu
