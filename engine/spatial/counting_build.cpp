#include "engine/spatial/counting_build.hpp"

#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"
#include "shaders/compiled.hpp"
#include "shaders/shared/spatial_hash.h"

namespace palpate {

CountingBuild::CountingBuild(Device& device, std::uint32_t buckets, BucketOrder order, Queue& queue)
    : buckets_(buckets),
      order_(order),
      scan_(device),
      countPass_(device, shader_code::spatial_hash_count, {.pushBytes = sizeof(shared::HashCountArgs)}),
      placePass_(device, shader_code::spatial_hash_place, {.pushBytes = sizeof(shared::HashPlaceArgs)}),
      settlePass_(device, shader_code::spatial_hash_settle, {.pushBytes = sizeof(shared::HashSettleArgs)}),
      scatterPass_(device, shader_code::spatial_hash_scatter, {.pushBytes = sizeof(shared::HashScatterArgs)}),
      counts_(Buffer::of<std::uint32_t>(device, buckets, Memory::device, "hash counts")),
      scanScratch_(device, PrefixScan::scratchBytes(buckets), Memory::device, "hash scan scratch"),
      crowded_(Buffer::of<std::uint32_t>(device, 1, Memory::readback, "hash crowded")) {
  crowded_.mapped<std::uint32_t>()[0] = 0;
  CommandList clear(device, queue, "clear counts");
  clear.begin();
  clear.fill(counts_, 0, counts_.bytes());
  clear.end();
  queue.run(clear);
}

void CountingBuild::record(CommandList& list, const HashGrid& grid, const HashBuildScratch& scratch,
                           const HashBuild& build) const {
  const auto& [from, to, ranges, count] = build;
  const Buffer& arrivals = scratch.keysAlt;
  list.dispatch(countPass_, count,
                shared::HashCountArgs{.positions = from.positions.address(),
                                      .keys = scratch.keys.address(),
                                      .arrivals = arrivals.address(),
                                      .counts = counts_.address(),
                                      .grid = grid,
                                      .count = count,
                                      .unused = 0});
  scan_.record(list, {counts_.address(), scanScratch_.address()}, ranges.address(), buckets_);
  if (order_ == BucketOrder::arrival) {
    list.dispatch(scatterPass_, count,
                  shared::HashScatterArgs{.keys = scratch.keys.address(),
                                          .arrivals = arrivals.address(),
                                          .ranges = ranges.address(),
                                          .positionsIn = from.positions.address(),
                                          .normalsIn = from.normals.address(),
                                          .positionsOut = to.positions.address(),
                                          .normalsOut = to.normals.address(),
                                          .count = count,
                                          .unused = 0});
    return;
  }
  list.dispatch(placePass_, count,
                shared::HashPlaceArgs{.keys = scratch.keys.address(),
                                      .arrivals = arrivals.address(),
                                      .ranges = ranges.address(),
                                      .order = scratch.order.address(),
                                      .count = count,
                                      .unused = 0});
  list.dispatch(settlePass_, count,
                shared::HashSettleArgs{.keys = scratch.keys.address(),
                                       .order = scratch.order.address(),
                                       .ranges = ranges.address(),
                                       .positionsIn = from.positions.address(),
                                       .normalsIn = from.normals.address(),
                                       .positionsOut = to.positions.address(),
                                       .normalsOut = to.normals.address(),
                                       .crowded = crowded_.address(),
                                       .count = count,
                                       .emptyBucket = shared::emptyBucket(grid)});
}

}  // namespace palpate
