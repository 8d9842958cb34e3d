#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/point_state.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/mesh/mesh_plan.hpp"
#include "engine/spatial/spatial_hash.hpp"

namespace palpate {

/// The points that a mesh is made of, on the GPU: those of the cloud that the plan uses, with their index. Edits set
/// them.
class MeshPoints {
 public:
  /// As of MarchingCubes.
  MeshPoints(Device& device, const PointCloud& cloud, const MeshPlan& plan, std::uint32_t spare, bool painted);

  /// Sets points to what `edits` say, in order, and says how many of the mesh's were among them.
  std::uint32_t set(std::span<const PointState> edits);
  /// How many the last call of set() has set.
  std::uint32_t moveCount() const { return moveCount_; }
  void forgetMoves() { moveCount_ = 0; }
  /// Builds the index of all, and says what it took on the GPU, us.
  double buildIndex();

  /// With its index, which is built.
  shared::CloudView view() const { return hash_.view(live_.back(), live_.slots()); }
  std::uint32_t slots() const { return live_.slots(); }
  const DVec3& origin() const { return origin_; }
  bool hasColors() const { return colored_; }
  DeviceAddress colors() const { return colors_.address(); }
  DeviceAddress moves() const { return moves_.address(); }
  std::uint64_t bytes() const;

 private:
  static constexpr std::uint32_t kNoPlace = 0xffffffffu;
  std::vector<shared::MeshMove> movesOf(std::span<const PointState> edits) const;

  Device& device_;
  bool colored_;
  std::vector<std::uint32_t> placeOf_;  // of a point in the live cloud; empty where all have their own number
  DVec3 origin_;
  LiveCloud live_;  // its front half by number, its back half in the order of the hash
  SpatialHash hash_;
  ComputePipeline movePoints_;
  Buffer colors_, moves_;
  std::uint32_t moveCount_ = 0;
};

}  // namespace palpate
