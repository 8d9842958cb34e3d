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

std::uint32_t checkedCount(const Device& device, const PointCloud& cloud) {
  if (cloud.size() > std::numeric_limits<std::uint32_t>::max() / 2)
    throw OutOfGpuMemory("{}: {} points are more than can be drawn", device.name(), cloud.size());
  return static_cast<std::uint32_t>(cloud.size());
}

std::vector<Vec4> widened(const std::vector<Vec3>& vectors, std::size_t count) {
  std::vector<Vec4> wide(count, Vec4(0));
  for (std::size_t i = 0; i < vectors.size(); ++i) wide[i] = Vec4(vectors[i], 0.0f);
  return wide;
}

}  // namespace

DrawnCloud::DrawnCloud(Device& device, const PointCloud& cloud)
    : device_(device),
      count_(checkedCount(device, cloud)),
      hasColors_(cloud.hasColors()),
      bounds_(boundsOf(cloud)),
      positions_(Buffer::of<Vec4>(device, count_, Memory::device, "drawn positions")),
      normals_(Buffer::of<Vec4>(device, count_, Memory::device, "drawn normals")),
      colors_(Buffer::of<std::uint32_t>(device, cloud.colors.size(), Memory::device, "drawn colors")),
      latest_(Buffer::of<std::uint32_t>(device, count_, Memory::device, "drawn latest")),
      claim_(device, shader_code::render_drawn_cloud_claim, {.pushBytes = sizeof(shared::CatchUpArgs)}),
      apply_(device, shader_code::render_drawn_cloud_apply, {.pushBytes = sizeof(shared::CatchUpArgs)}),
      list_(device, device.sight(), "catch up") {
  upload(device, positions_, widened(cloud.positions, count_));
  upload(device, normals_, widened(cloud.normals, count_));
  upload(device, colors_, cloud.colors);
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
                                 .firstSlot = static_cast<std::uint32_t>(range.begin % log.capacity()),
                                 .slotMask = static_cast<std::uint32_t>(log.capacity() - 1),
                                 .entryCount = static_cast<std::uint32_t>(range.size()),
                                 .pointCount = count_};
  list_.begin();
  list_.dispatch(claim_, range.size(), args);
  list_.dispatch(apply_, range.size(), args);
  list_.end();
  device_.sight().run(list_);
  reader.consume(range.end);
  return range.size();
}

}  // namespace palpate
