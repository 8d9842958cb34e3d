#include "engine/spatial/spatial_hash.hpp"

#include <bit>

#include "engine/core/check.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/spatial/look_back_sort.hpp"
#include "engine/spatial/radix_sort.hpp"

namespace palpate {

namespace {

std::uint32_t keyBits(const HashGrid& grid, Slots slots) {
  const std::uint32_t last = slots == Slots::spare ? shared::emptyBucket(grid) : grid.bucketMask;
  return static_cast<std::uint32_t>(std::bit_width(last));
}

SortMethod fallbackFor(const Device& device, SortMethod sort, std::uint32_t keyBits) {
  if (sort != SortMethod::counting) return sort;
  return prefersLookBack(device) && LookBackSort::fits(device, keyBits) ? SortMethod::radixLookBack : SortMethod::radix;
}

// Fewer points are counted as fast as they are sorted (apps/bench/results/build.json: builds in file order).
constexpr std::size_t kFewestSorted = 2'000'000;

Buffer makeRanges(Device& device, std::uint32_t buckets) {
  return Buffer::of<UVec2>(device, buckets, Memory::device, "hash ranges");
}

}  // namespace

SortMethod sortInOrder(const Device& device, const HashGrid& grid, std::span<const Vec3> positions, Slots slots) {
  const SortMethod sorting = fallbackFor(device, kDefaultSort, keyBits(grid, slots));
  const bool pays = sorting == SortMethod::radixLookBack && positions.size() >= kFewestSorted;
  return pays && isScattered(grid, positions) ? sorting : kDefaultSort;
}

HashBuildScratch::HashBuildScratch(Device& device, std::uint32_t slots)
    : keys(deviceWords(device, slots, "hash keys")),
      order(deviceWords(device, slots, "hash order")),
      keysAlt(deviceWords(device, slots, "hash keys alt")),
      orderAlt(deviceWords(device, slots, "hash order alt")) {}

SpatialHash::SpatialHash(Device& device, const HashGrid& grid, std::uint32_t capacity, SortMethod sort,
                         BucketOrder order, Slots slots, Queue* queue)
    : device_(device),
      grid_(grid),
      sort_(sort),
      fallback_(fallbackFor(device, sort_, keyBits(grid, slots))),
      scratch_(device, capacity),
      sorting_(device, fallback_, keyBits(grid, slots), capacity),
      counting_(device, buckets(), order, queue ? *queue : device.latencyQueue()),
      ranges_{makeRanges(device, buckets()), makeRanges(device, buckets())} {}

double SpatialHash::build(LiveCloud& cloud) {
  double time_us = 0;
  for (SortMethod used = sort();; used = fallback_) {
    CommandList list(device_, device_.latencyQueue(), "build", CommandList::Timing::sections);
    list.begin();
    recordBuild(list, cloud.front(), cloud.back(), cloud.slots(), used);
    list.end();
    device_.latencyQueue().run(list);
    time_us += list.sectionTime_us("hash");
    if (used == sort()) break;  // otherwise a bucket was crowded, and its points may be in any order
  }
  cloud.flip();
  return time_us;
}

void SpatialHash::recordBuild(CommandList& list, const LiveCloud::Half& from, const LiveCloud::Half& to,
                              std::uint32_t count, SortMethod sort) const {
  const auto section = list.section("hash");
  const HashBuild build{.from = from, .to = to, .ranges = ranges(to), .count = count};
  if (sort == SortMethod::counting) {
    counting_.record(list, grid_, scratch_, build);
  } else {
    PALPATE_CHECK(sort == fallback_);
    sorting_.record(list, grid_, scratch_, build);
  }
}

shared::CloudView SpatialHash::view(const LiveCloud::Half& half, std::uint32_t slots) const {
  return {.positions = half.positions.address(),
          .normals = half.normals.address(),
          .ranges = ranges(half).address(),
          .grid = grid_,
          .slots = slots,
          .unused = 0};
}

std::uint64_t SpatialHash::bytes() const {
  return scratch_.bytes() + sorting_.bytes() + counting_.bytes() + 2 * ranges_[0].bytes();
}

std::uint64_t SpatialHash::predictedBytes(std::uint64_t points, std::uint64_t slots) {
  constexpr std::uint32_t kUsualWorkgroup = 256;
  const std::uint64_t buckets = std::uint64_t{makeHashGrid(Vec3(0), 1, points).bucketMask} + 1;
  return 4 * sizeof(std::uint32_t) * slots + RadixSort::scratchBytes(slots, kUsualWorkgroup) +
         buckets * (2 * sizeof(UVec2) + sizeof(std::uint32_t)) + PrefixScan::scratchBytes(buckets);
}

}  // namespace palpate
