#include "engine/mesh/mesh_passes.hpp"

#include <cmath>
#include <limits>

#include "engine/core/error.hpp"
#include "engine/gpu/device.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

// Maximum number of blocks along an axis that a box of side 2 * reach touches, with a margin for rounding.
std::uint32_t rowsFor(const shared::MeshLattice& lattice, float reach) {
  const float side = static_cast<float>(shared::kMeshBlockSide) * lattice.cell;
  return static_cast<std::uint32_t>(std::ceil(2.001f * reach / side)) + 1;
}

std::uint64_t threadsFor(std::uint64_t places, std::uint64_t rows) {
  const std::uint64_t threads = places * rows * rows;
  if (threads > std::numeric_limits<std::uint32_t>::max())
    throw Error("the resolution is too fine for {} points with such a wide support radius; use a lower one", places);
  return threads;
}

// A point of a piece takes 28 bytes, other shared memory less than 6 KiB.
constexpr std::uint32_t kPiece = 512, kSmallPiece = 256, kPieceBytes = 20 * 1024;

std::uint32_t fieldWorkgroup(const Device& device) {
  const bool wide = device.widestWorkgroup() >= shared::kMeshFieldWorkgroup && sharedBytes(device) >= kPieceBytes;
  return wide ? shared::kMeshFieldWorkgroup : kFewestInvocations;
}
std::uint32_t pieceFor(const Device& device) { return sharedBytes(device) >= kPieceBytes ? kPiece : kSmallPiece; }

}  // namespace

MeshPasses::MeshPasses(Device& device, const MeshPlan& plan, bool colored)
    : mark_(device, shader_code::mesh_mark, {.pushBytes = sizeof(shared::MeshArgs)}),
      list_(device, shader_code::mesh_list, {.pushBytes = sizeof(shared::MeshArgs)}),
      touch_(device, shader_code::mesh_touch_blocks, {.pushBytes = sizeof(shared::MeshArgs)}),
      field_(device, shader_code::mesh_field,
             {.workgroupSize = fieldWorkgroup(device),
              .pushBytes = sizeof(shared::MeshArgs),
              .constants = {static_cast<std::uint32_t>(plan.surface), 0, pieceFor(device)}}),
      classify_(device, shader_code::mesh_classify,
                {.workgroupSize = shared::kMeshWorkgroup, .pushBytes = sizeof(shared::MeshArgs)}),
      count_(device, shader_code::mesh_count,
             {.workgroupSize = shared::kMeshMaskWords, .pushBytes = sizeof(shared::MeshArgs)}),
      vertices_(device, shader_code::mesh_vertices,
                {.workgroupSize = shared::kMeshVertexWorkgroup,
                 .pushBytes = sizeof(shared::MeshArgs),
                 .constants = {static_cast<std::uint32_t>(plan.surface), colored ? 1u : 0u, pieceFor(device)}}),
      triangles_(device, shader_code::mesh_triangles,
                 {.workgroupSize = shared::kMeshWorkgroup, .pushBytes = sizeof(shared::MeshArgs)}) {}

void MeshPasses::recordMark(CommandList& list, shared::MeshArgs args) const {
  args.rows = rowsFor(args.lattice, args.lattice.reach);
  list.dispatch(mark_, threadsFor(args.count, args.rows), args);
}

void MeshPasses::recordList(CommandList& list, const shared::MeshArgs& args) const {
  list.dispatch(list_, args.count, args);
}

void MeshPasses::recordTouch(CommandList& list, shared::MeshArgs args) const {
  // One block more at the low end: its uppermost cells end where the next block begins.
  args.rows = rowsFor(args.lattice, args.lattice.radius + args.lattice.cell) + 1;
  list.dispatch(touch_, threadsFor(2 * std::uint64_t{args.count}, args.rows), args);
}

void MeshPasses::recordField(CommandList& list, const shared::MeshArgs& args) const {
  list.dispatch(field_, std::uint64_t{args.count} * shared::kMeshBlockNodes * shared::kMeshFieldSharers, args);
}

void MeshPasses::recordClassify(CommandList& list, const shared::MeshArgs& args) const {
  list.dispatch(classify_, std::uint64_t{args.count} * shared::kMeshWorkgroup, args);
}

void MeshPasses::recordCount(CommandList& list, const shared::MeshArgs& args) const {
  list.dispatch(count_, std::uint64_t{args.count} * shared::kMeshMaskWords, args);
}

void MeshPasses::recordVertices(CommandList& list, const shared::MeshArgs& args) const {
  list.dispatch(vertices_, std::uint64_t{args.count} * shared::kMeshVertexWorkgroup, args);
}

void MeshPasses::recordTriangles(CommandList& list, const shared::MeshArgs& args) const {
  list.dispatch(triangles_, std::uint64_t{args.count} * shared::kMeshWorkgroup, args);
}

}  // namespace palpate
