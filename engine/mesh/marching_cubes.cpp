#include "engine/mesh/marching_cubes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/mesh/cell_table.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

constexpr std::uint64_t kWord = sizeof(std::uint32_t);
constexpr float kNowhere = std::bit_cast<float>(0x7fc00000u);  // as the shaders know it

// The points that the plan looks at. Their places are their numbers in it.
PointCloud partOf(const PointCloud& cloud, const MeshPlan& plan) {
  if (plan.share >= 1) return cloud;
  PointCloud part;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    if (!plan.looksAt(i)) continue;
    part.positions.push_back(cloud.positions[i]);
    part.normals.push_back(cloud.normals[i]);
    if (cloud.hasColors()) part.colors.push_back(cloud.colors[i]);
  }
  return part;
}

// The numbers of all points that there may ever be, in the part; empty where it is the whole.
std::vector<std::uint32_t> placesIn(const MeshPlan& plan, std::uint64_t points, std::uint32_t none) {
  if (plan.share >= 1) return {};
  std::vector<std::uint32_t> places(points, none);
  std::uint32_t next = 0;
  for (std::uint32_t i = 0; i < points; ++i)
    if (plan.looksAt(i)) places[i] = next++;
  return places;
}

std::uint32_t spareIn(const MeshPlan& plan, std::size_t points, std::uint32_t spare) {
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < spare; ++i) kept += plan.looksAt(static_cast<std::uint32_t>(points) + i);
  return kept;
}

std::uint32_t packed(const std::array<std::uint8_t, 4>& color) { return std::bit_cast<std::uint32_t>(color); }

std::vector<UVec2> packedCases() {
  std::vector<UVec2> cases;
  for (const CellCase& cell : kCellCases) {
    std::uint64_t bits = std::uint64_t{cell.triangles} << 60;
    for (std::size_t c = 0; c < cell.edges.size(); ++c) bits |= std::uint64_t{cell.edges[c]} << (4 * c);
    cases.emplace_back(static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(bits >> 32));
  }
  return cases;
}

Buffer words(Device& device, std::uint64_t count, const char* name) {
  return Buffer::of<std::uint32_t>(device, count, Memory::device, name);
}

// Blocks along an axis that a box of two reaches, and a little more for rounding, may touch.
std::uint32_t rowsFor(const shared::MeshLattice& lattice, float reach) {
  const float side = static_cast<float>(shared::kMeshBlockSide) * lattice.cell;
  return static_cast<std::uint32_t>(std::ceil(2.001f * reach / side)) + 1;
}

std::uint64_t threadsFor(std::uint64_t places, std::uint64_t rows) {
  const std::uint64_t threads = places * rows * rows;
  if (threads > std::numeric_limits<std::uint32_t>::max())
    throw Error("the lattice is too fine for {} points with so wide a support; take a coarser one", places);
  return threads;
}

}  // namespace

