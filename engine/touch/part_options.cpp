#include "engine/touch/part_options.hpp"

#include <algorithm>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/point_cloud.hpp"
#include "engine/core/error.hpp"
#include "engine/touch/memory.hpp"
#include "engine/touch/touch_frames.hpp"

namespace palpate {

std::vector<std::uint32_t> colorsOf(const PointCloud& cloud, const TouchOptions& options) {
  std::vector<std::uint32_t> colors;
  if (!cloud.hasColors() && !options.paintable && !brushHas(options.brush->kind, shared::kPaintsPoints)) return colors;
  for (std::size_t i = 0; i < cloud.size(); ++i) colors.push_back(packedColor(cloud, i));
  return colors;
}

void requireFused(const TouchOptions& options, QueryMethod method) {
  if (method == QueryMethod::fused) return;
  if (options.tools.size() > 1) throw UsageError("several hands require the query method fused");
  if (!options.tools.front().points.empty()) throw UsageError("a tool of many points requires the query method fused");
}

const PointCloud& fitting(const Device& device, const PointCloud& cloud, const TouchOptions& options) {
  requireFused(options, options.method);
  PALPATE_CHECK(!(options.brush && moves(options)));
  requireGpuMemory(device, cloud.size(), options.brush.has_value());
  return cloud;
}

LiveIndexOptions indexOptions(const Device& device, const PointCloud& cloud, const TouchOptions& options) {
  const double cell = options.cell > 0 ? options.cell : options.radius;
  const PointExtent extent = options.extent.value_or(PointExtent{.bounds = boundsOf(cloud), .points = cloud.size()});
  const HashGrid grid = makeHashGrid(Vec3(extent.bounds.min), std::max(cell, smallestCell(options.radius)),
                                     extent.points, options.bucketKey);
  // Frames arrive in their own order, and usually all in the same.
  const bool chooses = moves(options) && options.sort == kDefaultSort;
  return {.grid = grid,
          .spareSlots = spareSlots(cloud, options),
          .sort = chooses ? sortInOrder(device, grid, cloud.positions, Slots::spare) : options.sort,
          .bucketOrder = options.bucketOrder,
          .slots = options.brush || moves(options) ? Slots::spare : Slots::full,
          .colored = moves(options)};
}

EditOptions editOptions(const TouchOptions& options) {
  return {.brush = *options.brush,
          .radius = options.radius / options.widening,
          .index = options.index,
          .timing = options.timing,
          .compaction = options.compaction};
}

}  // namespace palpate
