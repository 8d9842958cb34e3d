#include "engine/matter/soft_passes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "engine/core/check.hpp"
#include "engine/matter/gpu_soft_press.hpp"
#include "engine/matter/matter_pipeline.hpp"
#include "shaders/simulation.hpp"

namespace palpate {

namespace {

constexpr std::uint32_t kStrideUnit = 32;  // planes are aligned to cache lines

std::uint32_t roundedUp(std::size_t count, std::uint32_t unit) {
  return static_cast<std::uint32_t>((count + unit - 1) / unit * unit);
}

// Bound of how far a skin position can be outside the box of its cell's corners, relative to the extent of that box:
// shares outside 0 to 1 extrapolate along each axis, by at most `most`.
float beyondOf(std::span<const SkinPlace> places) {
  float most = 0;
  for (const SkinPlace& place : places)
    for (int axis = 0; axis < 3; ++axis) most = std::max({most, -place.at.share[axis], place.at.share[axis] - 1});
  return (std::pow(1 + 2 * most, 3.0f) - 1) / 2 + 1e-6f;
}

ComputePipeline cellsPass(Device& device, bool isSculpted, bool tries) {
  return {device,
          shader_code::matter_soft_cells,
          {.workgroupSize = shared::kMatterBlock,
           .pushBytes = sizeof(shared::SoftCellsArgs),
           .constants = {isSculpted ? 1u : 0u, tries ? 1u : 0u}}};
}

std::uint32_t blocksOf(std::uint32_t count) { return (count + shared::kMatterBlock - 1) / shared::kMatterBlock; }

std::uint64_t stateBytes(const SoftSizes& sizes) {
  return SoftMemory::kTools + sizes.tools * sizeof(shared::ToolState);
}

std::uint64_t planes(const SoftSizes& sizes, std::uint64_t count) { return count * sizes.stride; }

}  // namespace

SoftLayout::SoftLayout(const SoftLattice& lattice, std::span<const SkinPlace> places) : beyond(beyondOf(places)) {
  placeCells(lattice, places);
  placeSkin(lattice, places);
}

void SoftLayout::placeCells(const SoftLattice& lattice, std::span<const SkinPlace> places) {
  std::vector<char> hasSkin(lattice.cells(), 0);
  for (const SkinPlace& place : places) hasSkin[place.at.cell] = 1;
  skinCount = static_cast<std::uint32_t>(std::ranges::count(hasSkin, 1));
  firstInner = roundedUp(skinCount, shared::kMatterBlock);
  slots = firstInner + static_cast<std::uint32_t>(lattice.cells()) - skinCount;
  stride = roundedUp(std::size_t{slots} + 1, kStrideUnit);
  corners.resize(slots);
  volumes.assign(std::size_t{slots} + 1, 0);
  const double cube = std::pow(lattice.spacing_m(), 3);
  std::uint32_t nextSkin = 0, nextInner = firstInner;
  for (std::size_t c = 0; c < lattice.cells(); ++c) {
    const std::uint32_t slot = slotOf.emplace_back(hasSkin[c] != 0 ? nextSkin++ : nextInner++);
    const SoftLattice::Corners& nodes = lattice.corners()[c];
    for (std::size_t k = 0; k < 8; k += 2) PALPATE_CHECK_EQ(nodes[k] + 1, nodes[k + 1]);
    corners[slot] = {nodes[0], nodes[2], nodes[4], nodes[6]};
    volumes[slot] = static_cast<float>(cube * static_cast<double>(lattice.filled()[c]));
  }
  for (const SoftLattice::Corners& about : lattice.incident()) {
    bool isSkin = false;
    for (std::size_t k = 0; k < 8; ++k) {
      if (k % 4 == 0) incident.emplace_back(0);
      const std::size_t cell = about[k] / 8;
      const std::uint32_t slot = cell == lattice.cells() ? slots : slotOf[cell], corner = about[k] % 8;
      incident.back()[static_cast<int>(k % 4)] = 3 * corner * stride + slot;
      isSkin |= slot < skinCount;
    }
    skinNodes += isSkin ? 1 : 0;
  }
}

void SoftLayout::placeSkin(const SoftLattice& lattice, std::span<const SkinPlace> places) {
  std::vector<std::size_t> order(places.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return slotOf[places[i].at.cell]; });
  skinCells.resize(std::size_t{skinCount} + 1);
  for (std::size_t c = 0; c < lattice.cells(); ++c)
    if (slotOf[c] < skinCount) skinCells[slotOf[c]].corner = lattice.rest()[lattice.corners()[c][0]];
  std::uint32_t next = 0;
  for (std::size_t k = 0; k < skinCells.size(); ++k) {
    skinCells[k].first = next;
    for (; next < order.size() && slotOf[places[order[next]].at.cell] == k; ++next) {
      const SkinPlace& place = places[order[next]];
      skinNormals.emplace_back(place.normal, std::bit_cast<float>(static_cast<std::uint32_t>(order[next])));
      skin.emplace_back(place.at.share, place.stiffness);
      skin.emplace_back(place.rest, 0);
    }
  }
}

