#include "engine/matter/matter_passes.hpp"

#include <algorithm>

#include "engine/matter/matter_pipeline.hpp"
#include "shaders/shared/matter_passes.h"
#include "shaders/shared/prefix_scan.h"
#include "shaders/simulation.hpp"

namespace palpate {

namespace {

template <class T>
Buffer matterBuffer(Device& device, std::uint64_t count, const char* name) {
  return Buffer::of<T>(device, count, Memory::device, std::string("matter ") + name);
}

std::uint64_t stateBytes(const MatterSizes& sizes) {
  return MatterMemory::kTools + sizes.tools * sizeof(shared::ToolState);
}

// Rows of the totals, of each tool, and of the model.
std::uint64_t rowsOfSums(const MatterSizes& sizes) {
  return std::uint64_t{2} + 2 * sizes.tools + (sizes.modelNodes > 0 ? 2 : 0);
}

std::uint64_t contactsOf(const MatterSizes& sizes) {
  return sizes.remembers ? std::uint64_t{2} * sizes.particles * shared::kMaxContacts : 0;
}

DeviceAddress control(const MatterMemory& memory) { return memory.state.address() + MatterMemory::kControl; }
DeviceAddress tools(const MatterMemory& memory) { return memory.state.address() + MatterMemory::kTools; }

// Number of invocations of the prediction, which together also clear all cells.
std::uint32_t threadsOf(const MatterSizes& sizes) {
  const std::uint32_t most = std::max({sizes.particles, sizes.cells / shared::kEmptiedAtOnce + 1, sizes.tools});
  return (most + shared::kMatterBlock - 1) / shared::kMatterBlock * shared::kMatterBlock;
}

}  // namespace

std::uint32_t MatterSizes::stride() const { return blocks * shared::kMatterBlock; }
std::uint32_t MatterSizes::tiles() const { return cells / shared::kScanTile + 1; }

MatterMemory::MatterMemory(Device& device, const MatterSizes& sizes)
    : setting(Buffer::of<shared::MatterSetting>(device, 1, Memory::upload, "matter setting")),
      hands(Buffer::of<shared::HandStep>(device, std::uint64_t{kMaxSubsteps} * sizes.tools, Memory::upload,
                                         "matter hands")),
      state(device, stateBytes(sizes), Memory::device, "matter state"),
      stateRead(device, stateBytes(sizes), Memory::readback, "matter state read"),
      particles{.places = matterBuffer<Vec4>(device, sizes.particles, "places"),
                .positions = matterBuffer<Vec4>(device, sizes.particles, "positions"),
                .velocities = matterBuffer<Vec4>(device, std::uint64_t{2} * sizes.particles, "velocities"),
                .ids = matterBuffer<std::uint32_t>(device, sizes.particles, "ids")},
      sorted{.places = matterBuffer<Vec4>(device, sizes.particles, "sorted places"),
             .positions = matterBuffer<Vec4>(device, sizes.particles, "sorted positions"),
             .velocities = matterBuffer<Vec4>(device, sizes.particles, "sorted velocities"),
             .ids = matterBuffer<std::uint32_t>(device, sizes.particles, "sorted ids")},
      pressed(matterBuffer<Vec4>(device, sizes.particles, "pressed places")),
      lists(matterBuffer<std::uint32_t>(device, std::uint64_t{sizes.mostListed} * sizes.stride(), "lists")),
      listLengths(matterBuffer<std::uint32_t>(device, sizes.particles, "list lengths")),
      sort{.firsts = matterBuffer<std::uint32_t>(device, std::uint64_t{sizes.cells} + 1, "firsts"),
           .tileSums = matterBuffer<std::uint32_t>(device, sizes.tiles(), "tile sums"),
           .cells = matterBuffer<std::uint32_t>(device, sizes.particles, "cells"),
           .arrivals = matterBuffer<std::uint32_t>(device, sizes.particles, "arrivals"),
           .order = matterBuffer<std::uint32_t>(device, sizes.particles, "order")},
      sums(matterBuffer<Vec4>(device, rowsOfSums(sizes) * sizes.blocks, "sums")),
      bodyPoints(matterBuffer<Vec4>(device, std::uint64_t{sizes.bodyPoints} + sizes.modelNodes, "body points")),
      bodyFirsts(matterBuffer<std::uint32_t>(device, std::uint64_t{sizes.bodyCells} + 1, "body firsts")),
      contacts(matterBuffer<glm::uvec4>(device, contactsOf(sizes), "contacts")),
      contactCounts(matterBuffer<std::uint32_t>(device, sizes.remembers ? std::uint64_t{2} * sizes.particles : 0,
                                                "contact counts")) {
  static_assert(sizeof(shared::MatterControl) == kSums && kSums + sizeof(shared::MatterSums) == kTools);
}

std::uint64_t MatterMemory::bytes() const {
  std::uint64_t sum = 0;
  for (const Buffer* buffer : {&setting,
                               &hands,
                               &state,
                               &stateRead,
                               &particles.places,
                               &particles.positions,
                               &particles.velocities,
                               &particles.ids,
                               &sorted.places,
                               &sorted.positions,
                               &sorted.velocities,
                               &sorted.ids,
                               &pressed,
                               &lists,
                               &listLengths,
                               &sort.firsts,
                               &sort.tileSums,
                               &sort.cells,
                               &sort.arrivals,
                               &sort.order,
                               &sums,
                               &bodyPoints,
                               &bodyFirsts,
                               &contacts,
                               &contactCounts})
    sum += buffer->bytes();
  return sum;
}

MatterPasses::MatterPasses(Device& device, Matter matter)
    : matter_(matter),
      predict_(matterPipeline<shared::MatterPredictArgs>(device, shader_code::matter_predict)),
      count_(matterPipeline<shared::MatterCountArgs>(device, shader_code::matter_count)),
      scanReduce_(matterPipeline<shared::MatterScanArgs>(device, shader_code::matter_scan_reduce)),
      scan_(matterPipeline<shared::MatterScanArgs>(device, shader_code::matter_scan)),
      place_(matterPipeline<shared::MatterPlaceArgs>(device, shader_code::matter_place)),
      sort_(matterPipeline<shared::MatterSortArgs>(device, shader_code::matter_sort)),
      list_(matterPipeline<shared::MatterListArgs>(device, shader_code::matter_list)),
      compress_(matterPipeline<shared::MatterCompressArgs>(device, shader_code::matter_compress)),
      push_(matterPipeline<shared::MatterPushArgs>(device, shader_code::matter_push)),
      rub_(matterPipeline<shared::MatterRubArgs>(device, shader_code::matter_rub)),
      finish_(matterPipeline<shared::MatterFinishArgs>(device, shader_code::matter_finish)) {
  static_assert(shared::kMatterBlock == shared::kScanWorkgroup);
}

void MatterPasses::record(CommandList& list, const MatterMemory& memory, const MatterSizes& sizes,
                          std::uint32_t substep, std::uint32_t listsFor) const {
  recordPrediction(list, memory, sizes, substep, std::max(listsFor, 1u) - 1);
  if (sizes.particles > 0) {
    if (listsFor > 0) {
      recordSort(list, memory, sizes);
      recordLists(list, memory, sizes);
    }
    matter_ == Matter::sand ? recordSand(list, memory, sizes) : recordWater(list, memory, sizes);
  }
  recordFinish(list, memory, sizes, substep, listsFor > 0);
}

void MatterPasses::recordPrediction(CommandList& list, const MatterMemory& memory, const MatterSizes& sizes,
                                    std::uint32_t substep, std::uint32_t ahead) const {
  const std::uint32_t threads = threadsOf(sizes);
  list.dispatch(predict_, threads,
                shared::MatterPredictArgs{.control = control(memory),
                                          .setting = memory.setting.address(),
                                          .positions = memory.particles.positions.address(),
                                          .velocities = memory.particles.velocities.address(),
                                          .listedAt = memory.sorted.places.address(),
                                          .places = memory.particles.places.address(),
                                          .firsts = memory.sort.firsts.address(),
                                          .hands = memory.hands.address(),
                                          .tools = tools(memory),
                                          .bodyPoints = memory.bodyPoints.address(),
                                          .particles = sizes.particles,
                                          .counts = sizes.cells + 1,
                                          .threads = threads,
                                          .toolCount = sizes.tools,
                                          .substep = substep,
                                          .ahead = ahead});
}

void MatterPasses::recordSort(CommandList& list, const MatterMemory& memory, const MatterSizes& sizes) const {
  const MatterMemory::Sort& sort = memory.sort;
  list.dispatch(count_, sizes.particles,
                shared::MatterCountArgs{.control = control(memory),
                                        .setting = memory.setting.address(),
                                        .places = memory.particles.places.address(),
                                        .firsts = sort.firsts.address(),
                                        .cells = sort.cells.address(),
                                        .arrivals = sort.arrivals.address(),
                                        .particles = sizes.particles,
                                        .unused = 0});
  const shared::MatterScanArgs scan{.control = control(memory),
                                    .setting = memory.setting.address(),
                                    .firsts = sort.firsts.address(),
                                    .tileSums = sort.tileSums.address(),
                                    .counts = sizes.cells + 1,
                                    .tiles = sizes.tiles()};
  const std::uint64_t threads = std::uint64_t{scan.tiles} * shared::kScanWorkgroup;
  if (scan.tiles > 1) list.dispatch(scanReduce_, threads, scan);
  list.dispatch(scan_, threads, scan);
  list.dispatch(place_, sizes.particles,
                shared::MatterPlaceArgs{.control = control(memory),
                                        .setting = memory.setting.address(),
                                        .firsts = sort.firsts.address(),
                                        .cells = sort.cells.address(),
                                        .arrivals = sort.arrivals.address(),
                                        .order = sort.order.address(),
                                        .particles = sizes.particles,
                                        .unused = 0});
  list.dispatch(sort_, sizes.particles,
                shared::MatterSortArgs{.control = control(memory),
                                       .setting = memory.setting.address(),
                                       .firsts = sort.firsts.address(),
                                       .cells = sort.cells.address(),
                                       .order = sort.order.address(),
                                       .places = memory.particles.places.address(),
                                       .positions = memory.particles.positions.address(),
                                       .velocities = memory.particles.velocities.address(),
                                       .ids = memory.particles.ids.address(),
                                       .sortedPlaces = memory.sorted.places.address(),
                                       .sortedPositions = memory.sorted.positions.address(),
                                       .sortedVelocities = memory.sorted.velocities.address(),
                                       .sortedIds = memory.sorted.ids.address(),
                                       .particles = sizes.particles,
                                       .unused = 0});
}

void MatterPasses::recordLists(CommandList& list, const MatterMemory& memory, const MatterSizes& sizes) const {
  list.dispatch(list_, sizes.particles,
                shared::MatterListArgs{.control = control(memory),
                                       .setting = memory.setting.address(),
                                       .firsts = memory.sort.firsts.address(),
                                       .sortedPlaces = memory.sorted.places.address(),
                                       .sortedPositions = memory.sorted.positions.address(),
                                       .sortedVelocities = memory.sorted.velocities.address(),
                                       .sortedIds = memory.sorted.ids.address(),
                                       .places = memory.particles.places.address(),
                                       .positions = memory.particles.positions.address(),
                                       .velocities = memory.particles.velocities.address(),
                                       .ids = memory.particles.ids.address(),
                                       .lists = memory.lists.address(),
                                       .listLengths = memory.listLengths.address(),
                                       .particles = sizes.particles,
                                       .stride = sizes.stride()});
}

void MatterPasses::recordWater(CommandList& list, const MatterMemory& memory, const MatterSizes& sizes) const {
  list.dispatch(compress_, sizes.particles,
                shared::MatterCompressArgs{.control = control(memory),
                                           .setting = memory.setting.address(),
                                           .places = memory.particles.places.address(),
                                           .lists = memory.lists.address(),
                                           .listLengths = memory.listLengths.address(),
                                           .pressed = memory.pressed.address(),
                                           .tools = tools(memory),
                                           .bodyPoints = memory.bodyPoints.address(),
                                           .bodyFirsts = memory.bodyFirsts.address(),
                                           .particles = sizes.particles,
                                           .stride = sizes.stride(),
                                           .toolCount = sizes.tools,
                                           .unused = 0});
  list.dispatch(push_, sizes.particles,
                shared::MatterPushArgs{.control = control(memory),
                                       .setting = memory.setting.address(),
                                       .pressed = memory.pressed.address(),
                                       .positions = memory.particles.positions.address(),
                                       .velocities = memory.particles.velocities.address(),
                                       .lists = memory.lists.address(),
                                       .listLengths = memory.listLengths.address(),
                                       .sums = memory.sums.address(),
                                       .tools = tools(memory),
                                       .bodyPoints = memory.bodyPoints.address(),
                                       .bodyFirsts = memory.bodyFirsts.address(),
                                       .particles = sizes.particles,
                                       .stride = sizes.stride(),
                                       .toolCount = sizes.tools,
                                       .blocks = sizes.blocks});
}

void MatterPasses::recordSand(CommandList& list, const MatterMemory& memory, const MatterSizes& sizes) const {
  list.dispatch(rub_, sizes.particles,
                shared::MatterRubArgs{.control = control(memory),
                                      .setting = memory.setting.address(),
                                      .places = memory.particles.places.address(),
                                      .positions = memory.particles.positions.address(),
                                      .velocities = memory.particles.velocities.address(),
                                      .ids = memory.particles.ids.address(),
                                      .lists = memory.lists.address(),
                                      .listLengths = memory.listLengths.address(),
                                      .contacts = memory.contacts.address(),
                                      .contactCounts = memory.contactCounts.address(),
                                      .sums = memory.sums.address(),
                                      .tools = tools(memory),
                                      .bodyPoints = memory.bodyPoints.address(),
                                      .bodyFirsts = memory.bodyFirsts.address(),
                                      .particles = sizes.particles,
                                      .stride = sizes.stride(),
                                      .toolCount = sizes.tools,
                                      .blocks = sizes.blocks});
}

void MatterPasses::recordFinish(CommandList& list, const MatterMemory& memory, const MatterSizes& sizes,
                                std::uint32_t substep, bool makesLists) const {
  list.dispatch(finish_, shared::kMatterBlock,
                shared::MatterFinishArgs{.control = control(memory),
                                         .setting = memory.setting.address(),
                                         .sums = memory.sums.address(),
                                         .total = memory.state.address() + MatterMemory::kSums,
                                         .tools = tools(memory),
                                         .blocks = sizes.blocks,
                                         .toolCount = sizes.tools,
                                         .substep = substep,
                                         .makesLists = makesLists});
}

}  // namespace palpate
