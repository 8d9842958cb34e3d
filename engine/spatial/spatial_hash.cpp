#include "engine/spatial/spatial_hash.hpp"

#include "shaders/compiled.hpp"

namespace palpate {

namespace {

Buffer words(Device& device, std::uint64_t count, const char* name) {
  return Buffer::of<std::uint32_t>(device, count, Memory::device, name);
}

}  // namespace

SpatialHash::SpatialHash(Device& device, const HashGrid& grid, std::uint32_t capacity)
    : grid_(grid),
      sort_(device),
      keysPass_(device, shader_code::spatial_hash_keys, {.pushBytes = sizeof(shared::HashKeysArgs)}),
      reorderPass_(device, shader_code::spatial_hash_reorder, {.pushBytes = sizeof(shared::HashReorderArgs)}),
      keys_(words(device, capacity, "hash keys")),
      order_(words(device, capacity, "hash order")),
      keysAlt_(words(device, capacity, "hash keys alt")),
      orderAlt_(words(device, capacity, "hash order alt")),
      scratch_(device, sort_.scratchBytes(capacity), Memory::device, "hash sort scratch"),
      ranges_(Buffer::of<UVec2>(device, std::uint64_t{grid.bucketMask} + 1, Memory::device, "hash ranges")) {}

void SpatialHash::recordBuild(CommandList& list, const LiveCloud::Side& from, const LiveCloud::Side& to,
                              std::uint32_t count) const {
  const auto section = list.section("hash");
  {
    const auto overlap = list.independent();
    list.fill(ranges_, 0, ranges_.bytes());
    list.dispatch(keysPass_, count,
                  shared::HashKeysArgs{.positions = from.positions.address(),
                                       .keys = keys_.address(),
                                       .order = order_.address(),
                                       .grid = grid_,
                                       .count = count,
                                       .unused = 0});
  }
  const auto sorted = sort_.record(list,
                                   {.keys = keys_.address(),
                                    .values = order_.address(),
                                    .keysAlt = keysAlt_.address(),
                                    .valuesAlt = orderAlt_.address(),
                                    .scratch = scratch_.address()},
                                   count, bucketBits(grid_));
  list.dispatch(reorderPass_, count,
                shared::HashReorderArgs{.sortedKeys = sorted.keys,
                                        .sortedOrder = sorted.values,
                                        .positionsIn = from.positions.address(),
                                        .normalsIn = from.normals.address(),
                                        .positionsOut = to.positions.address(),
                                        .normalsOut = to.normals.address(),
                                        .ranges = ranges_.address(),
                                        .count = count,
                                        .unused = 0});
}

shared::CloudView SpatialHash::view(const LiveCloud::Side& side, std::uint32_t count) const {
  return {.positions = side.positions.address(),
          .normals = side.normals.address(),
          .ranges = ranges_.address(),
          .grid = grid_,
          .count = count,
          .unused = 0};
}

std::uint64_t SpatialHash::bytes() const {
  return keys_.bytes() + order_.bytes() + keysAlt_.bytes() + orderAlt_.bytes() + scratch_.bytes() + ranges_.bytes();
}

std::uint64_t SpatialHash::predictedBytes(std::uint64_t points) {
  constexpr std::uint32_t kUsualWorkgroup = 256;
  const std::uint64_t buckets = std::uint64_t{makeHashGrid(Vec3(0), 1, points).bucketMask} + 1;
  return 4 * sizeof(std::uint32_t) * points + RadixSort::scratchBytes(points, kUsualWorkgroup) +
         buckets * sizeof(UVec2);
}

}  // namespace palpate
