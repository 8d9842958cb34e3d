#include "engine/matter/matter_memory.hpp"

#include "shaders/shared/matter_passes.h"
#include "shaders/shared/prefix_scan.h"

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

}  // namespace palpate
