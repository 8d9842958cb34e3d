#include "engine/render/drawn_cloud.hpp"

#include <bit>
#include <limits>

#include "engine/core/check.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/compiled.hpp"
#include "shaders/shared/drawn_cloud.h"

namespace palpate {

namespace {

// Points of a cloud without colours before they are painted (shared::kUnpainted).
constexpr std::array<std::uint8_t, 4> kUnpainted{200, 200, 200, 255};

std::uint32_t checkedCount(const Device& device, std::uint64_t count) {
  if (count > std::numeric_limits<std::uint32_t>::max() / 2)
    throw OutOfGpuMemory("{}: {} points are more than can be drawn", device.name(), count);
  return static_cast<std::uint32_t>(count);
}

std::vector<Vec4> widened(const std::vector<Vec3>& vectors, std::size_t count, float missing) {
  std::vector<Vec4> wide(count, Vec4(Vec3(missing), 0.0f));
  for (std::size_t i = 0; i < vectors.size(); ++i) wide[i] = Vec4(vectors[i], 0.0f);
  return wide;
}

}  // namespace

DrawnCloud::DrawnCloud(Device& device, const PointCloud& cloud, std::uint32_t spare, bool painted)
    : device_(device),
      count_(checkedCount(device, cloud.size() + spare)),
      hasColors_(cloud.hasColors() || painted),
      bounds_(boundsOf(cloud)),
      positions_(Buffer::of<Vec4>(device, count_, Memory::device, "drawn positions")),
      normals_(Buffer::of<Vec4>(device, count_, Memory::device, "drawn normals")),
      colors_(Buffer::of<std::uint32_t>(device, hasColors_ ? count_ : 0, Memory::device, "drawn colors")),
      latest_(Buffer::of<std::uint32_t>(device, count_, Memory::device, "drawn latest")),
      claim_(device, shader_code::render_drawn_cloud_claim, {.pushBytes = sizeof(shared::CatchUpArgs)}),
      apply_(device, shader_code::render_drawn_cloud_apply, {.pushBytes = sizeof(shared::CatchUpArgs)}),
      list_(device, device.sight(), "catch up") {
  upload(device, positions_, widened(cloud.positions, count_, std::numeric_limits<float>::quiet_NaN()));
  upload(device, normals_, widened(cloud.normals, count_, 0));
  if (hasColors_) {
    std::vector<std::array<std::uint8_t, 4>> colors = cloud.colors;
    colors.resize(count_, kUnpainted);
    upload(device, colors_, colors);
  }
  list_.begin();
  list_.fill(latest_, 0, latest_.bytes());
  list_.end();
  device.sight().run(list_);
}

std::uint64_t DrawnCloud::catchUp(EditLog::Reader& reader) {
  const EditLog& log = reader.log();
  const EditLog::Range range = reader.unread();
  if (range.size() == 0) return 0;
  PALPATE_CHECK_LE(range.size(), log.capacity());
  PALPATE_CHECK(std::has_single_bit(log.capacity()));
  const shared::CatchUpArgs args{.entries = log.entries(),
                                 .latest = latest_.address(),
                                 .positions = positions_.address(),
                                 .normals = normals_.address(),
                                 .colors = colors_.address(),
                                 .firstSlot = static_cast<std::uint32_t>(range.begin % log.capacity()),
                                 .slotMask = static_cast<std::uint32_t>(log.capacity() - 1),
                                 .entryCount = static_cast<std::uint32_t>(range.size()),
                                 .pointCount = count_,
                                 .colored = hasColors_ ? 1u : 0u,
                                 .unused = 0};
  list_.begin();
  list_.dispatch(claim_, range.size(), args);
  list_.dispatch(apply_, range.size(), args);
  list_.end();
  device_.sight().run(list_);
  reader.consume(range.end);
  return range.size();
}

}  // namespace palpate
