#include "apps/cli/touch_report.hpp"

#include <algorithm>

#include <glm/common.hpp>

#include "engine/contact/contact_reference.hpp"
#include "engine/core/parallel_collect.hpp"

namespace palpate {

namespace {

/// Positions and normals of the points in the box, with the same origin.
PointCloud pointsIn(const PointCloud& cloud, const Bounds& box) {
  const auto inside = [&](std::size_t i) { return box.contains(DVec3(cloud.positions[i])); };
  const auto picked = parallelCollect(cloud.size(), 0, inside, [](std::size_t i) { return i; });
  PointCloud part{.origin = cloud.origin};
  for (const std::size_t i : picked) {
    part.positions.push_back(cloud.positions[i]);
    part.normals.push_back(cloud.normals[i]);
  }
  return part;
}

}  // namespace

ContactError contactError(const Trace& trace, const Model& model, const SurfaceOptions& surface,
                          std::optional<double> firstEditTime_s, const std::optional<RigidMotion>& motion) {
  constexpr std::size_t kMaxTicks = 200;
  std::vector<const TraceRow*> rows;
  for (const TraceRow& row : trace.rows)
    if (row.contact && row.fresh && (!firstEditTime_s || row.time_s <= *firstEditTime_s)) rows.push_back(&row);
  ContactError error;
  if (rows.empty()) return error;
  const std::size_t stride = (rows.size() + kMaxTicks - 1) / kMaxTicks;
  struct Felt {
    DVec3 proxy, normal;
  };
  std::vector<Felt> places;
  for (std::size_t i = 0; i < rows.size(); i += stride) {
    const RigidPose pose = motion ? motion->poseAt(rows[i]->time_s) : RigidPose{};
    places.push_back({pose.movedBack(rows[i]->proxy - model.cloud.origin), pose.turnedBack(rows[i]->normal)});
  }
  // Only a small part of a large cloud is near these positions.
  Bounds around{places.front().proxy, places.front().proxy};
  for (const Felt& place : places) around = {glm::min(around.min, place.proxy), glm::max(around.max, place.proxy)};
  around = {around.min - surface.radius, around.max + surface.radius};
  const PointCloud near = pointsIn(model.cloud, around);
  const ContactReference reference(near, surface);
  for (const auto& [proxy, normal] : places) {
    // Behind a sheet the felt normal is opposite to the points'.
    const SurfaceSample front = reference.surface(proxy, normal), back = reference.surface(proxy, -normal);
    const SurfaceSample& felt = back.neighbours > front.neighbours ? back : front;
    ++error.ticks;
    if (felt.defined)
      error.worst_mm = std::max(error.worst_mm, model.scale.toMm(std::abs(felt.distance)));
    else
      ++error.undefined;
  }
  return error;
}

std::string_view nameOf(const IndexWork& index) {
  if (index.followed == 0) return index.built == 0 ? "static" : "rebuild";
  return index.built == 0 ? "incremental" : "incremental and rebuild";
}

ServoReport servoReport(const ServoResult& result) {
  return {.step_us = result.step_us,
          .late_us = result.late_us,
          .scheduling = result.scheduling,
          .withheld = result.counts().withheld,
          .leastEnergy_mJ = result.counts().leastEnergy_mJ};
}

}  // namespace palpate
