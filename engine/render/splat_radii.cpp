#include "engine/render/splat_radii.hpp"

#include <algorithm>
#include <bit>

#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

// A search in a noisy cloud takes an H200 about 100 us, and a slice takes as long as its longest search. This slice
// size leaves room for queries of touch.
constexpr std::uint32_t kSliceThreads = 1 << 16;
constexpr double kWidestShare = 0.1;  // of the box: a wider disc hides a small model

double widestBorder(const Bounds& bounds, double spacing) {
  const double side = bounds.longestSide();
  const double widest = static_cast<double>(shared::kSplatWidest) * spacing;
  return side > 0 ? std::min(widest, kWidestShare * side) : widest;
}

}  // namespace

DiscShapes::DiscShapes(Device& device, std::uint32_t places)
    : clips(Buffer::of<std::uint32_t>(device, places, Memory::device, "disc clips")),
      widths(Buffer::of<std::uint32_t>(device, (places + shared::kDiscBlock - 1) / shared::kDiscBlock, Memory::device,
                                       "disc widths")) {}

SplatRadii::SplatRadii(Device& device, const Bounds& bounds, std::uint32_t places, double spacing, bool edited,
                       std::span<const Vec3> positions)
    : device_(device),
      places_(places),
      spacing_(spacing),
      widest_(widestBorder(bounds, spacing)),
      index_(device, makeHashGrid(Vec3(bounds.min), static_cast<double>(shared::kSplatFirstSearch) * spacing, places),
             positions, places, edited),
      pass_(device, shader_code::render_splat_radius,
            {.pushBytes = sizeof(shared::SplatRadiusArgs), .sliceThreads = kSliceThreads}),
      changedPass_(device, shader_code::render_splat_changed, {.pushBytes = sizeof(shared::SplatChangedArgs)}),
      reaches_(Buffer::of<std::uint32_t>(device, places, Memory::device, "splat reaches")),
      changed_(Buffer::of<std::uint32_t>(device, (std::uint64_t{grid().bucketMask} + 32) / 32, Memory::device,
                                         "changed buckets")),
      largest_(Buffer::of<UVec2>(device, 1, Memory::device, "largest splat")),
      largestRead_(Buffer::of<UVec2>(device, 1, Memory::readback, "read largest splat")),
      changedSlots_(Buffer::of<std::uint32_t>(device, places, Memory::device, "changed splats")),
      count_(Buffer::of<std::uint32_t>(device, 1, Memory::device, "number of changed splats")),
      countRead_(Buffer::of<std::uint32_t>(device, 1, Memory::readback, "read number of changed splats")),
      list_(device, device.throughputQueue(), "splat radii") {
  largestRead_.mapped<UVec2>()[0] = UVec2(0);
  list_.begin();
  list_.fill(reaches_, 0, reaches_.bytes());
  list_.fill(changed_, 0, changed_.bytes());
  list_.fill(largest_, 0, largest_.bytes());
  list_.end();
  device.throughputQueue().run(list_);
}

void SplatRadii::measure(const LiveCloud::Half& points, const DiscShapes& shapes) {
  index_.build(points, [](CommandList&) {});
  ++work_.builds;
  measure(points, shapes, places_, Discs::all);
}

void SplatRadii::measureChanged(const LiveCloud::Half& points, const DiscShapes& shapes) {
  const std::optional<std::uint32_t> near = listNear();
  if (near)
    measure(points, shapes, *near, Discs::listedNear);
  else
    measure(points, shapes, listAmongAll(points), Discs::listedAmongAll);
}

std::optional<std::uint32_t> SplatRadii::listNear() {
  if (!index_.isCurrent() || !index_.changedCells()) return std::nullopt;
  list_.begin();
  list_.fill(count_, 0, count_.bytes());
  index_.recordNear(list_, {.reaches = reaches_.address(),
                            .largest = largest_.address(),
                            .list = changedSlots_.address(),
                            .count = count_.address()});
  list_.copy(count_, countRead_, count_.bytes());
  list_.end();
  device_.throughputQueue().run(list_);
  if (!index_.changedCells()) return std::nullopt;
  return countRead_.mapped<const std::uint32_t>()[0];
}

void SplatRadii::recordAmongAll(CommandList& list) const {
  const shared::SplatChangedArgs args{.cloud = index_.view(),
                                      .reaches = reaches_.address(),
                                      .changed = changed_.address(),
                                      .list = changedSlots_.address(),
                                      .count = count_.address()};
  list.fill(count_, 0, count_.bytes());
  list.dispatch(changedPass_, args.cloud.slots, args);
  list.copy(count_, countRead_, count_.bytes());
}

std::uint32_t SplatRadii::listAmongAll(const LiveCloud::Half& points) {
  ++work_.searches;
  if (index_.isCurrent()) {
    list_.begin();
    recordAmongAll(list_);
    list_.end();
    device_.throughputQueue().run(list_);
  } else {
    index_.build(points, [&](CommandList& list) { recordAmongAll(list); });
    ++work_.builds;
  }
  return countRead_.mapped<const std::uint32_t>()[0];
}

void SplatRadii::measure(const LiveCloud::Half& points, const DiscShapes& shapes, std::uint32_t count, Discs which) {
  const shared::SplatRadiusArgs args{.cloud = index_.view(),
                                     .normals = points.normals.address(),
                                     .clips = shapes.clips.address(),
                                     .widths = shapes.widths.address(),
                                     .reaches = reaches_.address(),
                                     .list = changedSlots_.address(),
                                     .largest = largest_.address(),
                                     .spacing = static_cast<float>(spacing_),
                                     .widest = static_cast<float>(widest_),
                                     .onlyListed = which == Discs::all ? 0u : 1u,
                                     .count = count};
  list_.begin();
  list_.dispatch(pass_, std::uint64_t{count} * device_.subgroupSize(), args);
  recordClearMarks(list_, which);
  index_.recordForget(list_);
  list_.copy(largest_, largestRead_, largest_.bytes());
  list_.end();
  device_.throughputQueue().run(list_);
  index_.forget();
  work_.measured += count;
}

void SplatRadii::recordClearMarks(CommandList& list, Discs which) {
  if (which == Discs::listedNear) {
    work_.cells += *index_.changedCells();
    index_.recordClearMarks(list, changed_);
  } else {
    ++work_.clears;
    list.fill(changed_, 0, changed_.bytes());
  }
}

double SplatRadii::largest() const {
  return static_cast<double>(std::bit_cast<float>(largestRead_.mapped<const UVec2>()[0].x));
}

std::uint64_t SplatRadii::bytes() const {
  return index_.bytes() + reaches_.bytes() + changed_.bytes() + changedSlots_.bytes();
}

}  // namespace palpate
