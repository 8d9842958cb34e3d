#include "engine/mesh/marching_cubes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "engine/core/job_stop.hpp"
#include "engine/core/stop_checks.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/gpu/transfer.hpp"
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

MarchingCubes::MarchingCubes(Device& device, const PointCloud& cloud, const MeshPlan& plan, std::uint32_t spare,
                             bool painted)
    : device_(device),
      plan_(plan),
      points_(device, cloud, plan, spare, painted),
      storage_(device, plan.lattice),
      passes_(device, plan, points_.hasColors()),
      scan_(device) {}

MeshStep MarchingCubes::build() {
  points_.forgetMoves();
  return remesh(false);
}

MeshStep MarchingCubes::update(std::span<const PointState> edits) {
  if (points_.set(edits) == 0 && slots_ > 0) return {.blocks = slots_};
  return remesh(slots_ > 0);
}

MeshStep MarchingCubes::remesh(bool update) {
  if (update) storage_.flip();
  MeshStep step;
  step.gpu_us.index = points_.buildIndex();
  throwIfStopWanted();
  listBlocks(step);
  throwIfStopWanted();
  fillLattice(step, update);
  throwIfStopWanted();
  writeTriangles(step, update);
  throwIfStopWanted();
  return step;
}

void MarchingCubes::writeAddresses() { storage_.writeAddresses(points_.colors(), points_.moves()); }

void MarchingCubes::listBlocks(MeshStep& step) {
  const std::uint32_t entries = shared::blockCount(plan_.lattice) + 1;
  storage_.growTable(entries);
  writeAddresses();
  const Buffer there = Buffer::of<std::uint32_t>(device_, 1, Memory::readback, "mesh blocks that are there");
  CommandList list(device_, device_.throughputQueue(), "mesh blocks", CommandList::Timing::sections);
  list.begin();
  {
    const auto section = list.section("list");
    list.fill(storage_.now().table, 0, entries * kMeshWordBytes);
    passes_.recordMark(list, args(points_.slots()));
    scan_.record(list, {storage_.now().table.address(), storage_.scratch().address()}, entries);
  }
  list.copy(storage_.now().table, there, kMeshWordBytes, (entries - 1) * kMeshWordBytes);
  list.end();
  device_.throughputQueue().run(list);
  step.gpu_us.list = list.sectionTime_us("list");
  slots_ = step.blocks = there.mapped<std::uint32_t>()[0];
}

void MarchingCubes::fillLattice(MeshStep& step, bool update) {
  if (slots_ > std::numeric_limits<std::uint32_t>::max() / shared::kMeshBlockNodes)
    throw OutOfGpuMemory("{}: {} blocks exceed the maximum of a mesh; use a lower resolution", device_.name(), slots_);
  const std::uint64_t slots = slots_, ends = slots + 1;
  const std::uint64_t scanBytes = PrefixScan::scratchBytes(ends);
  storage_.growBlocks(slots, update, scanBytes);
  writeAddresses();
  const Buffer totals = Buffer::of<std::uint32_t>(device_, 2, Memory::readback, "mesh totals");
  CommandList list(device_, device_.throughputQueue(), "mesh lattice", CommandList::Timing::sections);
  list.begin();
  {
    const auto section = list.section("list");
    {
      const auto overlap = list.independent();
      passes_.recordList(list, args(shared::blockCount(plan_.lattice)));
      list.fill(storage_.masks(), 0, slots * shared::kMeshMaskWords * kMeshWordBytes);
      list.fill(storage_.now().vertexStarts, 0, kMeshWordBytes, slots * kMeshWordBytes);
      list.fill(storage_.triangleStarts(), 0, kMeshWordBytes, slots * kMeshWordBytes);
      if (update) list.fill(storage_.touched(), 0, slots * kMeshWordBytes);
    }
    if (update) passes_.recordTouch(list, args(points_.moveCount()));
  }
  list.end();
  device_.throughputQueue().run(list);
  step.gpu_us.list += list.sectionTime_us("list");
  step.gpu_us.field = runOverBlocks(
      "field", update, [&](CommandList& to, const shared::MeshArgs& blocks) { passes_.recordField(to, blocks); });
  throwIfStopWanted();
  CommandList rest(device_, device_.throughputQueue(), "mesh counts", CommandList::Timing::sections);
  rest.begin();
  {
    const auto section = rest.section("classify");
    passes_.recordClassify(rest, args(slots));
  }
  {
    const auto section = rest.section("scan");
    passes_.recordCount(rest, args(slots));
    scan_.record(
        rest,
        std::array{PrefixScan::Io{storage_.now().vertexStarts.address(), storage_.scratch().address()},
                   PrefixScan::Io{storage_.triangleStarts().address(), storage_.scratch().address() + scanBytes}},
        static_cast<std::uint32_t>(ends));
  }
  rest.copy(storage_.now().vertexStarts, totals, kMeshWordBytes, slots * kMeshWordBytes);
  rest.copy(storage_.triangleStarts(), totals, kMeshWordBytes, slots * kMeshWordBytes, kMeshWordBytes);
  rest.end();
  device_.throughputQueue().run(rest);
  step.gpu_us.classify = rest.sectionTime_us("classify");
  step.gpu_us.scan = rest.sectionTime_us("scan");
  vertexCount_ = totals.mapped<std::uint32_t>()[0];
  triangleCount_ = totals.mapped<std::uint32_t>()[1];
  step.treated = slots_;
  if (update && slots > 0)
    step.treated = static_cast<std::uint32_t>(std::ranges::count_if(
        palpate::download<std::uint32_t>(device_, device_.throughputQueue(), storage_.touched(), slots),
        [](auto word) { return word != 0; }));
}