std::uint32_t SoftSizes::cellBlocks() const { return blocksOf(slots); }
std::uint32_t SoftSizes::nodeBlocks() const { return blocksOf(nodes); }

SoftMemory::SoftMemory(Device& device, const SoftSizes& sizes)
    : setting(Buffer::of<shared::SoftSetting>(device, 1, Memory::upload, "soft setting")),
      hands(Buffer::of<shared::HandStep>(device, std::uint64_t{kMaxSubsteps} * sizes.tools, Memory::upload,
                                         "soft hands")),
      state(device, stateBytes(sizes), Memory::device, "soft state"),
      stateRead(device, stateBytes(sizes), Memory::readback, "soft state read"),
      nodes(softBuffer<Vec4>(device, std::uint64_t{shared::kNodeVec4s} * sizes.nodes, "nodes")),
      corners(softBuffer<glm::uvec4>(device, sizes.slots, "corners")),
      volumes(softBuffer<float>(device, std::uint64_t{sizes.slots} + 1, "volumes")),
      incident(softBuffer<glm::uvec4>(device, std::uint64_t{shared::kIncidentUVec4s} * sizes.nodes, "incident")),
      skinCells(softBuffer<shared::SoftSkinCell>(device, std::uint64_t{sizes.skinCount} + 1, "skin cells")),
      skin(softBuffer<Vec4>(device, std::uint64_t{shared::kSkinVec4s} * sizes.skin, "skin")),
      skinNormals(softBuffer<Vec4>(device, sizes.skin, "skin normals")),
      forces(softBuffer<float>(device, planes(sizes, shared::kForcePlanes), "forces")),
      cellSums(softBuffer<Vec4>(device, std::uint64_t{shared::kSoftRowsOfAll + 2 * sizes.tools} * sizes.cellBlocks(),
                                "cell sums")),
      nodeSums(softBuffer<Vec4>(device, std::uint64_t{shared::kSoftRowsOfAll} * sizes.nodeBlocks(), "node sums")),
      points{.rests = softBuffer<Vec4>(device, sizes.points, "points at rest"),
             .shares = softBuffer<Vec4>(device, sizes.points, "shares"),
             .normalRests = softBuffer<glm::uvec2>(device, sizes.points, "normals at rest")},
      gradients(softBuffer<float>(device, planes(sizes, shared::kGradientPlanes), "gradients")),
      nodeGradients(
          softBuffer<Vec4>(device, std::uint64_t{shared::kGradientVec4s} * sizes.nodes, "gradients of nodes")) {
  static_assert(kSums + sizeof(shared::MatterSums) == kTools);
}