MarchingCubes::MarchingCubes(Device& device, const PointCloud& cloud, const MeshPlan& plan, std::uint32_t spare,
                             bool painted)
    : device_(device),
      plan_(plan),
      colored_(cloud.hasColors() || painted),
      placeOf_(placesIn(plan, cloud.size() + spare, kNoPlace)),
      origin_(cloud.origin),
      live_(device, partOf(cloud, plan), plan.share < 1 ? spareIn(plan, cloud.size(), spare) : spare, &device.sight()),
      hash_(device, makeHashGrid(plan.lattice.origin, static_cast<double>(plan.lattice.radius), live_.slots()),
            live_.slots(), kDefaultSort, BucketOrder::stable, Slots::spare, &device.sight()),
      scan_(device),
      movePoints_(device, shader_code::mesh_move_points, {.pushBytes = sizeof(shared::MeshMoveArgs)}),
      mark_(device, shader_code::mesh_mark, {.pushBytes = sizeof(shared::MeshArgs)}),
      list_(device, shader_code::mesh_list, {.pushBytes = sizeof(shared::MeshArgs)}),
      touch_(device, shader_code::mesh_touch_blocks, {.pushBytes = sizeof(shared::MeshArgs)}),
      field_(device, shader_code::mesh_field,
             {.workgroupSize = shared::kMeshFieldWorkgroup,
              .pushBytes = sizeof(shared::MeshArgs),
              .constants = {static_cast<std::uint32_t>(plan.surface)}}),
      classify_(device, shader_code::mesh_classify,
                {.workgroupSize = shared::kMeshWorkgroup, .pushBytes = sizeof(shared::MeshArgs)}),
      count_(device, shader_code::mesh_count,
             {.workgroupSize = shared::kMeshMaskWords, .pushBytes = sizeof(shared::MeshArgs)}),
      vertices_(device, shader_code::mesh_vertices,
                {.workgroupSize = shared::kMeshVertexWorkgroup,
                 .pushBytes = sizeof(shared::MeshArgs),
                 .constants = {static_cast<std::uint32_t>(plan.surface), colored_ ? 1u : 0u}}),
      writeTriangles_(device, shader_code::mesh_triangles,
                      {.workgroupSize = shared::kMeshWorkgroup, .pushBytes = sizeof(shared::MeshArgs)}),
      addresses_(Buffer::of<shared::MeshBuffers>(device, 1, Memory::upload, "mesh addresses")),
      scratch_(device, PrefixScan::scratchBytes(shared::blockCount(plan.lattice) + 1), Memory::device, "mesh scratch"),
      cellCases_(Buffer::of<UVec2>(device, kCellCases.size(), Memory::device, "cell cases")),
      colors_(words(device, colored_ ? live_.slots() : 0, "mesh colours of points")),
      states_{makeState(), makeState()},
      blocks_(words(device, 0, "mesh blocks")),
      cases_(words(device, 0, "mesh cases")),
      masks_(words(device, 0, "mesh masks")),
      ranks_(words(device, 0, "mesh ranks")),
      triangleStarts_(words(device, 0, "mesh triangle starts")),
      touched_(words(device, 0, "mesh touched blocks")),
      triangles_(words(device, 0, "mesh triangles")),
      moves_(words(device, 0, "mesh moves")) {
  upload(device, device.sight(), cellCases_, packedCases());
  if (!colored_) return;
  std::vector<std::uint32_t> colors(live_.slots(), packed(kUnpainted));
  for (std::uint32_t i = 0, place = 0; i < cloud.size(); ++i)
    if (plan.looksAt(i) && cloud.hasColors()) colors[place++] = packed(cloud.colors[i]);
  upload(device, device.sight(), colors_, colors);
}

MarchingCubes::State MarchingCubes::makeState() const {
  return {words(device_, 0, "mesh table"), words(device_, 0, "mesh values"), words(device_, 0, "mesh vertex starts"),
          words(device_, 0, "mesh vertices")};
}

void MarchingCubes::grow(Buffer& buffer, std::uint64_t bytes) const {
  if (buffer.bytes() >= bytes) return;
  const std::string name = buffer.name();
  if (buffer.bytes() > 0) bytes += bytes / 4;         // a mesh that follows edits grows again and again
  buffer = Buffer(device_, 0, Memory::device, name);  // gives back first
  buffer = Buffer(device_, bytes, Memory::device, name);
}

void MarchingCubes::run(const CommandList& list) const { device_.sight().run(list); }

MeshStep MarchingCubes::build() {
  moveCount_ = 0;
  return remesh(false);
}

MeshStep MarchingCubes::update(std::span<const PointState> edits) {
  std::unordered_map<std::uint32_t, std::size_t> lastOf;
  std::vector<shared::MeshMove> moves;
  for (const PointState& edit : edits) {
    const std::uint32_t number = edit.number();
    const std::uint32_t points = placeOf_.empty() ? live_.slots() : static_cast<std::uint32_t>(placeOf_.size());
    PALPATE_CHECK_LT(number, points);
    const std::uint32_t place = placeOf_.empty() ? number : placeOf_[number];
    if (place == kNoPlace) continue;
    const shared::MeshMove move{.from = Vec3(0),
                                .to = edit.gone() ? Vec3(kNowhere) : edit.position,
                                .normal = edit.normal,
                                .id = place,
                                .color = edit.color != 0 ? edit.color : packed(kUnpainted)};
    const auto [entry, isNew] = lastOf.try_emplace(place, moves.size());
    if (isNew)
      moves.push_back(move);
    else
      moves[entry->second] = move;
  }
  if (moves.empty() && slots_ > 0) return {.blocks = slots_};
  moveCount_ = static_cast<std::uint32_t>(moves.size());
  grow(moves_, moves.size() * sizeof(shared::MeshMove));
  uploadBytes(device_, device_.sight(), moves_, std::as_bytes(std::span(moves)));
  CommandList list(device_, device_.sight(), "move points");
  list.begin();
  list.dispatch(movePoints_, moveCount_,
                shared::MeshMoveArgs{.positions = live_.side().positions.address(),
                                     .normals = live_.side().normals.address(),
                                     .colors = colors_.address(),
                                     .moves = moves_.address(),
                                     .count = moveCount_,
                                     .colored = colored_});
  list.end();
  run(list);
  return remesh(slots_ > 0);
}

