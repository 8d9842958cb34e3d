#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/point_state.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/mesh/mesh_plan.hpp"
#include "engine/spatial/spatial_hash.hpp"

namespace palpate {

/// The points of a mesh on the GPU: those of the cloud that the plan uses, with their index. Edits change them.
class MeshPoints {
 public:
  /// Arguments as for MarchingCubes.
  MeshPoints(Device& device, const PointCloud& cloud, const MeshPlan& plan, std::uint32_t spare, bool painted);

  /// Applies `edits` in order; returns how many points of the mesh they changed.
  std::uint32_t set(std::span<const PointState> edits);
  /// Result of the last set().
  std::uint32_t moveCount() const { return moveCount_; }
  void forgetMoves() { moveCount_ = 0; }
  /// Builds the index of all points; returns its GPU time, us.
  double buildIndex();

  /// View with the index; requires buildIndex().
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
  std::vector<std::uint32_t> placeOf_;  // index of a point in the live cloud, by its number; empty if they are equal
  DVec3 origin_;
  LiveCloud live_;  // front half by number, back half in hash order
  SpatialHash hash_;
  ComputePipeline movePoints_;
  Buffer colors_, moves_;
  std::uint32_t moveCount_ = 0;
};

}  // namespace palpate
