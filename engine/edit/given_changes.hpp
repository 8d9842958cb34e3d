#pragma once

#include <cstdint>
#include <span>

#include "engine/core/point_state.hpp"
#include "engine/spatial/hash_update.hpp"
#include "shaders/shared/edit.h"

namespace palpate {

/// Changes of points from the host, and the pass that lists them as moves.
class GivenChanges {
 public:
  /// `update` must outlive it.
  GivenChanges(Device& device, const HashUpdate& update);

  /// Maximum number at a time.
  std::uint32_t most() const { return most_; }
  /// `ids`: number of ids.
  void give(std::span<const PointChange> changes, std::uint32_t ids);

  struct Io {
    const shared::CloudView& cloud;
    std::uint32_t parity;
    DeviceAddress tables, lists;
  };
  /// Lists the last given changes. `flags`: shared::kRestore...
  void record(CommandList& list, const Io& io, std::uint32_t flags) const;

  std::uint64_t bytes() const { return changes_.bytes(); }
  static std::uint64_t predictedBytes(std::uint64_t points);

 private:
  const HashUpdate& update_;
  std::uint32_t subgroupSize_, most_;
  std::uint32_t count_ = 0;
  ComputePipeline restore_;
  Buffer changes_;
};

}  // namespace palpate
