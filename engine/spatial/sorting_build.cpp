#include "engine/spatial/sorting_build.hpp"

#include "engine/gpu/device.hpp"
#include "engine/spatial/look_back_sort.hpp"
#include "engine/spatial/radix_sort.hpp"
#include "shaders/compiled.hpp"
#include "shaders/shared/spatial_hash.h"

namespace palpate {

namespace {

std::unique_ptr<PairSort> makePairSort(Device& device, SortMethod sort, std::uint32_t keyBits) {
  if (sort == SortMethod::radix) return std::make_unique<RadixSort>(device, keyBits);
  if (!LookBackSort::fits(device, keyBits))
    throw GpuError(
        "{}: the sort radix-lookback needs more shared memory than its workgroups have; use radix or counting",
        device.name());
  return std::make_unique<LookBackSort>(device, keyBits);
}

}  // namespace

SortingBuild::SortingBuild(Device& device, SortMethod sort, std::uint32_t keyBits, std::uint32_t slots)
    : sort_(makePairSort(device, sort, keyBits)),
      keysPass_(device, shader_code::spatial_hash_keys, {.pushBytes = sizeof(shared::HashKeysArgs)}),
      reorderPass_(device, shader_code::spatial_hash_reorder, {.pushBytes = sizeof(shared::HashReorderArgs)}),
      sortScratch_(device, sort_->scratchBytes(slots), Memory::device, "hash sort scratch") {}

void SortingBuild::record(CommandList& list, const HashGrid& grid, const HashBuildScratch& scratch,
                          const HashBuild& build) const {
  {
    const auto overlap = list.independent();
    list.fill(build.ranges, 0, build.ranges.bytes());
    list.dispatch(keysPass_, build.count,
                  shared::HashKeysArgs{.positions = build.from.positions.address(),
                                       .keys = scratch.keys.address(),
                                       .order = scratch.order.address(),
                                       .grid = grid,
                                       .count = build.count,
                                       .unused = 0});
  }
  const auto sorted = sort_->record(list,
                                    {.keys = scratch.keys.address(),
                                     .values = scratch.order.address(),
                                     .keysAlt = scratch.keysAlt.address(),
                                     .valuesAlt = scratch.orderAlt.address(),
                                     .scratch = sortScratch_},
                                    build.count);
  list.dispatch(reorderPass_, build.count,
                shared::HashReorderArgs{.sortedKeys = sorted.keys,
                                        .sortedOrder = sorted.values,
                                        .positionsIn = build.from.positions.address(),
                                        .normalsIn = build.from.normals.address(),
                                        .positionsOut = build.to.positions.address(),
                                        .normalsOut = build.to.normals.address(),
                                        .ranges = build.ranges.address(),
                                        .count = build.count,
                                        .unused = 0});
}

}  // namespace palpate
