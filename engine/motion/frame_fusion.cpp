#include "engine/motion/frame_fusion.hpp"

#include <atomic>
#include <bit>

#include "engine/core/parallel.hpp"
#include "engine/motion/fusion.hpp"
#include "shaders/shared/icp.h"

namespace palpate {

namespace {

void lower(std::uint64_t& value, std::uint64_t to) {
  const std::atomic_ref shared(value);
  std::uint64_t now = shared.load(std::memory_order_relaxed);
  while (to < now && !shared.compare_exchange_weak(now, to, std::memory_order_relaxed)) {
  }
}

}  // namespace

MapPairs::MapPairs(const SurfelMap& map, const FrameImages& images, const std::vector<shared::PixelSurface>& surfaces,
                   const CameraPose& expected)
    : map_(map),
      images_(images),
      surfaces_(surfaces),
      view_(fusionView(images, expected, map.origin(), map.options())) {
  findFront();
}

void MapPairs::findFront() {
  // Depth above the id; positive floats order like their bits.
  std::vector<std::uint64_t> nearest(surfaces_.size(), ~std::uint64_t{0});
  parallelFor(map_.ids(), map_.options().threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t id = begin; id < end; ++id) {
      if (!map_.holds(id)) continue;
      const shared::Surfel& surfel = map_.surfel(id);
      const shared::Projection projection = shared::projectionOf(view_, surfel.place);
      if (!shared::isFront(view_, projection, surfel.normal)) continue;
      lower(nearest[std::size_t{projection.pixel.y} * view_.width + projection.pixel.x],
            std::uint64_t{std::bit_cast<std::uint32_t>(projection.place.z)} << 32 | id);
    }
  });
  ids_.resize(nearest.size());
  for (std::size_t i = 0; i < ids_.size(); ++i) ids_[i] = static_cast<std::uint32_t>(nearest[i]);
}

IcpSums MapPairs::sum(const IcpQuery& query) const {
  const std::uint32_t stride = query.level.stride;
  const std::size_t rows = (view_.height + stride - 1) / stride;
  std::vector<IcpSums> sums(rows);
  // Ranges are in pixels; a thread processes the rows whose first pixel is in its range.
  parallelFor(rows * view_.width, map_.options().threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = (begin + view_.width - 1) / view_.width; row * view_.width < end; ++row)
      for (std::uint32_t column = 0; column < view_.width; column += stride)
        addPixel({column, static_cast<std::uint32_t>(row) * stride}, query, sums[row]);
  });
  IcpSums all;
  for (const IcpSums& row : sums) all += row;
  return all;
}

void MapPairs::addPixel(UVec2 pixel, const IcpQuery& query, IcpSums& sums) const {
  const std::size_t index = std::size_t{pixel.y} * view_.width + pixel.x;
  const shared::PixelSurface& surface = surfaces_[index];
  if (!(surface.depth > 0)) return;
  ++sums.seen;
  const float depth = images_.depths[index];
  const DVec3 measured = query.pose.toWorld(DVec3(shared::placeOfPixel(view_, pixel, depth))) - map_.origin();
  const shared::Projection projection = shared::projectionOf(view_, Vec3(measured));
  if (!projection.inView) return;
  const std::uint32_t id = ids_[std::size_t{projection.pixel.y} * view_.width + projection.pixel.x];
  if (id == kNoPoint) return;
  const shared::Surfel& surfel = map_.surfel(id);
  const double deviation = static_cast<double>(shared::depthDeviation(view_.sensor.noise, depth));
  const auto pair = shared::icpPair<double>(
      {.place = measured, .normal = query.pose.turn * DVec3(surface.normal)},
      {.place = DVec3(surfel.place), .normal = DVec3(surfel.normal)},
      {.pivot = query.pivot - map_.origin(), .scale = query.scale, .gate = query.level.gate_m}, deviation);
  if (!pair.isPair) return;
  ++sums.pairs;
  sums.equations.add({pair.turn.x, pair.turn.y, pair.turn.z, pair.shift.x, pair.shift.y, pair.shift.z}, pair.residual,
                     pair.weight);
  sums.feigned += pair.weight * static_cast<double>(shared::normalVariance(view_, depth, surfel.record.weight));
}

IcpResult findPose(const SurfelMap& map, const FrameImages& images, const std::vector<shared::PixelSurface>& surfaces,
                   const CameraPose& expected, const IcpOptions& options) {
  const MapPairs pairs(map, images, surfaces, expected);
  return searchPose(images, expected, options, [&](const IcpQuery& query) { return pairs.sum(query); });
}

void FrameFusion::begin(const PointCloud& cloud, const std::optional<CameraPose>& seenFrom) {
  map_.begin(cloud);
  intake_.beginAt(seenFrom);
}

const FrameOutcome& FrameFusion::leftOut(FrameFate fate) {
  outcome_.fate = fate;
  outcome_.why = intake_.why();
  return outcome_;
}

const FrameOutcome& FrameFusion::fuse(const DepthCamera& camera, const DepthFrame& frame) {
  outcome_ = {};
  if (!intake_.read(camera, frame)) return leftOut(FrameFate::refused);
  findPixelSurfaces(intake_.images(), map_.options(), surfaces_);
  const std::optional<CameraPose> pose =
      intake_.place(frame, [&](const CameraPose& expected, const IcpOptions& options) {
        return findPose(map_, intake_.images(), surfaces_, expected, options);
      });
  outcome_.search = intake_.search();
  if (!pose) return leftOut(FrameFate::unplaced);
  outcome_.fate = FrameFate::fused;
  outcome_.pose = *pose;
  outcome_.counts = map_.fuse(intake_.images(), surfaces_, *pose);
  intake_.fused(*pose, outcome_.counts.refused);
  return outcome_;
}

}  // namespace palpate
