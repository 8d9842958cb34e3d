#include "engine/render/drawn_cloud.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <limits>
#include <utility>

#include "engine/core/check.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/compiled.hpp"
#include "shaders/shared/drawn_cloud.h"

namespace palpate {

namespace {

// A whole frame saturates the GPU's memory bandwidth: touch gets its share between two slices.
constexpr std::uint32_t kPlaceSlice = 1 << 16;

// Number of states uploaded at a time; a power of two. A tick's edit usually fits.
constexpr std::uint64_t kPiece = 1 << 16;

// Position of an unused index.
const Vec4 kNowhere(Vec3(std::numeric_limits<float>::quiet_NaN()), std::bit_cast<float>(shared::kEmptySlot));

std::uint32_t checkedCount(const Device& device, std::uint64_t count) {
  if (count > std::numeric_limits<std::uint32_t>::max() / 2)
    throw OutOfGpuMemory("{}: {} points exceed the maximum that can be drawn", device.name(), count);
  return static_cast<std::uint32_t>(count);
}

std::vector<Vec4> positionsOf(const PointCloud& cloud, std::size_t count) {
  std::vector<Vec4> packed(count, kNowhere);
  for (std::uint32_t i = 0; i < cloud.size(); ++i) packed[i] = Vec4(cloud.positions[i], std::bit_cast<float>(i));
  return packed;
}

std::vector<Vec4> normalsOf(const PointCloud& cloud, std::size_t count) {
  std::vector<Vec4> packed(count, Vec4(0));
  for (std::size_t i = 0; i < cloud.normals.size(); ++i) packed[i] = Vec4(cloud.normals[i], 0.0f);
  return packed;
}

std::uint64_t nextStamp() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace

DrawnCloud::DrawnCloud(Device& device, const PointCloud& cloud, const DrawnOptions& options)
    : device_(device),
      count_(checkedCount(device, cloud.size() + options.spare)),
      loadedPoints_(static_cast<std::uint32_t>(cloud.size())),
      hasColors_(cloud.hasColors() || options.painted),
      bounds_(boundsOf(cloud)),
      spacing_(options.spacing),
      points_{Buffer::of<Vec4>(device, count_, Memory::device, "drawn positions"),
              Buffer::of<Vec4>(device, count_, Memory::device, "drawn normals"), 1},
      colors_(Buffer::of<std::uint32_t>(device, hasColors_ ? count_ : 0, Memory::device, "drawn colors")),
      picked_(Buffer::of<std::uint32_t>(device, count_, Memory::device, "picked splats")),
      attributes_(device, count_),
      shapes_(device, count_),
      latest_(Buffer::of<std::uint32_t>(device, count_, Memory::device, "drawn latest")),
      end_(Buffer::of<std::uint32_t>(device, 1, Memory::readback, "drawn end")),
      claim_(device, shader_code::render_drawn_cloud_claim, {.pushBytes = sizeof(shared::CatchUpArgs)}),
      apply_(device, shader_code::render_drawn_cloud_apply, {.pushBytes = sizeof(shared::CatchUpArgs)}),
      place_(device, shader_code::render_drawn_cloud_place,
             {.pushBytes = sizeof(shared::PlaceArgs), .sliceThreads = kPlaceSlice}),
      leave_(device, shader_code::render_drawn_cloud_leave,
             {.pushBytes = sizeof(shared::PlaceArgs), .sliceThreads = kPlaceSlice}),
      list_(device, device.throughputQueue(), "catch up"),
      stamp_(nextStamp()) {
  upload(device, device.throughputQueue(), points_.positions, positionsOf(cloud, count_));
  upload(device, device.throughputQueue(), points_.normals, normalsOf(cloud, count_));
  if (hasColors_) {
    std::vector<std::array<std::uint8_t, 4>> colors = cloud.colors;
    colors.resize(count_, kUnpainted);
    upload(device, device.throughputQueue(), colors_, colors);
  }
  list_.begin();
  list_.fill(latest_, 0, latest_.bytes());
  list_.fill(shapes_.clips, 0, shapes_.clips.bytes());
  list_.fill(shapes_.widths, 0, shapes_.widths.bytes());
  list_.end();
  device.throughputQueue().run(list_);
  end_.mapped<std::uint32_t>()[0] = loadedPoints_;
  if (gaussiansOf(cloud)) gaussians_.emplace(device, cloud);
  if (!(spacing_ > 0)) return;
  radii_.emplace(device, bounds_, count_, spacing_, options.edited, cloud.positions);
  radii_->measure(points_, shapes_);
  largestRadius_ = radii_->largest();
  if (!options.edited) radii_.reset();
}

std::uint64_t DrawnCloud::catchUp(EditLog::Reader& reader) {
  const EditLog& log = reader.log();
  const EditLog::Range range = reader.unread();
  if (range.size() == 0) return 0;
  PALPATE_CHECK_LE(range.size(), log.capacity());
  apply({.ring = log.entries(),
         .slots = log.capacity(),
         .firstSlot = range.begin % log.capacity(),
         .count = range.size()});
  reader.consume(range.end);
  return range.size();
}

std::uint64_t DrawnCloud::catchUp(std::span<const PointState> states) {
  if (states.empty()) return 0;
  if (!fromHost_) fromHost_.emplace(Buffer::of<PackedState>(device_, kPiece, Memory::upload, "states from the host"));
  const std::span<PackedState> staged = fromHost_->mapped<PackedState>();
  for (auto next = states.begin(); next != states.end();) {
    std::size_t piece = 0;
    for (; next != states.end() && piece < staged.size(); ++next)
      if (next->number < count_) staged[piece++] = packedState(*next);
    if (piece > 0) apply({.ring = fromHost_->address(), .slots = kPiece, .count = piece});
  }
  return states.size();
}

void DrawnCloud::apply(const Entries& entries) {
  PALPATE_CHECK(std::has_single_bit(entries.slots));
  const shared::CatchUpArgs args{.entries = entries.ring,
                                 .latest = latest_.address(),
                                 .positions = points_.positions.address(),
                                 .normals = points_.normals.address(),
                                 .colors = colors_.address(),
                                 .firstSlot = static_cast<std::uint32_t>(entries.firstSlot),
                                 .slotMask = static_cast<std::uint32_t>(entries.slots - 1),
                                 .entryCount = static_cast<std::uint32_t>(entries.count),
                                 .pointCount = count_,
                                 .colored = hasColors_ ? 1u : 0u,
                                 .marks = radii_ ? 1u : 0u,
                                 .changed = radii_ ? radii_->changed().address() : 0,
                                 .grid = radii_ ? radii_->grid() : HashGrid{},
                                 .end = end_.address()};
  const bool follows = radii_ && radii_->index().isCurrent();
  list_.begin();
  list_.dispatch(claim_, entries.count, args);
  if (follows) radii_->index().recordFollow(list_, args);
  list_.dispatch(apply_, entries.count, args);
  list_.end();
  device_.throughputQueue().run(list_);
  if (follows) radii_->index().readFollowed();
  isStale_ = true;
  stamp_ = nextStamp();
  knowsMeasured_ = false;
}

void DrawnCloud::place(const LiveCloud::Half& live, std::uint32_t slots, bool colored) {
  if (radii_ && !measured_) measured_.emplace(Buffer::of<Vec4>(device_, count_, Memory::device, "measured splats"));
  const shared::PlaceArgs args{.livePositions = live.positions.address(),
                               .liveNormals = live.normals.address(),
                               .latest = latest_.address(),
                               .positions = points_.positions.address(),
                               .normals = points_.normals.address(),
                               .colors = colors_.address(),
                               .measured = measured_ ? measured_->address() : 0,
                               .slots = slots,
                               .pointCount = count_,
                               .colored = colored && hasColors_ ? 1u : 0u,
                               .marks = radii_ ? 1u : 0u,
                               .changed = radii_ ? radii_->changed().address() : 0,
                               .grid = radii_ ? radii_->grid() : HashGrid{},
                               .keepsWithin = static_cast<float>(shared::kKeepsDiscWithin * spacing_),
                               .unused = 0};
  if (radii_) radii_->index().lose();
  list_.begin();
  // Discs never measured, or measured elsewhere, are measured now.
  if (measured_ && !std::exchange(knowsMeasured_, true)) list_.fill(*measured_, shared::kEmptySlot, measured_->bytes());
  list_.dispatch(place_, slots, args);
  list_.dispatch(leave_, count_, args);
  list_.end();
  device_.throughputQueue().run(list_);
  isStale_ = true;
  stamp_ = nextStamp();
}

void DrawnCloud::place(const CloudFrame& frame) {
  std::vector<Vec4> positions(count_, kNowhere), normals(count_, Vec4(0));
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const std::uint32_t id = frame.idOf(i);
    if (id >= count_) continue;
    const auto [red, green, blue] = frame.colors.empty() ? std::array<std::uint8_t, 3>{} : frame.colors[i];
    positions[id] = Vec4(frame.positions[i], std::bit_cast<float>(id));
    normals[id] = Vec4(frame.normals[i], std::bit_cast<float>(bitsOfColor(red, green, blue)));
  }
  if (!frame_)
    frame_ = LiveCloud::Half{Buffer::of<Vec4>(device_, count_, Memory::device, "positions of a frame"),
                             Buffer::of<Vec4>(device_, count_, Memory::device, "normals of a frame"), 0};
  upload(device_, device_.throughputQueue(), frame_->positions, positions);
  upload(device_, device_.throughputQueue(), frame_->normals, normals);
  place(*frame_, count_, !frame.colors.empty());
}

void DrawnCloud::closeSurface() {
  if (!radii_ || !isStale_) return;
  radii_->measureChanged(points_, shapes_);
  largestRadius_ = radii_->largest();
  isStale_ = false;
}

std::uint64_t DrawnCloud::bytes() const {
  return points_.positions.bytes() + points_.normals.bytes() + colors_.bytes() + shapes_.bytes() + picked_.bytes() +
         latest_.bytes() + end_.bytes() + attributes_.bytes() + (gaussians_ ? gaussians_->bytes() : 0) +
         (fromHost_ ? fromHost_->bytes() : 0) + (frame_ ? frame_->positions.bytes() + frame_->normals.bytes() : 0) +
         (measured_ ? measured_->bytes() : 0) + (radii_ ? radii_->bytes() : 0);
}

}  // namespace palpate
