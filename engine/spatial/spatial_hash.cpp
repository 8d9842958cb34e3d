#include "engine/spatial/spatial_hash.hpp"

#include <bit>

#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

Buffer words(Device& device, std::uint64_t count, const char* name) {
  return Buffer::of<std::uint32_t>(device, count, Memory::device, name);
}

std::unique_ptr<PairSort> makePairSort(Device& device, SortMethod sort, std::uint32_t keyBits) {
  if (sort == SortMethod::radix) return std::make_unique<RadixSort>(device, keyBits);
  if (!canLookBack(device))
    throw GpuError(
        "{}: --sort radix-lookback needs a driver on which one workgroup goes on while another waits, which "
        "is not known of this one; take radix or counting",
        device.name());
  if (!LookBackSort::fits(device, keyBits))
    throw GpuError(
        "{}: --sort radix-lookback needs more shared memory than its workgroups have; take radix or counting",
        device.name());
  return std::make_unique<LookBackSort>(device, keyBits);
}

std::uint32_t keyBits(const HashGrid& grid, Slots slots) {
  const std::uint32_t last = slots == Slots::spare ? shared::emptyBucket(grid) : grid.bucketMask;
  return static_cast<std::uint32_t>(std::bit_width(last));
}

SortMethod fallbackFor(const Device& device, SortMethod sort, std::uint32_t keyBits) {
  if (sort != SortMethod::counting) return sort;
  return canLookBack(device) && LookBackSort::fits(device, keyBits) ? SortMethod::radixLookBack : SortMethod::radix;
}

Buffer makeRanges(Device& device, std::uint32_t buckets) {
  return Buffer::of<UVec2>(device, buckets, Memory::device, "hash ranges");
}

}  // namespace

SpatialHash::SpatialHash(Device& device, const HashGrid& grid, std::uint32_t capacity, SortMethod sort,
                         BucketOrder order, Slots slots, Queue* queue)
    : device_(device),
      grid_(grid),
      sort_(sort),
      fallback_(fallbackFor(device, sort_, keyBits(grid, slots))),
      bucketOrder_(order),
      pairSort_(makePairSort(device, fallback_, keyBits(grid, slots))),
      scan_(device),
      keysPass_(device, shader_code::spatial_hash_keys, {.pushBytes = sizeof(shared::HashKeysArgs)}),
      reorderPass_(device, shader_code::spatial_hash_reorder, {.pushBytes = sizeof(shared::HashReorderArgs)}),
      countPass_(device, shader_code::spatial_hash_count, {.pushBytes = sizeof(shared::HashCountArgs)}),
      placePass_(device, shader_code::spatial_hash_place, {.pushBytes = sizeof(shared::HashPlaceArgs)}),
      settlePass_(device, shader_code::spatial_hash_settle, {.pushBytes = sizeof(shared::HashSettleArgs)}),
      scatterPass_(device, shader_code::spatial_hash_scatter, {.pushBytes = sizeof(shared::HashScatterArgs)}),
      keys_(words(device, capacity, "hash keys")),
      order_(words(device, capacity, "hash order")),
      keysAlt_(words(device, capacity, "hash keys alt")),
      orderAlt_(words(device, capacity, "hash order alt")),
      sortScratch_(device, pairSort_->scratchBytes(capacity), Memory::device, "hash sort scratch"),
      counts_(words(device, buckets(), "hash counts")),
      scanScratch_(device, PrefixScan::scratchBytes(buckets()), Memory::device, "hash scan scratch"),
      crowded_(Buffer::of<std::uint32_t>(device, 1, Memory::readback, "hash crowded")),
      ranges_{makeRanges(device, buckets()), makeRanges(device, buckets())} {
  crowded_.mapped<std::uint32_t>()[0] = 0;
  Queue& clears = queue ? *queue : device.touch();
  CommandList clear(device, clears, "clear counts");
  clear.begin();
  clear.fill(counts_, 0, counts_.bytes());
  clear.end();
  clears.run(clear);
}

double SpatialHash::build(LiveCloud& cloud) {
  double time_us = 0;
  for (SortMethod used = sort();; used = fallback_) {
    CommandList list(device_, device_.touch(), "build", CommandList::Timing::sections);
    list.begin();
    recordBuild(list, cloud.side(), cloud.otherSide(), cloud.slots(), used);
    list.end();
    device_.touch().run(list);
    time_us += list.sectionTime_us("hash");
    if (used == sort()) break;  // otherwise a bucket was crowded, and its points may stand in any order
  }
  cloud.flip();
  return time_us;
}

SortMethod SpatialHash::sort() const { return crowded_.mapped<const std::uint32_t>()[0] != 0 ? fallback_ : sort_; }

