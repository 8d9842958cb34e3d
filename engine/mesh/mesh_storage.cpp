#include "engine/mesh/mesh_storage.hpp"

#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/mesh/cell_table.hpp"
#include "engine/spatial/prefix_scan.hpp"

namespace palpate {

namespace {

std::vector<UVec2> packedCases() {
  std::vector<UVec2> cases;
  for (const CellCase& cell : kCellCases) {
    std::uint64_t bits = std::uint64_t{cell.triangles} << 60;
    for (std::size_t c = 0; c < cell.edges.size(); ++c) bits |= std::uint64_t{cell.edges[c]} << (4 * c);
    cases.emplace_back(static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(bits >> 32));
  }
  return cases;
}

}  // namespace

void growBuffer(Device& device, Buffer& buffer, std::uint64_t bytes) {
  if (buffer.bytes() >= bytes) return;
  const std::string name = buffer.name();
  if (buffer.bytes() > 0) bytes += bytes / 4;        // a mesh that follows edits grows repeatedly
  buffer = Buffer(device, 0, Memory::device, name);  // frees the old memory first
  buffer = Buffer(device, bytes, Memory::device, name);
}

MeshStorage::MeshStorage(Device& device, const shared::MeshLattice& lattice)
    : device_(device),
      addresses_(Buffer::of<shared::MeshBuffers>(device, 1, Memory::upload, "mesh addresses")),
      scratch_(device, PrefixScan::scratchBytes(shared::blockCount(lattice) + 1), Memory::device, "mesh scratch"),
      cellCases_(Buffer::of<UVec2>(device, kCellCases.size(), Memory::device, "cell cases")),
      states_{makeState(device), makeState(device)},
      blocks_(deviceWords(device, 0, "mesh blocks")),
      cases_(deviceWords(device, 0, "mesh cases")),
      masks_(deviceWords(device, 0, "mesh masks")),
      ranks_(deviceWords(device, 0, "mesh ranks")),
      triangleStarts_(deviceWords(device, 0, "mesh triangle starts")),
      touched_(deviceWords(device, 0, "mesh touched blocks")),
      triangles_(deviceWords(device, 0, "mesh triangles")) {
  upload(device, device.throughputQueue(), cellCases_, packedCases());
}

MeshStorage::State MeshStorage::makeState(Device& device) {
  return {deviceWords(device, 0, "mesh table"), deviceWords(device, 0, "mesh values"),
          deviceWords(device, 0, "mesh vertex starts"), deviceWords(device, 0, "mesh vertices")};
}

void MeshStorage::growTable(std::uint32_t entries) { growBuffer(device_, current().table, entries * kMeshWordBytes); }

void MeshStorage::growBlocks(std::uint64_t slots, bool update, std::uint64_t scanBytes) {
  growBuffer(device_, current().values, slots * shared::kMeshBlockNodes * kMeshWordBytes);
  growBuffer(device_, current().vertexStarts, (slots + 1) * kMeshWordBytes);
  growBuffer(device_, triangleStarts_, (slots + 1) * kMeshWordBytes);
  growBuffer(device_, blocks_, slots * kMeshWordBytes);
  growBuffer(device_, cases_, slots * shared::kMeshCaseWords * kMeshWordBytes);
  growBuffer(device_, masks_, slots * shared::kMeshMaskWords * kMeshWordBytes);
  growBuffer(device_, ranks_, slots * shared::kMeshMaskWords * kMeshWordBytes);
  if (update) growBuffer(device_, touched_, slots * kMeshWordBytes);
  growBuffer(device_, scratch_, 2 * scanBytes);
}

void MeshStorage::growMesh(std::uint64_t vertices, std::uint64_t triangles) {
  growBuffer(device_, current().vertices, vertices * sizeof(shared::MeshVertex));
  growBuffer(device_, triangles_, triangles * 3 * kMeshWordBytes);
}

void MeshStorage::writeAddresses(DeviceAddress colors, DeviceAddress moves) {
  const auto addressesOf = [](const State& state) {
    return shared::MeshState{.table = state.table.address(),
                             .values = state.values.address(),
                             .vertexStarts = state.vertexStarts.address(),
                             .vertices = state.vertices.address()};
  };
  addresses_.mapped<shared::MeshBuffers>()[0] = {.now = addressesOf(now()),
                                                 .old = addressesOf(old()),
                                                 .blocks = blocks_.address(),
                                                 .cases = cases_.address(),
                                                 .masks = masks_.address(),
                                                 .ranks = ranks_.address(),
                                                 .triangleStarts = triangleStarts_.address(),
                                                 .triangles = triangles_.address(),
                                                 .cellCases = cellCases_.address(),
                                                 .touched = touched_.address(),
                                                 .colors = colors,
                                                 .moves = moves};
}

std::uint64_t MeshStorage::bytes() const {
  std::uint64_t bytes = states_[0].bytes() + states_[1].bytes();
  for (const Buffer* buffer : {&addresses_, &scratch_, &cellCases_, &blocks_, &cases_, &masks_, &ranks_,
                               &triangleStarts_, &touched_, &triangles_})
    bytes += buffer->bytes();
  return bytes;
}

}  // namespace palpate
