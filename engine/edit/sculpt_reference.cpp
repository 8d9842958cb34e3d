#include "engine/edit/sculpt_reference.hpp"

#include <algorithm>
#include <numbers>
#include <utility>

#include "engine/core/check.hpp"
#include "engine/core/clock.hpp"
#include "engine/edit/normal_fit.hpp"
#include "shaders/shared/contact.h"

namespace palpate {

namespace {

constexpr std::size_t kBatch = 64;  // points that a thread takes at a time
// Neighbours that a point looks at before it decides to come or go. More are within its look radius only where heaps of
// points lie in one place: they are merged with the ones that are seen, and no new point is asked for.
constexpr std::size_t kMostNeighbours = 2048;

// Calls body(i) for every i below `count`, on all threads.
template <class Body>
void forEachOf(WorkerTeam& team, std::size_t count, Body&& body) {
  team.forEach((count + kBatch - 1) / kBatch, [&](std::size_t batch) {
    const std::size_t end = std::min(count, (batch + 1) * kBatch);
    for (std::size_t i = batch * kBatch; i < end; ++i) body(i);
  });
}

// Insertions that are nearer to one another than this asks for wait for one another.
double claimSpacing(const SculptOptions& options) {
  return options.radius / static_cast<double>(shared::kSupportSpacings);
}

}  // namespace

SculptReference::SculptReference(const PointCloud& cloud, const HashGrid& grid, const SculptOptions& options)
    : options_(options), points_(cloud), grid_(grid, options.threads), claims_(claimSpacing(options)) {
  PALPATE_CHECK_LT(0.0, options.radius);
  const Stopwatch watch;
  build();
  buildTime_us_ = watch.elapsed_us();
  if (options.keepsDensity) measureSpacings();
}

// The weights of the neighbours within R on an even plane sum up to pi / 7 (R / spacing)^2.
double SculptReference::spacingAt(std::uint32_t point, std::span<const std::uint8_t> counts) const {
  const DVec3 place(points_.positions[point]), normal(points_.normals[point]);
  const Frame3 frame = frameAround(normal);
  double weights = 0;
  SectorDistances nearest;
  nearest.fill(std::numeric_limits<double>::infinity());
  grid_.forEachNear(place, options_.radius, [&](const SortedGrid::Placed& near) {
    if (!counts[near.number] || glm::dot(normal, DVec3(points_.normals[near.number])) <= shared::kSameSheet) return;
    const DVec3 offset = DVec3(near.position) - place;
    const double distance = glm::length(offset);
    weights += wendland(distance / options_.radius);
    if (distance == 0) return;
    double& inSector = nearest[shared::sectorOf(static_cast<float>(glm::dot(offset, frame.u)),
                                                static_cast<float>(glm::dot(offset, frame.v)))];
    inSector = std::min(inSector, distance);
  });
  return std::max(options_.radius * std::sqrt(std::numbers::pi / 7 / std::max(weights, 0.1)), sectorSpacing(nearest));
}

void SculptReference::measureSpacings() {
  const double least = static_cast<double>(shared::kLeastSpacing) * options_.radius;
  const double most = static_cast<double>(shared::kMostSpacing) * options_.radius;
  std::vector<std::uint8_t> counts(points_.size());  // not 0: the first point of its place
  forEachOf(grid_.team(), points_.size(), [&](std::size_t i) {
    counts[i] = 1;
    grid_.forEachNear(DVec3(points_.positions[i]), least,
                      [&](const SortedGrid::Placed& near) { counts[i] = counts[i] && near.number >= i; });
  });
  points_.spacings.resize(points_.size());
  forEachOf(grid_.team(), points_.size(), [&](std::size_t i) {
    points_.spacings[i] = static_cast<float>(
        std::clamp(spacingAt(static_cast<std::uint32_t>(i), counts), least, most));
  });
}

bool SculptReference::isAtRest(std::uint32_t point) const {
  return glm::distance(points_.positions[point], points_.rests[point]) <=
         shared::kAtRest * static_cast<float>(points_.spacing(point));
}

double SculptReference::reachOf(std::uint32_t point) const {
  if (point >= points_.fromFile) return double{points_.reaches[point - points_.fromFile]};
  return static_cast<double>(shared::kReach) * options_.radius;
}

void SculptReference::edit(const BrushTool& tool) {
  for (const std::uint32_t point : changed_) told_[point] = 0;
  changed_.clear();
  carves_ = tool.kind() == BrushKind::carve;
  if (tool.acts()) applyBrush(tool);
  findUnsettled();
  refit();
  if (options_.keepsDensity)
    resample();
  else
    for (const std::uint32_t point : unsettled_) points_.unsettled[point] = 0;
}

void SculptReference::set(std::span<const PointChange> changes) {
  for (const PointChange& change : changes) points_.set(change.to);
  std::ranges::fill(points_.unsettled, 0);
  settled_ = true;
  build();
}

void SculptReference::tellOf(std::uint32_t point) {
  told_.resize(points_.size(), 0);
  if (std::exchange(told_[point], 1) == 0) changed_.push_back(point);
}

// Every point reads the others where they were before.
void SculptReference::applyBrush(const BrushTool& tool) {
  reached_.clear();
  grid_.forEachNear(tool.center(), tool.radius(),
                    [&](const SortedGrid::Placed& point) { reached_.push_back(point.number); });
  places_.resize(reached_.size());
  forEachOf(grid_.team(), reached_.size(), [&](std::size_t i) {
    const std::uint32_t point = reached_[i];
    if (tool.kind() == BrushKind::smooth)
      places_[i] = {smoothed(tool, point)};
    else
      places_[i] = tool.brushed(DVec3(points_.positions[point]), DVec3(points_.normals[point]));
  });
  for (std::size_t i = 0; i < reached_.size(); ++i) {
    const std::uint32_t point = reached_[i];
    const Vec3 place(places_[i].position);
    const std::uint32_t color = tool.painted(DVec3(points_.positions[point]), points_.colors[point]);
    const bool moved = place != points_.positions[point];
    if (moved || places_[i].taken || color != points_.colors[point]) tellOf(point);
    points_.positions[point] = place;
    points_.colors[point] = color;
    points_.there[point] = !places_[i].taken;
    if (!moved) continue;
    points_.unsettled[point] = 1;
    if (point >= points_.fromFile)
      points_.reaches[point - points_.fromFile] = shared::kReach * static_cast<float>(options_.radius);
  }
  if (!changed_.empty() && tool.kind() != BrushKind::paint) build();
}

DVec3 SculptReference::smoothed(const BrushTool& tool, std::uint32_t point) const {
  const DVec3 place(points_.positions[point]);
  const SurfaceOptions options{.radius = options_.radius, .kind = SurfaceKind::sphere};
  return tool.smoothed(place, surfaceOf(options, DVec3(points_.normals[point]), [&](double radius, auto&& visit) {
                         grid_.forEachNear(place, radius, [&](const SortedGrid::Placed& near) {
                           visit(DVec3(near.position) - place, points_.normals[near.number]);
                         });
                       }));
}

void SculptReference::findUnsettled() {
  unsettled_.clear();
  for (std::uint32_t i = 0; i < points_.size(); ++i)
    if (points_.unsettled[i] && points_.there[i]) unsettled_.push_back(i);
}

Vec3 SculptReference::refitted(std::uint32_t point) const {
  const DVec3 place(points_.positions[point]);
  NormalFit fit(options_.radius);
  DVec3 side(0);
  const Vec3 old = points_.normals[point];
  grid_.forEachNear(place, options_.radius, [&](const SortedGrid::Placed& near) {
    const Vec3 theirs = points_.normals[near.number];
    const double share = shared::fitShare(glm::dot(theirs, old));
    if (share <= 0) return;
    const DVec3 offset = DVec3(near.position) - place;
    fit.add(offset, share);
    side += share * wendland(glm::length(offset) / options_.radius) * DVec3(theirs);
  });
  const DVec3 normal = fit.normal(DVec3(old)).normal;
  return Vec3(glm::dot(normal, side) < 0 ? -normal : normal);
}

// The side of a normal is the one that most normals around it are on: at a fresh edge a normal may turn by a right
// angle in one tick, and its own old side says nothing then. The far sheet of a plate has no say.
void SculptReference::refit() {
  normals_.resize(unsettled_.size());
  forEachOf(grid_.team(), unsettled_.size(), [&](std::size_t i) { normals_[i] = refitted(unsettled_[i]); });
  for (std::size_t i = 0; i < unsettled_.size(); ++i) {
    Vec3& normal = points_.normals[unsettled_[i]];
    if (normal != normals_[i]) tellOf(unsettled_[i]);
    normal = normals_[i];
  }
}

ResampleWish SculptReference::wishOf(std::uint32_t point, Neighbours& neighbours) const {
  const auto seen = [&](std::uint32_t number, const DVec3& offset) {
    return ResampleNeighbour{.offset = offset,
                             .normal = DVec3(points_.normals[number]),
                             .rest = DVec3(points_.rests[number]),
                             .spacing = points_.spacing(number),
                             .isNew = number >= points_.fromFile,
                             .atRest = isAtRest(number),
                             .number = number,
                             .unsettled = points_.unsettled[number] != 0};
  };
  neighbours.clear();
  const DVec3 place(points_.positions[point]);
  const double look = shared::lookRadius(static_cast<float>(points_.spacing(point)), static_cast<float>(options_.radius));
  bool complete = true;
  grid_.forEachNear(place, look, [&](const SortedGrid::Placed& near) {
    if (near.number == point) return;
    if (neighbours.size() < kMostNeighbours)
      neighbours.push_back(seen(near.number, DVec3(near.position) - place));
    else
      complete = false;
  });
  return resampleWish(seen(point, DVec3(0)), {.neighbours = neighbours, .reach = reachOf(point), .complete = complete, .carves = carves_});
}

void SculptReference::resample() {
  wishes_.resize(unsettled_.size());
  forEachOf(grid_.team(), unsettled_.size(), [&](std::size_t i) {
    thread_local Neighbours neighbours;
    static_cast<ResampleWish&>(wishes_[i]) = wishOf(unsettled_[i], neighbours);
    if (!wishes_[i].inserts) return;
    wishes_[i].place = Vec3(DVec3(points_.positions[unsettled_[i]]) + wishes_[i].offset);
    wishes_[i].reach = static_cast<float>(reachOf(unsettled_[i]) - glm::length(wishes_[i].offset));
  });
  const std::size_t before = points_.size();
  bool someGone = false;
  settled_ = true;
  for (std::size_t i = 0; i < unsettled_.size(); ++i) {
    const std::uint32_t point = unsettled_[i];
    points_.unsettled[point] = wishes_[i].unsettled;
    settled_ = settled_ && !wishes_[i].unsettled;
    if (!wishes_[i].goes) continue;
    points_.there[point] = 0;
    someGone = true;
    tellOf(point);
  }
  insertClaimed();
  if (someGone || points_.size() > before) build();
}

void SculptReference::insertClaimed() {
  claims_.clear();
  const auto forEachWish = [&](auto&& visit) {
    for (std::size_t i = 0; i < unsettled_.size(); ++i)
      if (wishes_[i].inserts) visit(unsettled_[i], wishes_[i]);
  };
  forEachWish([&](std::uint32_t point, const Wish& wish) { claims_.claim(wish.place, point); });
  forEachWish([&](std::uint32_t point, const Wish& wish) { claims_.confirm(wish.place, point); });
  forEachWish([&](std::uint32_t point, const Wish& wish) {
    if (!claims_.stands(wish.place, point)) return;
    const std::uint32_t parent = wish.takesAfterOther ? wish.other : point;
    const std::uint32_t added = points_.insertBetween(point, wish.other, parent, wish.place);
    points_.reaches[added - points_.fromFile] = wish.reach;
    tellOf(added);
  });
}

}  // namespace palpate