void SpatialHash::recordBuild(CommandList& list, const LiveCloud::Side& from, const LiveCloud::Side& to,
                              std::uint32_t count, SortMethod sort) const {
  const auto section = list.section("hash");
  if (sort == SortMethod::counting) {
    recordCounted(list, from, to, count);
  } else {
    PALPATE_CHECK(sort == fallback_);
    recordSorted(list, from, to, count);
  }
}

void SpatialHash::recordSorted(CommandList& list, const LiveCloud::Side& from, const LiveCloud::Side& to,
                               std::uint32_t count) const {
  {
    const auto overlap = list.independent();
    list.fill(ranges(to), 0, ranges(to).bytes());
    list.dispatch(keysPass_, count,
                  shared::HashKeysArgs{.positions = from.positions.address(),
                                       .keys = keys_.address(),
                                       .order = order_.address(),
                                       .grid = grid_,
                                       .count = count,
                                       .unused = 0});
  }
  const auto sorted = pairSort_->record(list,
                                        {.keys = keys_.address(),
                                         .values = order_.address(),
                                         .keysAlt = keysAlt_.address(),
                                         .valuesAlt = orderAlt_.address(),
                                         .scratch = sortScratch_},
                                        count);
  list.dispatch(reorderPass_, count,
                shared::HashReorderArgs{.sortedKeys = sorted.keys,
                                        .sortedOrder = sorted.values,
                                        .positionsIn = from.positions.address(),
                                        .normalsIn = from.normals.address(),
                                        .positionsOut = to.positions.address(),
                                        .normalsOut = to.normals.address(),
                                        .ranges = ranges(to).address(),
                                        .count = count,
                                        .unused = 0});
}

void SpatialHash::recordCounted(CommandList& list, const LiveCloud::Side& from, const LiveCloud::Side& to,
                                std::uint32_t count) const {
  const Buffer& arrivals = keysAlt_;
  list.dispatch(countPass_, count,
                shared::HashCountArgs{.positions = from.positions.address(),
                                      .keys = keys_.address(),
                                      .arrivals = arrivals.address(),
                                      .counts = counts_.address(),
                                      .grid = grid_,
                                      .count = count,
                                      .unused = 0});
  scan_.recordRanges(list, {counts_.address(), scanScratch_.address()}, ranges(to).address(), buckets());
  if (bucketOrder_ == BucketOrder::arrival) {
    list.dispatch(scatterPass_, count,
                  shared::HashScatterArgs{.keys = keys_.address(),
                                          .arrivals = arrivals.address(),
                                          .ranges = ranges(to).address(),
                                          .positionsIn = from.positions.address(),
                                          .normalsIn = from.normals.address(),
                                          .positionsOut = to.positions.address(),
                                          .normalsOut = to.normals.address(),
                                          .count = count,
                                          .unused = 0});
    return;
  }
  list.dispatch(placePass_, count,
                shared::HashPlaceArgs{.keys = keys_.address(),
                                      .arrivals = arrivals.address(),
                                      .ranges = ranges(to).address(),
                                      .order = order_.address(),
                                      .count = count,
                                      .unused = 0});
  list.dispatch(settlePass_, count,
                shared::HashSettleArgs{.keys = keys_.address(),
                                       .order = order_.address(),
                                       .ranges = ranges(to).address(),
                                       .positionsIn = from.positions.address(),
                                       .normalsIn = from.normals.address(),
                                       .positionsOut = to.positions.address(),
                                       .normalsOut = to.normals.address(),
                                       .crowded = crowded_.address(),
                                       .count = count,
                                       .emptyBucket = shared::emptyBucket(grid_)});
}

shared::CloudView SpatialHash::view(const LiveCloud::Side& side, std::uint32_t slots) const {
  return {.positions = side.positions.address(),
          .normals = side.normals.address(),
          .ranges = ranges(side).address(),
          .grid = grid_,
          .slots = slots,
          .unused = 0};
}

std::uint64_t SpatialHash::bytes() const {
  return keys_.bytes() + order_.bytes() + keysAlt_.bytes() + orderAlt_.bytes() + sortScratch_.bytes() +
         counts_.bytes() + scanScratch_.bytes() + 2 * ranges_[0].bytes() + crowded_.bytes();
}

std::uint64_t SpatialHash::predictedBytes(std::uint64_t points, std::uint64_t slots) {
  constexpr std::uint32_t kUsualWorkgroup = 256;
  const std::uint64_t buckets = std::uint64_t{makeHashGrid(Vec3(0), 1, points).bucketMask} + 1;
  return 4 * sizeof(std::uint32_t) * slots + RadixSort::scratchBytes(slots, kUsualWorkgroup) +
         buckets * (2 * sizeof(UVec2) + sizeof(std::uint32_t)) + PrefixScan::scratchBytes(buckets);
}

}  // namespace palpate