std::uint64_t SoftMemory::bytes() const {
  std::uint64_t sum = 0;
  for (const Buffer* buffer :
       {&setting, &hands, &state, &stateRead, &nodes, &corners, &volumes, &incident, &skinCells, &skin, &skinNormals,
        &forces, &cellSums, &nodeSums, &points.rests, &points.shares, &points.normalRests, &gradients, &nodeGradients})
    sum += buffer->bytes();
  return sum + (rests ? rests->bytes() : 0);
}

void SoftMemory::holdShapes(Device& device, const SoftSizes& sizes) {
  if (rests) return;
  rests.emplace(Buffer::of<shared::CellRest>(device, sizes.slots, Memory::upload, "soft rest shapes"));
  std::ranges::fill(rests->mapped<shared::CellRest>(), shared::CellRest{});
}

SoftPasses::SoftPasses(Device& device)
    : predict_(matterPipeline<shared::SoftPredictArgs>(device, shader_code::matter_soft_predict)),
      cells_(cellsPass(device, false, false)),
      nodes_(matterPipeline<shared::SoftNodesArgs>(device, shader_code::matter_soft_nodes)),
      finish_(matterPipeline<shared::SoftFinishArgs>(device, shader_code::matter_soft_finish)),
      strain_(matterPipeline<shared::SoftStrainArgs>(device, shader_code::matter_soft_strain)),
      blend_(matterPipeline<shared::SoftBlendArgs>(device, shader_code::matter_soft_blend)),
      carry_(matterPipeline<shared::SoftCarryArgs>(device, shader_code::matter_soft_carry)) {}

void SoftPasses::recordStep(CommandList& list, const SoftMemory& memory, const SoftSizes& sizes,
                            const GpuSoftPress* press) const {
  if (press) press->recordBegin(list);
  list.dispatch(predict_, sizes.tools,
                shared::SoftPredictArgs{.setting = memory.setting.address(),
                                        .hands = memory.hands.address(),
                                        .tools = memory.state.address() + SoftMemory::kTools,
                                        .toolCount = sizes.tools,
                                        .unused = 0});
  for (std::uint32_t substep = 0; substep < sizes.substeps; ++substep) {
    recordCells(list, memory, sizes,
                {.pass = sizes.isSculpted ? *sculptedCells_ : cells_,
                 .nodes = memory.nodes.address(),
                 .tools = memory.state.address() + SoftMemory::kTools,
                 .toolCount = sizes.tools,
                 .begins = substep == 0,
                 .ends = substep + 1 == sizes.substeps});
    if (press) press->recordSubstep(list, substep, sizes.substeps);
    recordNodes(list, memory, sizes, substep);
  }
  list.dispatch(finish_, shared::kMatterBlock,
                shared::SoftFinishArgs{.cellSums = memory.cellSums.address(),
                                       .nodeSums = memory.nodeSums.address(),
                                       .total = memory.state.address() + SoftMemory::kSums,
                                       .cellBlocks = sizes.cellBlocks(),
                                       .nodeBlocks = sizes.nodeBlocks()});
  if (press) press->recordEnd(list);
}

void SoftPasses::holdShapes(Device& device) {
  if (!sculptedCells_) sculptedCells_.emplace(cellsPass(device, true, false));
}

ComputePipeline SoftPasses::trialPass(Device& device, const SoftSizes& sizes) {
  return cellsPass(device, sizes.isSculpted, true);
}

void SoftPasses::recordTrial(CommandList& list, const ComputePipeline& pass, const SoftMemory& memory,
                             const SoftSizes& sizes, DeviceAddress nodes) {
  recordCells(list, memory, sizes,
              {.pass = pass, .nodes = nodes, .tools = 0, .toolCount = 0, .begins = true, .ends = false});
}

