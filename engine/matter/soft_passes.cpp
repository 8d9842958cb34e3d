#include "engine/matter/soft_passes.hpp"

#include <algorithm>

#include "engine/matter/gpu_soft_press.hpp"
#include "engine/matter/matter_pipeline.hpp"
#include "shaders/simulation.hpp"

namespace palpate {

namespace {

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
