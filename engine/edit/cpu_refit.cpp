// Which of a CpuSculpture's unsettled points have their turn in an edit, and their new normals.
#include <algorithm>
#include <utility>

#include "engine/edit/cpu_sculpture.hpp"
#include "engine/edit/normal_refit.hpp"
#include "shaders/shared/carried_normal.h"

namespace palpate {

namespace {

// Parts of the work that a thread takes, and the fewest points of a part: points of a cell in two parts are gathered
// for twice.
constexpr std::size_t kTurnsToRefit = 3, kFewestToRefit = 16;
// Maximum number of points that get normals and are resampled in one edit: this many, or this share of all, whichever
// is more; the others follow in later edits.
constexpr std::size_t kMaxAtOnce = 1024, kShareAtOnce = 16;
// Work of a point is 1 for each neighbour, and this for the point itself.
constexpr double kOwnWork = 192;
// Work of an edit of a crowded cloud, in a tick and at leisure: it is limited by the points in the cells around each,
// before these are visited.
constexpr double kCrowdedTickWork = 120'000, kCrowdedWork = 2'000'000;
// Priority, in support radii, that a waiting point gains with each edit, so that every point has its turn.
constexpr float kWaitStrain = 1.0f / 512;
// Less than the tool waits for: points that wait for long slow it down, and only those that have moved far stop it.
constexpr float kMaxWaitStrain = 15.0f / 32;

}  // namespace

std::size_t CpuSculpture::mostAtOnce(EditSize size) const {
  if (size == EditSize::tick) return std::max(kFewestAtOnce, static_cast<std::size_t>(kTickWork / workOfPoint_));
  return std::max(kMaxAtOnce, std::size_t{points_.fromFile} / kShareAtOnce);
}

double CpuSculpture::mostWorkOf(std::uint32_t point) const {
  const DVec3 place(points_.positions[point]);
  const double radius = searchRadius(point);
  const CellBox box = cellsAround(grid_.grid(), place, radius);
  std::size_t points = 0;
  if (box.cells() > SortedGrid::kFewCells)
    grid_.forEachNear(place, radius, [&](const SortedGrid::Placed&) { ++points; });
  else
    grid_.forEachBucket(box, [&](std::span<const SortedGrid::Placed> bucket) { points += bucket.size(); });
  return kOwnWork + static_cast<double>(points);
}

// How many of the first points an edit of a crowded cloud affords, at least one.
std::size_t CpuSculpture::affordable(std::span<const std::uint32_t> points, EditSize size) const {
  double left = size == EditSize::tick ? kCrowdedTickWork : kCrowdedWork;
  std::size_t count = 0;
  while (count < points.size() && (count == 0 || left > 0)) left -= mostWorkOf(points[count++]);
  return count;
}

// Those that have moved furthest since their last turn, so that no gap becomes too wide to be filled.
void CpuSculpture::findUnsettled(EditSize size) {
  std::erase_if(waiting_, [&](std::uint32_t point) { return !points_.there[point]; });
  unsettled_ = waiting_;
  const auto isFirst = [&](std::uint32_t a, std::uint32_t b) {
    return strains_[a] != strains_[b] ? strains_[a] > strains_[b] : a < b;
  };
  std::size_t most = std::min(mostAtOnce(size), unsettled_.size());
  std::ranges::nth_element(unsettled_, unsettled_.begin() + static_cast<std::ptrdiff_t>(most), isFirst);
  if (crowded_) {
    const std::span<std::uint32_t> first = std::span(unsettled_).first(most);
    std::ranges::sort(first, isFirst);
    most = affordable(first, size);
  }
  someWait_ = unsettled_.size() > most;
  backlog_ = {};
  if (someWait_) {
    const auto end = unsettled_.begin() + static_cast<std::ptrdiff_t>(most);
    const float nextStrain = strains_[*end];
    float furthest = 0;
    for (auto waiting = end; waiting != unsettled_.end(); ++waiting) {
      furthest = std::max(furthest, displacements_[*waiting]);
      strains_[*waiting] += kWaitStrain * static_cast<float>(options_.radius);
    }
    const float waited = std::min(nextStrain, kMaxWaitStrain * static_cast<float>(options_.radius));
    backlog_ = {.strain = double{std::max(furthest, waited)} / options_.radius, .waits = true};
    unsettled_.erase(end, unsettled_.end());
  }
}

std::span<CpuSculpture::Part> CpuSculpture::shareUnsettled() {
  const std::size_t count = unsettled_.size();
  const std::size_t size = std::max(kFewestToRefit, count / (kTurnsToRefit * grid_.threads()));
  const std::size_t parts = (count + size - 1) / size;
  parts_.resize(std::max(parts_.size(), parts));
  for (std::size_t k = 0; k < parts; ++k) {
    parts_[k].first = k * size;
    parts_[k].count = std::min(size, count - k * size);
  }
  return std::span(parts_).first(parts);
}

void CpuSculpture::refit() {
  normals_.resize(unsettled_.size());
  const std::span<Part> parts = shareUnsettled();
  grid_.team().forEach(parts.size(), [&](std::size_t k) { refit(parts[k]); });
  refitWork_ = 0;
  for (const Part& part : parts) refitWork_ += part.work;
  if (!unsettled_.empty()) workOfPoint_ = refitWork_ / static_cast<double>(unsettled_.size());
  crowded_ = crowded_ || workOfPoint_ > kCrowd;
  grid_.team().forEach(parts.size(), [&](std::size_t k) { setNormals(parts[k]); });
  for (const Part& part : parts) changed_.insert(changed_.end(), part.changed.begin(), part.changed.end());
}

void CpuSculpture::setNormals(Part& part) {
  part.changed.clear();
  for (std::size_t i = part.first; i < part.first + part.count; ++i) {
    const std::uint32_t point = unsettled_[i];
    Vec3& normal = points_.normals[point];
    if (normal != normals_[i] && std::exchange(isChanged_[point], 1) == 0) part.changed.push_back(point);
    normal = normals_[i];
  }
}

void CpuSculpture::refit(Part& part) {
  thread_local NormalRefit refit;
  thread_local NearPoints near;
  const std::span<const std::uint32_t> points = std::span(unsettled_).subspan(part.first, part.count);
  for (const std::uint32_t point : points) points_.prefetch(point);
  part.groups.assign(grid_.grid(), points.size(), [&](std::size_t i) {
    return std::pair(DVec3(points_.positions[points[i]]), searchRadius(points[i]));
  });
  part.surroundings.resize(std::max(part.surroundings.size(), part.groups.groups().size()));
  part.work = 0;
  for (const std::uint32_t point : points) points_.prefetchSpacing(point);
  auto at = part.surroundings.begin();
  for (const CellGroups::Group& group : part.groups.groups()) {
    Surroundings& around = *at++;
    around.points.gather(grid_, group.balls);
    around.near.clear();
    around.closest.clear();
    refit.gather(around.points, points_.normals);
    for (const std::uint32_t i : part.groups.members(group)) {
      const std::uint32_t point = points[i];
      strains_[point] = displacements_[point] = 0;
      const double radius = searchRadius(point);
      around.points.near(DVec3(points_.positions[point]), radius, near, std::min(radius, closestOf(point)));
      refit.add(i, near, points_.normals[point], fitRadius(point));
      around.near.push_back(static_cast<std::uint32_t>(near.size()));
      part.work += kOwnWork + static_cast<double>(near.size());
      around.closest.add(near.closest());
    }
  }
  refit.solve(std::span(normals_).subspan(part.first, part.count));
  at = part.surroundings.begin();
  for (const CellGroups::Group& group : part.groups.groups()) {
    const Surroundings& around = *at++;
    for (const std::uint32_t i : part.groups.members(group)) {
      Vec3& normal = normals_[part.first + i];
      normal = onCarriedSide(normal, points[i], around);
    }
  }
}

// A fitted normal on the side to which the stroke has carried the surface.
Vec3 CpuSculpture::onCarriedSide(const Vec3& fitted, std::uint32_t point, const Surroundings& around) const {
  const std::uint32_t stroke = points_.strokes[point];
  const SculptedPoints::FoundState& own = points_.founds[point];
  if (stroke == 0 || glm::dot(fitted, own.normal) > shared::kCarriedFar) return fitted;
  const DVec3 place(points_.positions[point]);
  const double radius = fitRadius(point);
  const auto from = shared::carriedFrom(DVec3(own.position), DVec3(own.normal));
  DVec3 u, v;
  shared::frameAround(DVec3(fitted), u, v);
  shared::CarriedSumsOf<double> sums{};
  thread_local NearPoints near;
  around.points.near(place, radius, near);
  for (const std::uint32_t i : near.indices()) {
    const std::uint32_t number = around.points.numbers()[i];
    if (points_.strokes[number] > stroke) continue;  // moved since by a later one
    const SculptedPoints::Found found = points_.found(number, stroke);
    shared::addCarried(sums, from, around.points.position(i) - place, u, v, DVec3(found.position), DVec3(found.normal),
                       radius);
  }
  return shared::carriedSide(sums) < static_cast<double>(shared::kTurnedOver) ? -fitted : fitted;
}

}  // namespace palpate
