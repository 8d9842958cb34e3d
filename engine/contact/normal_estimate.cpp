#include "engine/contact/normal_estimate.hpp"

#include "engine/cloud/normals.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/core/clock.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/spatial/spatial_hash.hpp"
#include "shaders/compiled.hpp"
#include "shaders/shared/normal_estimate.h"

namespace palpate {

namespace {

constexpr unsigned kNearest = 16;  // that a plane of the host is fitted to
static_assert(shared::kNoNeighbour == NeighbourGraph::kNobody);

struct Planes {
  std::vector<Vec3> normals;  ///< zero where the GPU leaves a point to the host
  NeighbourGraph graph;
};

Planes planesOnGpu(Device& device, const std::vector<Vec3>& positions, double radius) {
  PointCloud cloud;
  cloud.positions = positions;
  cloud.normals.resize(positions.size());
  LiveCloud live(device, cloud);
  SpatialHash hash(device, makeHashGrid(Vec3(boundsOf(cloud).min), radius, positions.size()), live.count());
  hash.build(live);
  const Buffer planes = Buffer::of<Vec4>(device, live.count(), Memory::device, "estimated planes");
  const Buffer neighbours = Buffer::of<std::uint32_t>(device, std::uint64_t{live.count()} * shared::kSectors,
                                                      Memory::device, "estimate's neighbours");
  CommandList list(device, device.touch(), "estimate normals");
  list.begin();
  const NormalEstimate estimate(device);
  estimate.record(list, hash.view(live.side(), live.count()), planes, neighbours, radius);
  list.end();
  device.touch().run(list);
  Planes result;
  for (const Vec4& plane : download<Vec4>(device, planes, live.count())) result.normals.emplace_back(plane);
  result.graph = {
      .degree = shared::kSectors,
      .neighbours = download<std::uint32_t>(device, neighbours, neighbours.bytes() / sizeof(std::uint32_t))};
  return result;
}

}  // namespace

NormalEstimate::NormalEstimate(Device& device)
    : fit_(device, shader_code::contact_estimate_normals, {.pushBytes = sizeof(shared::NormalEstimateArgs)}),
      name_(device, shader_code::contact_name_neighbours, {.pushBytes = sizeof(shared::NormalEstimateArgs)}) {}

void NormalEstimate::record(CommandList& list, const shared::CloudView& cloud, const Buffer& planes,
                            const Buffer& neighbours, double radius) const {
  const shared::NormalEstimateArgs args{.cloud = cloud,
                                        .planes = planes.address(),
                                        .neighbours = neighbours.address(),
                                        .radius = static_cast<float>(radius),
                                        .unused = 0};
  list.fill(planes, 0, planes.bytes());
  list.dispatch(fit_, cloud.slots, args);
  list.dispatch(name_, cloud.slots, args);
}

NormalEstimateCost estimateNormals(Device& device, PointCloud& cloud, unsigned threads) {
  const Stopwatch watch;
  NormalEstimateCost cost;
  const Places places = distinctPlaces(cloud.positions);
  const double spacing = meanSpacing(cloud, threads);
  if (spacing <= 0) {  // fewer than two places: no neighbourhood to look at
    estimateNormals(cloud, kNearest, threads);
    cost.onHost = places.positions.size();
    return cost;
  }
  Planes planes = planesOnGpu(device, places.positions, static_cast<double>(shared::kSupportSpacings) * spacing);
  std::vector<std::uint32_t> left;
  for (std::uint32_t i = 0; i < planes.normals.size(); ++i)
    if (glm::dot(planes.normals[i], planes.normals[i]) < 0.5f) left.push_back(i);
  fitNearestPlanes(places.positions, left, kNearest, planes.normals, planes.graph, threads);
  cost.onHost = left.size();
  cost.planes_ms = watch.elapsed_us() * 1e-3;
  orientNormals(places.positions, planes.normals, planes.graph, threads);
  spreadNormals(cloud, places, planes.normals);
  cost.signs_ms = watch.elapsed_us() * 1e-3 - cost.planes_ms;
  return cost;
}

}  // namespace palpate