void MarchingCubes::writeTriangles(MeshStep& step, bool update) {
  storage_.growMesh(vertexCount_, triangleCount_);
  writeAddresses();
  if (vertexCount_ > 0)
    step.gpu_us.vertices = runOverBlocks("vertices", update, [&](CommandList& to, const shared::MeshArgs& blocks) {
      passes_.recordVertices(to, blocks);
    });
  CommandList list(device_, device_.throughputQueue(), "mesh triangles", CommandList::Timing::sections);
  list.begin();
  {
    const auto section = list.section("triangles");
    if (triangleCount_ > 0) passes_.recordTriangles(list, args(slots_));
  }
  list.end();
  device_.throughputQueue().run(list);
  step.gpu_us.triangles = list.sectionTime_us("triangles");
}

shared::MeshArgs MarchingCubes::args(std::uint64_t count, bool update) const {
  return {.cloud = points_.view(),
          .lattice = plan_.lattice,
          .buffers = storage_.addresses(),
          .count = static_cast<std::uint32_t>(count),
          .slots = slots_,
          .rows = 0,
          .update = update,
          .first = 0,
          .unused = 0};
}

double MarchingCubes::runOverBlocks(const std::string& name, bool update,
                                    const std::function<void(CommandList&, const shared::MeshArgs&)>& record) {
  constexpr std::uint32_t kFirstPart = 16;  // blocks
  constexpr double kPart_s = 0.05, kGrowth = 4;
  double time_us = 0;
  std::uint32_t part = jobStop.mayCut ? kFirstPart : slots_;
  for (std::uint32_t first = 0; first < slots_;) {
    throwIfStopWanted();
    const Stopwatch watch;
    shared::MeshArgs blocks = args(std::min(part, slots_ - first), update);
    blocks.first = first;
    CommandList list(device_, device_.throughputQueue(), "mesh " + name, CommandList::Timing::sections);
    list.begin();
    {
      const auto section = list.section(name);
      record(list, blocks);
    }
    list.end();
    device_.throughputQueue().run(list);
    time_us += list.sectionTime_us(name);
    first += blocks.count;
    const double growth = std::clamp(kPart_s / std::max(watch.elapsed_s(), 1e-6), 1 / kGrowth, kGrowth);
    part = std::max(1U, static_cast<std::uint32_t>(std::min(growth * part, static_cast<double>(slots_))));
  }
  return time_us;
}

Mesh MarchingCubes::download() const {
  Mesh mesh;
  StopChecks check;
  mesh.vertices.origin = points_.origin();
  for (const auto& vertex : palpate::download<shared::MeshVertex>(device_, device_.throughputQueue(),
                                                                  storage_.now().vertices, vertexCount_)) {
    check();
    mesh.vertices.positions.push_back(vertex.position);
    mesh.vertices.normals.push_back(vertex.normal);
    if (points_.hasColors()) mesh.vertices.colors.push_back(std::bit_cast<std::array<std::uint8_t, 4>>(vertex.color));
  }
  mesh.triangles = palpate::download<std::array<std::uint32_t, 3>>(device_, device_.throughputQueue(),
                                                                   storage_.triangles(), triangleCount_);
  return mesh;
}

}  // namespace palpate