void SoftPasses::recordCells(CommandList& list, const SoftMemory& memory, const SoftSizes& sizes, const Cells& cells) {
  list.dispatch(cells.pass, sizes.slots,
                shared::SoftCellsArgs{.setting = memory.setting.address(),
                                      .nodes = cells.nodes,
                                      .corners = memory.corners.address(),
                                      .volumes = memory.volumes.address(),
                                      .forces = memory.forces.address(),
                                      .skinCells = memory.skinCells.address(),
                                      .skin = memory.skin.address(),
                                      .tools = cells.tools,
                                      .sums = memory.cellSums.address(),
                                      .rests = sizes.isSculpted ? memory.rests->address() : 0,
                                      .present = memory.nodes.address(),
                                      .skinCount = sizes.skinCount,
                                      .firstInner = sizes.firstInner,
                                      .slots = sizes.slots,
                                      .stride = sizes.stride,
                                      .blocks = sizes.cellBlocks(),
                                      .toolCount = cells.toolCount,
                                      .begins = cells.begins,
                                      .ends = cells.ends});
}

void SoftPasses::recordNodes(CommandList& list, const SoftMemory& memory, const SoftSizes& sizes,
                             std::uint32_t substep) const {
  const std::uint32_t groups = sizes.nodeBlocks() + (sizes.tools > 0 ? 1 : 0);
  list.dispatch(nodes_, std::uint64_t{groups} * shared::kMatterBlock,
                shared::SoftNodesArgs{.setting = memory.setting.address(),
                                      .nodes = memory.nodes.address(),
                                      .incident = memory.incident.address(),
                                      .forces = memory.forces.address(),
                                      .sums = memory.nodeSums.address(),
                                      .cellSums = memory.cellSums.address(),
                                      .hands = memory.hands.address(),
                                      .tools = memory.state.address() + SoftMemory::kTools,
                                      .nodeCount = sizes.nodes,
                                      .stride = sizes.stride,
                                      .blocks = sizes.nodeBlocks(),
                                      .cellBlocks = sizes.cellBlocks(),
                                      .skinBlocks = sizes.firstInner / shared::kMatterBlock,
                                      .toolCount = sizes.tools,
                                      .hasPins = sizes.hasPins,
                                      .substep = substep,
                                      .ends = substep + 1 == sizes.substeps,
                                      .unused = 0});
}

void SoftPasses::recordFrame(CommandList& list, const SoftMemory& memory, const SoftSizes& sizes,
                             const CarriedPoints& to) const {
  list.dispatch(strain_, sizes.slots,
                shared::SoftStrainArgs{.setting = memory.setting.address(),
                                       .nodes = memory.nodes.address(),
                                       .corners = memory.corners.address(),
                                       .volumes = memory.volumes.address(),
                                       .gradients = memory.gradients.address(),
                                       .skinCount = sizes.skinCount,
                                       .firstInner = sizes.firstInner,
                                       .slots = sizes.slots,
                                       .stride = sizes.stride});
  list.dispatch(blend_, sizes.nodes,
                shared::SoftBlendArgs{.incident = memory.incident.address(),
                                      .volumes = memory.volumes.address(),
                                      .gradients = memory.gradients.address(),
                                      .nodeGradients = memory.nodeGradients.address(),
                                      .nodeCount = sizes.nodes,
                                      .stride = sizes.stride});
  list.dispatch(carry_, sizes.points,
                shared::SoftCarryArgs{.setting = memory.setting.address(),
                                      .nodes = memory.nodes.address(),
                                      .nodeGradients = memory.nodeGradients.address(),
                                      .corners = memory.corners.address(),
                                      .rests = memory.points.rests.address(),
                                      .shares = memory.points.shares.address(),
                                      .normalRests = memory.points.normalRests.address(),
                                      .positions = to.positions,
                                      .normals = to.normals,
                                      .velocities = to.velocities,
                                      .points = sizes.points,
                                      .unitsPerMetre = static_cast<float>(to.unitsPerMetre),
                                      .origin = to.origin,
                                      .unused = 0});
}

}  // namespace palpate