MeshStep MarchingCubes::remesh(bool update) {
  if (update) current_ = 1 - current_;
  MeshStep step;
  buildIndex(step);
  listBlocks(step);
  fillLattice(step, update);
  writeTriangles(step, update);
  return step;
}

void MarchingCubes::buildIndex(MeshStep& step) {
  // From the order of numbers each time: what stands in a bucket does not depend on how it came there.
  for (SortMethod used = hash_.sort();; used = hash_.fallback()) {
    CommandList list(device_, device_.sight(), "mesh index", CommandList::Timing::sections);
    list.begin();
    {
      const auto section = list.section("index");
      hash_.recordBuild(list, live_.side(), live_.otherSide(), live_.slots(), used);
    }
    list.end();
    run(list);
    step.gpu_us.index += list.sectionTime_us("index");
    if (used == hash_.sort()) return;
  }
}

void MarchingCubes::listBlocks(MeshStep& step) {
  const std::uint32_t entries = shared::blockCount(plan_.lattice) + 1;
  grow(now().table, entries * kWord);
  writeAddresses();
  const Buffer there = Buffer::of<std::uint32_t>(device_, 1, Memory::readback, "mesh blocks that are there");
  CommandList list(device_, device_.sight(), "mesh blocks", CommandList::Timing::sections);
  list.begin();
  {
    const auto section = list.section("list");
    list.fill(now().table, 0, entries * kWord);
    shared::MeshArgs mark = args(live_.slots());
    mark.rows = rowsFor(plan_.lattice, plan_.lattice.reach);
    list.dispatch(mark_, threadsFor(mark.count, mark.rows), mark);
    scan_.record(list, {now().table.address(), scratch_.address()}, entries);
  }
  list.copy(now().table, there, kWord, (entries - 1) * kWord);
  list.end();
  run(list);
  step.gpu_us.list = list.sectionTime_us("list");
  slots_ = step.blocks = there.mapped<std::uint32_t>()[0];
}

void MarchingCubes::fillLattice(MeshStep& step, bool update) {
  if (slots_ > std::numeric_limits<std::uint32_t>::max() / shared::kMeshBlockNodes)
    throw OutOfGpuMemory("{}: {} blocks are more than a mesh can number; take a coarser lattice", device_.name(),
                         slots_);
  const std::uint64_t slots = slots_, ends = slots + 1;
  grow(now().values, slots * shared::kMeshBlockNodes * kWord);
  grow(now().vertexStarts, ends * kWord);
  grow(triangleStarts_, ends * kWord);
  grow(blocks_, slots * kWord);
  grow(cases_, slots * shared::kMeshCaseWords * kWord);
  grow(masks_, slots * shared::kMeshMaskWords * kWord);
  grow(ranks_, slots * shared::kMeshMaskWords * kWord);
  if (update) grow(touched_, slots * kWord);
  const std::uint64_t scanBytes = PrefixScan::scratchBytes(ends);
  grow(scratch_, 2 * scanBytes);
  writeAddresses();
  const Buffer totals = Buffer::of<std::uint32_t>(device_, 2, Memory::readback, "mesh totals");
  CommandList list(device_, device_.sight(), "mesh lattice", CommandList::Timing::sections);
  list.begin();
  {
    const auto section = list.section("list");
    {
      const auto overlap = list.independent();
      list.dispatch(list_, shared::blockCount(plan_.lattice), args(shared::blockCount(plan_.lattice)));
      list.fill(masks_, 0, slots * shared::kMeshMaskWords * kWord);
      list.fill(now().vertexStarts, 0, kWord, slots * kWord);
      list.fill(triangleStarts_, 0, kWord, slots * kWord);
      if (update) list.fill(touched_, 0, slots * kWord);
    }
    if (update) {
      shared::MeshArgs touch = args(moveCount_);
      // From one block further down: its uppermost cells end where the next one begins.
      touch.rows = rowsFor(plan_.lattice, plan_.lattice.radius + plan_.lattice.cell) + 1;
      list.dispatch(touch_, threadsFor(2 * std::uint64_t{moveCount_}, touch.rows), touch);
    }
  }
  {
    const auto section = list.section("field");
    list.dispatch(field_, slots * shared::kMeshFieldParts * shared::kMeshFieldWorkgroup, args(slots, update));
  }
  {
    const auto section = list.section("classify");
    list.dispatch(classify_, slots * shared::kMeshWorkgroup, args(slots));
  }
  {
    const auto section = list.section("scan");
    list.dispatch(count_, slots * shared::kMeshMaskWords, args(slots));
    scan_.record(list,
                 std::array{PrefixScan::Io{now().vertexStarts.address(), scratch_.address()},
                            PrefixScan::Io{triangleStarts_.address(), scratch_.address() + scanBytes}},
                 static_cast<std::uint32_t>(ends));
  }
  list.copy(now().vertexStarts, totals, kWord, slots * kWord);
  list.copy(triangleStarts_, totals, kWord, slots * kWord, kWord);
  list.end();
  run(list);
  step.gpu_us.list += list.sectionTime_us("list");
  step.gpu_us.field = list.sectionTime_us("field");
  step.gpu_us.classify = list.sectionTime_us("classify");
  step.gpu_us.scan = list.sectionTime_us("scan");
  vertexCount_ = totals.mapped<std::uint32_t>()[0];
  triangleCount_ = totals.mapped<std::uint32_t>()[1];
  step.treated = slots_;
  if (update && slots > 0)
    step.treated = static_cast<std::uint32_t>(
        std::ranges::count_if(palpate::download<std::uint32_t>(device_, device_.sight(), touched_, slots),
                              [](auto word) { return word != 0; }));
}

