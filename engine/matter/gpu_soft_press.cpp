#include "engine/matter/gpu_soft_press.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "engine/core/check.hpp"
#include "engine/matter/matter_pipeline.hpp"
#include "shaders/shared/soft_press.h"
#include "shaders/simulation.hpp"

namespace palpate {

namespace {

std::uint64_t workgroups(std::uint32_t count) { return std::uint64_t{count} * shared::kMatterBlock; }

// A press with a value that is not finite has no effect.
shared::SoftPressed askedOf(const SurfacePress& press, const DVec3& before, const GpuSoftPress::Row& row,
                            double duration_s) {
  const DVec3 move = press.handTo_m - press.handFrom_m;
  const shared::SoftPressed asked{.place = press.place_m,
                                  .radius = static_cast<float>(press.radius_m),
                                  .normal = press.normal,
                                  .stiffness = static_cast<float>(press.stiffness_N_m),
                                  .stretch = press.place_m - press.handFrom_m,
                                  .damping = static_cast<float>(press.damping_N_s_m),
                                  .move = move,
                                  .friction = static_cast<float>(press.friction),
                                  .velocity = move / duration_s,
                                  .most = static_cast<float>(press.most_N),
                                  .force = before,
                                  .hand = press.hand,
                                  .row = row.row,
                                  .same = row.isSame ? 1u : 0u};
  const auto words = std::bit_cast<std::array<float, sizeof(asked) / sizeof(float)>>(asked);
  const bool isFinite =
      std::all_of(words.begin(), words.end() - 3, [](float word) { return std::isfinite(word); });  // ints are last
  return isFinite ? asked : shared::SoftPressed{.hand = press.hand, .row = row.row};
}

}  // namespace

GpuSoftPress::Memory::Memory(Device& device, const SoftSizes& sizes, std::uint32_t presses)
    : most(presses),
      asked(Buffer::of<shared::SoftPressed>(device, most, palpate::Memory::upload, "soft presses")),
      count(Buffer::of<std::uint32_t>(device, 1, palpate::Memory::upload, "soft press count")),
      counts(Buffer::of<std::uint32_t>(device, 1 + most, palpate::Memory::device, "soft press counts")),
      held(Buffer::of<shared::SoftHeld>(device, std::uint64_t{most} * sizes.skinNodes, palpate::Memory::device,
                                        "soft held")),
      done(Buffer::of<shared::SoftPressDone>(device, most, palpate::Memory::device, "soft presses done")),
      doneRead(Buffer::of<shared::SoftPressDone>(device, most, palpate::Memory::readback, "soft presses read")) {}

GpuSoftPress::GpuSoftPress(Device& device, const SoftMemory& memory, const SoftSizes& sizes)
    : device_(device),
      body_(memory),
      sizes_(sizes),
      box_(matterPipeline<shared::SoftBoxArgs>(device, shader_code::matter_soft_box)),
      reach_(matterPipeline<shared::SoftReachArgs>(device, shader_code::matter_soft_reach)),
      hold_(matterPipeline<shared::SoftHoldArgs>(device, shader_code::matter_soft_hold)),
      share_(matterPipeline<shared::SoftShareArgs>(device, shader_code::matter_soft_share)),
      couple_(matterPipeline<shared::SoftCoupleArgs>(device, shader_code::matter_soft_couple)),
      press_(matterPipeline<shared::SoftPressArgs>(device, shader_code::matter_soft_press)),
      boxes_(Buffer::of<Vec4>(device, std::uint64_t{shared::kBoxVec4s} * sizes.skinCount, palpate::Memory::device,
                              "soft boxes")),
      blockBoxes_(Buffer::of<Vec4>(device, std::uint64_t{shared::kBoxVec4s} * sizes.nodeBlocks(),
                                   palpate::Memory::device, "soft block boxes")),
      coupling_(Buffer::of<float>(device, std::uint64_t{shared::kMaxPresses} * shared::kMaxPresses,
                                  palpate::Memory::device, "soft coupling")) {}

bool GpuSoftPress::begin(std::span<const SurfacePress> presses, double duration_s) {
  PALPATE_CHECK_LE(presses.size(), std::size_t{shared::kMaxPresses});
  const std::vector<PressReport> before = std::exchange(reports_, std::vector<PressReport>(presses.size()));
  const bool grows = !presses.empty() && (!memory_ || memory_->most < presses.size());
  if (grows) memory_.emplace(device_, sizes_, std::bit_ceil(static_cast<std::uint32_t>(presses.size())));
  if (grows) rows_.clear();
  findRows(presses);
  for (std::size_t i = 0; i < presses.size(); ++i) {
    const bool goesOn = i < before.size() && i < presses_.size() && presses_[i].hand == presses[i].hand;
    memory_->asked.mapped<shared::SoftPressed>()[i] =
        askedOf(presses[i], goesOn ? before[i].force_N : DVec3(0), rows_[i], duration_s);
  }
  if (memory_) memory_->count.mapped<std::uint32_t>()[0] = static_cast<std::uint32_t>(presses.size());
  presses_.assign(presses.begin(), presses.end());
  onPins_ = DVec3(0);
  return grows;
}

// A press that stays at its position keeps its row, and the others take the lowest free ones: no row number exceeds the
// maximum number of presses so far.
void GpuSoftPress::findRows(std::span<const SurfacePress> presses) {
  const std::vector<Row> before = std::exchange(rows_, std::vector<Row>(presses.size()));
  std::array<bool, shared::kMaxPresses> isTaken{};
  for (std::size_t i = 0; i < presses.size(); ++i) {
    const auto old = std::ranges::find(presses_, presses[i].touch, &SurfacePress::touch);
    const auto number = static_cast<std::size_t>(old - presses_.begin());
    if (!presses[i].isSamePlace || number >= before.size() || isTaken[before[number].row]) continue;
    rows_[i] = before[number];
    rows_[i].isSame = true;
    isTaken[rows_[i].row] = true;
  }
  std::uint32_t free = 0;
  for (Row& row : rows_) {
    if (row.isSame) continue;
    while (isTaken[free]) ++free;
    row.row = free++;
  }
}

void GpuSoftPress::forget() {
  presses_.clear();
  rows_.clear();
  reports_.clear();
}

void GpuSoftPress::recordBegin(CommandList& list) const {
  const Memory& memory = *memory_;
  list.copy(memory.count, memory.counts, sizeof(std::uint32_t));
  list.dispatch(box_, sizes_.skinCount,
                shared::SoftBoxArgs{.setting = body_.setting.address(),
                                    .nodes = body_.nodes.address(),
                                    .corners = body_.corners.address(),
                                    .skinCells = body_.skinCells.address(),
                                    .boxes = boxes_.address(),
                                    .skinCount = sizes_.skinCount,
                                    .firstInner = sizes_.firstInner,
                                    .slots = sizes_.slots,
                                    .unused = 0});
  list.dispatch(reach_, workgroups(sizes_.nodeBlocks()),
                shared::SoftReachArgs{.incident = body_.incident.address(),
                                      .boxes = boxes_.address(),
                                      .blockBoxes = blockBoxes_.address(),
                                      .nodeCount = sizes_.nodes,
                                      .stride = sizes_.stride,
                                      .skinCount = sizes_.skinCount,
                                      .unused = 0});
  list.dispatch(hold_, workgroups(memory.most),
                shared::SoftHoldArgs{.presses = memory.asked.address(),
                                     .counts = memory.counts.address(),
                                     .incident = body_.incident.address(),
                                     .boxes = boxes_.address(),
                                     .blockBoxes = blockBoxes_.address(),
                                     .held = memory.held.address(),
                                     .nodeCount = sizes_.nodes,
                                     .stride = sizes_.stride,
                                     .skinCount = sizes_.skinCount,
                                     .blocks = sizes_.nodeBlocks(),
                                     .heldStride = sizes_.skinNodes,
                                     .unused = 0});
  list.dispatch(share_, workgroups(memory.most),
                shared::SoftShareArgs{.setting = body_.setting.address(),
                                      .presses = memory.asked.address(),
                                      .counts = memory.counts.address(),
                                      .incident = body_.incident.address(),
                                      .boxes = boxes_.address(),
                                      .held = memory.held.address(),
                                      .done = memory.done.address(),
                                      .nodes = body_.nodes.address(),
                                      .corners = body_.corners.address(),
                                      .skinCells = body_.skinCells.address(),
                                      .skin = body_.skin.address(),
                                      .normals = body_.skinNormals.address(),
                                      .stride = sizes_.stride,
                                      .skinCount = sizes_.skinCount,
                                      .firstInner = sizes_.firstInner,
                                      .slots = sizes_.slots,
                                      .heldStride = sizes_.skinNodes,
                                      .unused = 0});
  list.dispatch(couple_, workgroups(memory.most),
                shared::SoftCoupleArgs{.presses = memory.asked.address(),
                                       .counts = memory.counts.address(),
                                       .held = memory.held.address(),
                                       .nodes = body_.nodes.address(),
                                       .coupling = coupling_.address(),
                                       .heldStride = sizes_.skinNodes,
                                       .unused = 0});
}

void GpuSoftPress::recordSubstep(CommandList& list, std::uint32_t substep, std::uint32_t substeps) const {
  const auto perStep = static_cast<float>(1.0 / substeps);
  list.dispatch(press_, shared::kMatterBlock,
                shared::SoftPressArgs{.setting = body_.setting.address(),
                                      .presses = memory_->asked.address(),
                                      .counts = memory_->counts.address(),
                                      .held = memory_->held.address(),
                                      .coupling = coupling_.address(),
                                      .done = memory_->done.address(),
                                      .nodes = body_.nodes.address(),
                                      .incident = body_.incident.address(),
                                      .forces = body_.forces.address(),
                                      .stride = sizes_.stride,
                                      .heldStride = sizes_.skinNodes,
                                      .share = static_cast<float>((substep + 1.0) / substeps),
                                      .perStep = perStep});
}

void GpuSoftPress::recordEnd(CommandList& list) const {
  list.copy(memory_->done, memory_->doneRead, memory_->done.bytes());
}

void GpuSoftPress::end() {
  for (std::size_t i = 0; i < reports_.size(); ++i) {
    const shared::SoftPressDone done = memory_->doneRead.mapped<shared::SoftPressDone>()[i];
    if (!rows_[i].isSame) rows_[i].isAlone = done.alone != 0;
    reports_[i] = {.impulse = done.impulse,
                   .force_N = done.force,
                   .work_J = static_cast<double>(done.work),
                   .place_m = presses_[i].place_m + DVec3(done.moved),
                   .isAlone = rows_[i].isAlone};
    onPins_ -= static_cast<double>(done.pinned) * reports_[i].impulse;
  }
}

std::uint64_t GpuSoftPress::bytes() const {
  std::uint64_t sum = boxes_.bytes() + blockBoxes_.bytes() + coupling_.bytes();
  if (!memory_) return sum;
  for (const Buffer* buffer :
       {&memory_->asked, &memory_->count, &memory_->counts, &memory_->held, &memory_->done, &memory_->doneRead})
    sum += buffer->bytes();
  return sum;
}

}  // namespace palpate
