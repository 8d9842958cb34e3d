#include "engine/motion/surfel_map.hpp"

#include <algorithm>
#include <atomic>
#include <functional>
#include <mutex>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/check.hpp"
#include "engine/core/error.hpp"
#include "engine/core/parallel.hpp"
#include "engine/motion/cloud_source.hpp"

namespace palpate {

// One frame, and its effect on the points.
struct SurfelMap::Frame {
  const FrameImages& images;
  const std::vector<shared::PixelSurface>& surfaces;
  shared::FusionView view;
  std::atomic<std::uint64_t> matched = 0;
  std::mutex lock = {};  // guards the following member
  std::vector<std::uint32_t> removed = {};

  std::size_t indexOf(UVec2 pixel) const { return std::size_t{pixel.y} * view.width + pixel.x; }
  shared::Measurement measurementOf(UVec2 pixel) const {
    const std::size_t index = indexOf(pixel);
    return {.pixel = pixel,
            .depth = images.depths[index],
            .color = view.colored ? images.colors[index] : 0u,
            .surface = surfaces[index]};
  }

  // Whether no depth around the pixel occludes a position at that depth.
  bool seesThroughAt(UVec2 pixel, float placeDepth) const {
    for (std::uint32_t y = std::max(pixel.y, 1u) - 1; y <= std::min(pixel.y + 1, view.height - 1); ++y)
      for (std::uint32_t x = std::max(pixel.x, 1u) - 1; x <= std::min(pixel.x + 1, view.width - 1); ++x)
        if (!shared::seesThrough(view, placeDepth, images.depths[indexOf({x, y})])) return false;
    return true;
  }
};

SurfelMap::SurfelMap(const FusionOptions& options) : options_(options) { options_.validate(); }

void SurfelMap::begin(const PointCloud& cloud) {
  if (cloud.size() > options_.capacity)
    throw Error("fusion: a map of {} points at most cannot begin with {}", options_.capacity, cloud.size());
  *this = SurfelMap(options_);
  hasOrigin_ = !cloud.empty();
  if (!hasOrigin_) return;
  origin_ = cloud.origin;
  colored_ = cloud.hasColors();
  for (std::size_t id = 0; id < cloud.size(); ++id)
    surfels_.push_back({.place = cloud.positions[id],
                        .normal = cloud.normals[id],
                        .record = givenRecord(options_, packedColor(cloud, id))});
  totals_.points = count();
}

FusionCounts SurfelMap::fuse(const FrameImages& images, const std::vector<shared::PixelSurface>& surfaces,
                             const CameraPose& pose) {
  PALPATE_CHECK_EQ(images.depths.size(), surfaces.size());
  const DVec3 origin = hasOrigin_ ? origin_ : mapOriginFor(pose);
  Frame frame{.images = images, .surfaces = surfaces, .view = fusionView(images, pose, origin, options_)};
  origin_ = origin;
  hasOrigin_ = true;
  colored_ |= frame.view.colored != 0;
  const FusionCounts before = totals_;
  covered_.assign(surfaces.size(), 0);
  updatePoints(frame);
  appendPoints(frame);
  totals_.points = count();
  return {.points = totals_.points,
          .matched = totals_.matched - before.matched,
          .appended = totals_.appended - before.appended,
          .removed = totals_.removed - before.removed,
          .refused = totals_.refused - before.refused};
}

void SurfelMap::updatePoints(Frame& frame) {
  parallelFor(surfels_.size(), options_.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t id = begin; id < end; ++id)
      if (holds(id)) updatePoint(id, frame);
  });
  // The order in which threads append is arbitrary.
  std::ranges::sort(frame.removed, std::greater());
  const auto middle = free_.insert(free_.end(), frame.removed.begin(), frame.removed.end());
  std::inplace_merge(free_.begin(), middle, free_.end(), std::greater());
  totals_.matched += frame.matched;
  totals_.removed += frame.removed.size();
}

void SurfelMap::updatePoint(std::size_t id, Frame& frame) {
  shared::Surfel& surfel = surfels_[id];
  const shared::FusionView& view = frame.view;
  const shared::Projection projection = shared::projectionOf(view, surfel.place);
  if (!projection.inView) return;
  const shared::Measurement measured = frame.measurementOf(projection.pixel);
  const Vec3 normal = shared::directionInCamera(view, surfel.normal);
  shared::Sight sight = shared::sightOf(view, projection, normal, measured);
  if (sight.covers)
    std::atomic_ref(covered_[frame.indexOf(projection.pixel)]).fetch_or(projection.part, std::memory_order_relaxed);
  if (sight.kind == shared::kSightMatched) {
    surfel = shared::averaged(view, surfel, measured);
    frame.matched.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  if (sight.kind == shared::kSightFree && !frame.seesThroughAt(projection.pixel, projection.place.z))
    sight.kind = shared::kSightUnclear;
  surfel.record = shared::doubted(surfel.record, sight.kind);
  if (!shared::isGivenUp(surfel.record)) return;
  surfel.record.weight = 0;
  const std::scoped_lock hold(frame.lock);
  frame.removed.push_back(static_cast<std::uint32_t>(id));
}

void SurfelMap::appendPoints(Frame& frame) {
  const std::uint32_t width = frame.view.width, height = frame.view.height;
  const auto isCovered = [&](std::size_t pixel, std::uint32_t x, std::uint32_t y) {
    return shared::isCovered(covered_[pixel], x > 0 ? covered_[pixel - 1] : 0, x + 1 < width ? covered_[pixel + 1] : 0,
                             y > 0 ? covered_[pixel - width] : 0, y + 1 < height ? covered_[pixel + width] : 0);
  };
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::size_t pixel = frame.indexOf({x, y});
      if (!(frame.surfaces[pixel].depth > 0) || isCovered(pixel, x, y)) continue;
      const shared::Surfel born = shared::bornAt(frame.view, frame.measurementOf({x, y}));
      if (!free_.empty()) {
        surfels_[free_.back()] = born;
        free_.pop_back();
      } else if (surfels_.size() < options_.capacity) {
        surfels_.push_back(born);
      } else {
        ++totals_.refused;
        continue;
      }
      ++totals_.appended;
    }
  }
}

void SurfelMap::show(CloudFrame& frame) const {
  frame = {.time_s = frame.time_s};
  for (std::size_t id = 0; id < ids(); ++id) {
    if (!holds(id)) continue;
    const shared::Surfel& s = surfels_[id];
    frame.positions.push_back(s.place);
    frame.normals.push_back(s.normal);
    if (colored_) frame.colors.push_back(colorOf(s.record));
    frame.ids.push_back(static_cast<std::uint32_t>(id));
  }
}

PointCloud SurfelMap::cloud() const {
  CloudFrame frame;
  show(frame);
  PointCloud cloud;
  cloud.origin = origin_;
  placeAt(frame, cloud);
  return cloud;
}

}  // namespace palpate
