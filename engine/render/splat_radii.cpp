#include "engine/render/splat_radii.hpp"

#include <algorithm>
#include <bit>

#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

constexpr double kWidestShare = 0.1;  // of the box: a wider disc hides a small model

double widestBorder(const Bounds& bounds, double spacing) {
  const double side = bounds.longestSide();
  const double widest = static_cast<double>(shared::kSplatWidest) * spacing;
  return side > 0 ? std::min(widest, kWidestShare * side) : widest;
}

}  // namespace

SplatRadii::SplatRadii(Device& device, const Bounds& bounds, std::uint32_t places, double spacing)
    : device_(device),
      places_(places),
      spacing_(spacing),
      widest_(widestBorder(bounds, spacing)),
      hash_(device, makeHashGrid(Vec3(bounds.min), static_cast<double>(shared::kSplatFirstSearch) * spacing, places),
            places, kDefaultSort, BucketOrder::stable, Slots::spare, &device.throughputQueue()),
      ordered_{Buffer::of<Vec4>(device, places, Memory::device, "hashed positions"),
               Buffer::of<Vec4>(device, places, Memory::device, "hashed normals"), 0},
      pass_(device, shader_code::render_splat_radius, {.pushBytes = sizeof(shared::SplatRadiusArgs)}),
      changedPass_(device, shader_code::render_splat_changed, {.pushBytes = sizeof(shared::SplatChangedArgs)}),
      reaches_(Buffer::of<std::uint32_t>(device, places, Memory::device, "splat reaches")),
      changed_(Buffer::of<std::uint32_t>(device, (std::uint64_t{hash_.grid().bucketMask} + 32) / 32, Memory::device,
                                         "changed buckets")),
      largest_(Buffer::of<std::uint32_t>(device, 1, Memory::device, "largest splat")),
      largestRead_(Buffer::of<std::uint32_t>(device, 1, Memory::readback, "read largest splat")),
      list_(Buffer::of<std::uint32_t>(device, places, Memory::device, "changed splats")),
      listed_(Buffer::of<shared::ChangedSplats>(device, 1, Memory::device, "number of changed splats")) {
  largestRead_.mapped<std::uint32_t>()[0] = 0;
  CommandList clear(device, device.throughputQueue(), "clear changed buckets");
  clear.begin();
  clear.fill(reaches_, 0, reaches_.bytes());
  clear.fill(changed_, 0, changed_.bytes());
  clear.fill(largest_, 0, largest_.bytes());
  clear.end();
  device.throughputQueue().run(clear);
}

void SplatRadii::run(const LiveCloud::Half& points, const Buffer& clips, bool onlyChanged) {
  const shared::SplatChangedArgs changedArgs{
      .cloud = hash_.view(ordered_, places_),
      .reaches = reaches_.address(),
      .changed = changed_.address(),
      .list = list_.address(),
      .counts = listed_.address(),
      .splatsPerGroup = shared::kSplatRadiusTurns * pass_.workgroupSize() / device_.subgroupSize(),
      .unused = 0};
  shared::SplatRadiusArgs args{.cloud = hash_.view(ordered_, places_),
                               .normals = points.normals.address(),
                               .clips = clips.address(),
                               .reaches = reaches_.address(),
                               .list = list_.address(),
                               .counts = listed_.address(),
                               .largest = largest_.address(),
                               .spacing = static_cast<float>(spacing_),
                               .widest = static_cast<float>(widest_),
                               .onlyListed = onlyChanged ? 1u : 0u,
                               .turn = 0};
  CommandList list(device_, device_.throughputQueue(), "splat radii");
  SortMethod sort;
  do {  // again where a bucket was crowded, and its points may have stood in any order
    sort = hash_.sort();
    list.begin();
    hash_.recordBuild(list, points, ordered_, places_, sort);
    if (onlyChanged) {
      list.fill(listed_, 0, listed_.bytes());
      list.fill(listed_, 1, sizeof(std::uint32_t), offsetof(shared::ChangedSplats, groups.z));
      list.dispatch(changedPass_, places_, changedArgs);
      for (args.turn = 0; args.turn < shared::kSplatRadiusTurns; ++args.turn)
        list.dispatchIndirect(pass_, listed_, args, offsetof(shared::ChangedSplats, groups));
    } else {
      args.turn = 0;
      list.dispatch(pass_, std::uint64_t{places_} * device_.subgroupSize(), args);
    }
    list.end();
    device_.throughputQueue().run(list);
  } while (sort != hash_.sort());
  list.begin();
  list.fill(changed_, 0, changed_.bytes());
  list.copy(largest_, largestRead_, largest_.bytes());
  list.end();
  device_.throughputQueue().run(list);
}

double SplatRadii::largest() const {
  return static_cast<double>(std::bit_cast<float>(largestRead_.mapped<const std::uint32_t>()[0]));
}

std::uint64_t SplatRadii::bytes() const {
  return hash_.bytes() + ordered_.positions.bytes() + ordered_.normals.bytes() + reaches_.bytes() + changed_.bytes() +
         list_.bytes();
}

}  // namespace palpate
