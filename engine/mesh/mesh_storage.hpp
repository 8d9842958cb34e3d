#pragma once

#include <array>
#include <cstdint>

#include "engine/gpu/buffer.hpp"
#include "engine/mesh/mesh_plan.hpp"

namespace palpate {

inline constexpr std::uint64_t kMeshWordBytes = sizeof(std::uint32_t);

/// Makes room for so many bytes; what was in it is lost where it had less.
void growBuffer(Device& device, Buffer& buffer, std::uint64_t bytes);

/// What the passes of a mesh read and write on the GPU besides the points: the lattice and the mesh, as they are and as
/// they were before an update. Grows as the mesh does. "Slots": blocks that are there.
class MeshStorage {
 public:
  MeshStorage(Device& device, const shared::MeshLattice& lattice);

  /// What an update keeps from the state before it.
  struct State {
    Buffer table, values, vertexStarts, vertices;
    std::uint64_t bytes() const { return table.bytes() + values.bytes() + vertexStarts.bytes() + vertices.bytes(); }
  };
  const State& now() const { return states_[current_]; }
  /// What is there now becomes the state before.
  void flip() { current_ = 1 - current_; }

  void growTable(std::uint32_t entries);
  /// `update`: with room for what an edit has touched. `scanBytes`: for each of two scans.
  void growBlocks(std::uint64_t slots, bool update, std::uint64_t scanBytes);
  void growMesh(std::uint64_t vertices, std::uint64_t triangles);

  /// Where all of it is, for shaders; after it has grown. `colors`, `moves`: of the points.
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
