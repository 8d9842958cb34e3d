#include "engine/contact/normal_estimate.hpp"

#include "engine/cloud/normals.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/parallel_collect.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/spatial/spatial_hash.hpp"
#include "shaders/compiled.hpp"
#include "shaders/shared/normal_estimate.h"

namespace palpate {

namespace {

constexpr std::size_t kRoomyTable = 4;
constexpr unsigned kNearest = 16;                // points per plane fit on the host
constexpr std::size_t kSpacingPoints = 250'000;  // of which the spacing is measured: four times as fast as of a million
static_assert(shared::kNoNeighbour == NeighbourGraph::kNobody);

struct Planes {
  BareVector<FittedPlane> planes;  ///< zero normals for points that the GPU leaves to the host
  BareVector<Vec3> normals;        ///< of the other points
  NeighbourGraph graph;
};

template <class T>
BareVector<T> downloaded(Device& device, const Buffer& from, std::uint64_t count) {
  BareVector<T> values(count);
  downloadBytes(device, device.latencyQueue(), from, std::as_writable_bytes(std::span(values)));
  return values;
}

Planes planesOnGpu(Device& device, std::span<const Vec3> positions, const DVec3& origin, double radius,
                   unsigned threads, NormalEstimateCost& cost) {
  LiveCloud live(device, positions);
  // In a large table few cells share a bucket: visiting points of other cells costs time, too.
  SpatialHash hash(device, makeHashGrid(Vec3(origin), radius, kRoomyTable * positions.size()), live.count());
  const NormalEstimate estimate(device, live.count());
  const Stopwatch watch;
  hash.build(live);
  CommandList list(device, device.latencyQueue(), "estimate normals");
  list.begin();
  estimate.record(list, hash.view(live.front(), live.count()), radius);
  list.end();
  device.latencyQueue().run(list);
  cost.passes_ms = watch.elapsed_us() * 1e-3;
  const auto planes = downloaded<Vec4>(device, estimate.planes(), live.count());
  const auto normals = downloaded<Vec4>(device, estimate.normals(), live.count());
  return {parallelMake(planes.size(), threads, [&](std::size_t i) { return FittedPlane{.normal = Vec3(planes[i])}; }),
          parallelMake(normals.size(), threads, [&](std::size_t i) { return Vec3(normals[i]); }),
          {.degree = shared::kGraphSectors,
           .neighbours = downloaded<std::uint32_t>(device, estimate.neighbours(),
                                                   std::uint64_t{live.count()} * shared::kGraphSectors)}};
}

}  // namespace

NormalEstimate::NormalEstimate(Device& device, std::uint32_t points)
    : fit_(device, shader_code::contact_estimate_normals, {.pushBytes = sizeof(shared::NormalEstimateArgs)}),
      keepEdges_(device, shader_code::contact_keep_edges, {.pushBytes = sizeof(shared::NormalEstimateArgs)}),
      name_(device, shader_code::contact_name_neighbours, {.pushBytes = sizeof(shared::NormalEstimateArgs)}),
      planes_(Buffer::of<Vec4>(device, points, Memory::device, "estimated planes")),
      fits_(Buffer::of<Vec2>(device, points, Memory::device, "how planes fit")),
      normals_(Buffer::of<Vec4>(device, points, Memory::device, "estimated normals")),
      neighbours_(Buffer::of<std::uint32_t>(device, std::uint64_t{points} * shared::kGraphSectors, Memory::device,
                                            "estimate's neighbours")) {}

void NormalEstimate::record(CommandList& list, const shared::CloudView& cloud, double radius) const {
  const shared::NormalEstimateArgs args{.cloud = cloud,
                                        .planes = planes_.address(),
                                        .fits = fits_.address(),
                                        .normals = normals_.address(),
                                        .neighbours = neighbours_.address(),
                                        .radius = static_cast<float>(radius),
                                        .unused = 0};
  list.fill(planes_, 0, planes_.bytes());
  list.dispatch(fit_, cloud.slots, args);
  list.dispatch(keepEdges_, cloud.slots, args);
  list.dispatch(name_, cloud.slots, args);
}

NormalEstimateCost estimateNormals(Device& device, PointCloud& cloud, unsigned threads, std::optional<UpAxis> up) {
  const Stopwatch watch;
  NormalEstimateCost cost;
  const Places places = distinctPlaces(cloud.positions, threads);
  const double spacing = meanSpacing(cloud, threads, kSpacingPoints);
  if (spacing <= 0) {  // fewer than two positions: no neighbourhood to visit
    estimateNormals(cloud, kNearest, threads, up);
    cost.onHost = places.positions.size();
    return cost;
  }
  Planes planes = planesOnGpu(device, places.positions, boundsOf(cloud).min,
                              static_cast<double>(shared::kSupportSpacings) * spacing, threads, cost);
  const auto left = parallelCollect(
      planes.planes.size(), threads,
      [&](std::size_t i) { return glm::dot(planes.planes[i].normal, planes.planes[i].normal) < 0.5f; },
      [](std::size_t i) { return static_cast<std::uint32_t>(i); });
  fitNearestPlanes(places.positions, left, kNearest, planes.planes, planes.graph, threads);
  for (const std::uint32_t i : left) planes.normals[i] = planes.planes[i].normal;
  cost.onHost = left.size();
  cost.planes_ms = watch.elapsed_us() * 1e-3;
  signNormals(places.positions, planes.planes, planes.graph, planes.normals, threads, up ? *up : findUp(cloud).up);
  spreadNormals(cloud, places, planes.normals, threads);
  cost.signs_ms = watch.elapsed_us() * 1e-3 - cost.planes_ms;
  return cost;
}

}  // namespace palpate