void MarchingCubes::writeTriangles(MeshStep& step, bool update) {
  grow(now().vertices, std::uint64_t{vertexCount_} * sizeof(shared::MeshVertex));
  grow(triangles_, std::uint64_t{triangleCount_} * 3 * kWord);
  writeAddresses();
  CommandList list(device_, device_.sight(), "mesh triangles", CommandList::Timing::sections);
  list.begin();
  {
    const auto section = list.section("vertices");
    if (vertexCount_ > 0)
      list.dispatch(vertices_, std::uint64_t{slots_} * shared::kMeshVertexWorkgroup, args(slots_, update));
  }
  {
    const auto section = list.section("triangles");
    if (triangleCount_ > 0)
      list.dispatch(writeTriangles_, std::uint64_t{slots_} * shared::kMeshWorkgroup, args(slots_));
  }
  list.end();
  run(list);
  step.gpu_us.vertices = list.sectionTime_us("vertices");
  step.gpu_us.triangles = list.sectionTime_us("triangles");
}

void MarchingCubes::writeAddresses() {
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
                                                 .colors = colors_.address(),
                                                 .moves = moves_.address()};
}

shared::MeshArgs MarchingCubes::args(std::uint64_t count, bool update) const {
  return {.cloud = hash_.view(live_.otherSide(), live_.slots()),
          .lattice = plan_.lattice,
          .buffers = addresses_.address(),
          .count = static_cast<std::uint32_t>(count),
          .slots = slots_,
          .rows = 0,
          .update = update};
}

Mesh MarchingCubes::download() const {
  Mesh mesh;
  mesh.vertices.origin = origin_;
  for (const auto& vertex :
       palpate::download<shared::MeshVertex>(device_, device_.sight(), now().vertices, vertexCount_)) {
    mesh.vertices.positions.push_back(vertex.position);
    mesh.vertices.normals.push_back(vertex.normal);
    if (colored_) mesh.vertices.colors.push_back(std::bit_cast<std::array<std::uint8_t, 4>>(vertex.color));
  }
  mesh.triangles =
      palpate::download<std::array<std::uint32_t, 3>>(device_, device_.sight(), triangles_, triangleCount_);
  return mesh;
}

std::uint64_t MarchingCubes::bytes() const {
  const auto sideBytes = [](const LiveCloud::Side& side) { return side.positions.bytes() + side.normals.bytes(); };
  std::uint64_t bytes =
      sideBytes(live_.side()) + sideBytes(live_.otherSide()) + hash_.bytes() + states_[0].bytes() + states_[1].bytes();
  for (const Buffer* buffer : {&addresses_, &scratch_, &cellCases_, &colors_, &blocks_, &cases_, &masks_, &ranks_,
                               &triangleStarts_, &touched_, &triangles_, &moves_})
    bytes += buffer->bytes();
  return bytes;
}

}  // namespace palpate
