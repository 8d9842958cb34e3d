#pragma once

#include <array>
#include <cstdint>

#include "engine/gpu/buffer.hpp"
#include "engine/mesh/mesh_plan.hpp"

namespace palpate {

inline constexpr std::uint64_t kMeshWordBytes = sizeof(std::uint32_t);

/// Ensures a capacity of `bytes`; the contents are lost if the buffer grows.
void growBuffer(Device& device, Buffer& buffer, std::uint64_t bytes);

/// GPU memory of the mesh passes besides the points: the lattice and the mesh, in their current state and in that
/// before an update. Grows with the mesh. "Slots": the blocks in use.
class MeshStorage {
 public:
  MeshStorage(Device& device, const shared::MeshLattice& lattice);

  /// State that an update keeps from before.
  struct State {
    Buffer table, values, vertexStarts, vertices;
    std::uint64_t bytes() const { return table.bytes() + values.bytes() + vertexStarts.bytes() + vertices.bytes(); }
  };
  const State& now() const { return states_[current_]; }
  /// The current state becomes the previous one.
  void flip() { current_ = 1 - current_; }

  void growTable(std::uint32_t entries);
  /// `update`: also for the blocks touched by an edit. `scanBytes`: for each of two scans.
  void growBlocks(std::uint64_t slots, bool update, std::uint64_t scanBytes);
  void growMesh(std::uint64_t vertices, std::uint64_t triangles);

  /// Writes the addresses of all buffers for shaders; call after growing. `colors`, `moves`: of the points.
  void writeAddresses(DeviceAddress colors, DeviceAddress moves);
  DeviceAddress addresses() const { return addresses_.address(); }

  const Buffer& scratch() const { return scratch_; }
  const Buffer& masks() const { return masks_; }
  const Buffer& triangleStarts() const { return triangleStarts_; }
  const Buffer& touched() const { return touched_; }
  const Buffer& triangles() const { return triangles_; }
  std::uint64_t bytes() const;

 private:
  static State makeState(Device& device);
  State& current() { return states_[current_]; }
  const State& old() const { return states_[1 - current_]; }

  Device& device_;
  Buffer addresses_, scratch_, cellCases_;
  std::array<State, 2> states_;
  std::uint32_t current_ = 0;
  Buffer blocks_, cases_, masks_, ranks_, triangleStarts_, touched_, triangles_;
};

}  // namespace palpate
