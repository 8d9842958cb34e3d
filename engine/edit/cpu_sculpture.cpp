#include "engine/edit/cpu_sculpture.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/check.hpp"
#include "engine/core/clock.hpp"
#include "engine/edit/normal_fit.hpp"
#include "shaders/shared/contact.h"

namespace palpate {

namespace {

// Fewest points that a thread takes at a time: as many as take longer than to wake it. A gather takes microseconds,
// most brushes some ten nanoseconds.
constexpr std::size_t kFewestGathers = 8, kFewestBrushed = 512;
constexpr std::size_t kAhead = 8;  // points whose memory is fetched ahead of a brush
constexpr std::size_t kTurns = 8;  // of a thread, so that all end at about the same time
// Number of neighbours that a point examines before it decides on insertion or removal. More are within its
// neighbourhood radius only where many points coincide: they are merged with the examined ones, and no new point is
// requested.
constexpr std::size_t kMaxNeighbours = 2048;
// Maximum number of points that get normals and are resampled in one edit: this many, or this share of all, whichever
// is more; the others follow in later edits.
constexpr std::size_t kMaxAtOnce = 1024, kShareAtOnce = 16;

// Calls body(i) for every i below `count`, on all threads; a thread takes `fewest` at a time, or more.
template <class Body>
void forEachOf(WorkerTeam& team, std::size_t count, std::size_t fewest, Body&& body) {
  const std::size_t batch = std::max(fewest, count / (kTurns * team.size()));
  team.forEach((count + batch - 1) / batch, [&](std::size_t k) {
    const std::size_t end = std::min(count, (k + 1) * batch);
    for (std::size_t i = k * batch; i < end; ++i) body(i);
  });
}

// Insertions nearer to each other than this spacing requires wait for each other.
double claimSpacing(const SculptOptions& options) {
  return options.radius / static_cast<double>(shared::kSupportSpacings);
}

}  // namespace

CpuSculpture::CpuSculpture(const PointCloud& cloud, const HashGrid& grid, const SculptOptions& options)
    : options_(options), points_(cloud), grid_(grid, options.threads), claims_(claimSpacing(options)) {
  PALPATE_CHECK_LT(0.0, options.radius);
  const Stopwatch watch;
  grid_.build(points_.positions, points_.there);
  buildTime_us_ = watch.elapsed_us();
  isChanged_.reserve(points_.positions.capacity());
  isChanged_.resize(points_.size());
  if (options.resample) measureSpacings();
}

double CpuSculpture::spacingAt(std::uint32_t point, std::span<const std::uint8_t> counts) const {
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
  return std::max(shared::spacingFrom(options_.radius, std::max(weights, static_cast<double>(shared::kMinWeights))),
                  sectorSpacing(nearest));
}

void CpuSculpture::measureSpacings() {
  const double least = static_cast<double>(shared::kMinSpacing) * options_.radius;
  const double most = static_cast<double>(shared::kMaxSpacing) * options_.radius;
  std::vector<std::uint8_t> counts(points_.size());  // nonzero: the first of coincident points
  forEachOf(grid_.team(), points_.size(), kFewestGathers, [&](std::size_t i) {
    counts[i] = 1;
    grid_.forEachNear(DVec3(points_.positions[i]), least,
                      [&](const SortedGrid::Placed& near) { counts[i] = counts[i] && near.number >= i; });
  });
  points_.spacings.resize(points_.size());
  forEachOf(grid_.team(), points_.size(), kFewestGathers, [&](std::size_t i) {
    points_.spacings[i] = static_cast<float>(std::clamp(spacingAt(static_cast<std::uint32_t>(i), counts), least, most));
  });
}

bool CpuSculpture::isAtRest(std::uint32_t point) const {
  return glm::distance(points_.positions[point], points_.rests[point]) <=
         shared::kAtRest * static_cast<float>(points_.spacing(point));
}

float CpuSculpture::mostReach() const { return shared::kReach * static_cast<float>(options_.radius); }

// A new point with less reach than a brush gives is still where it was inserted.
bool CpuSculpture::isMoved(std::uint32_t point) const {
  return point < points_.fromFile ? !isAtRest(point) : points_.reaches[point - points_.fromFile] == mostReach();
}

double CpuSculpture::reachOf(std::uint32_t point) const {
  if (point >= points_.fromFile) return double{points_.reaches[point - points_.fromFile]};
  return double{mostReach()};
}

void CpuSculpture::edit(const PlacedBrush& brush) {
  for (const std::uint32_t point : changed_) isChanged_[point] = 0;
  changed_.clear();
  measure_ = {};
  takeSwallowed();
  carves_ = brush.kind() == BrushKind::carve;
  fills_ = brush.fills();
  claims_.begin(brush.stroke());
  pushes_.reset();
  cuts_.reset();
  if (carves_ && brush.acts() && resamples(brush)) cuts_ = brush;
  if ((brush.kind() == BrushKind::push || brush.kind() == BrushKind::grab) && brush.acts()) pushes_ = brush;
  if (brush.acts()) applyBrush(brush);
  findUnsettled();
  refit();
  settled_ = !someWait_;
  if (resamples(brush))
    resample();
  else
    for (const std::uint32_t point : unsettled_) points_.unsettled[point] = 0;
  std::erase_if(waiting_, [&](std::uint32_t point) { return !points_.unsettled[point]; });
}

void CpuSculpture::takeSwallowed() {
  for (const std::uint32_t point : swallowed_)
    if (points_.there[point]) remove(point);
  swallowed_.clear();
  followInIndex();
}

void CpuSculpture::set(std::span<const PointChange> changes) {
  for (const PointChange& change : changes) {
    points_.set(change.to);
    strayed_.push_back(change.to.number());
  }
  for (const std::uint32_t point : waiting_) points_.unsettled[point] = 0;
  waiting_.clear();
  swallowed_.clear();
  settled_ = true;
  someWait_ = false;
  followInIndex();
}

void CpuSculpture::followInIndex() {
  if (strayed_.empty()) return;
  const std::uint64_t builds = grid_.builds();
  if (options_.index == IndexFollow::rebuild)
    grid_.build(points_.positions, points_.there);
  else
    grid_.update(points_.positions, points_.there, strayed_);
  followed_ += grid_.builds() == builds;
  strayed_.clear();
}

void CpuSculpture::setUnsettled(std::uint32_t point) {
  if (std::exchange(points_.unsettled[point], 1) == 0) waiting_.push_back(point);
}

void CpuSculpture::remove(std::uint32_t point) {
  points_.there[point] = 0;
  strayed_.push_back(point);
  tellOf(point);
}

void CpuSculpture::tellOf(std::uint32_t point) {
  isChanged_.resize(points_.size(), 0);
  if (std::exchange(isChanged_[point], 1) == 0) changed_.push_back(point);
}

// Every point reads the previous positions of the others.
void CpuSculpture::applyBrush(const PlacedBrush& brush) {
  reached_.clear();
  grid_.forEachNear(brush.center(), brush.radius(),
                    [&](const SortedGrid::Placed& point) { reached_.push_back(point.number); });
  places_.resize(reached_.size());
  const bool smooths = brush.kind() == BrushKind::smooth, paints = brush.kind() == BrushKind::paint;
  forEachOf(grid_.team(), reached_.size(), smooths ? kFewestGathers : kFewestBrushed, [&](std::size_t i) {
    const std::uint32_t point = reached_[i];
    if (i + kAhead < reached_.size()) points_.prefetch(reached_[i + kAhead]);
    if (smooths)
      places_[i] = {smoothed(brush, point)};
    else
      places_[i] = brush.brushed(DVec3(points_.positions[point]), DVec3(points_.normals[point]), found(brush, point));
  });
  measure(brush);
  for (std::size_t i = 0; i < reached_.size(); ++i) {
    const std::uint32_t point = reached_[i];
    const Vec3 place(places_[i].position);
    const std::uint32_t before = points_.colors[point];
    const std::uint32_t color =
        paints ? brush.painted(DVec3(points_.positions[point]), found(brush, point), before) : before;
    if (places_[i].taken && cuts_) {  // removed with the next edit, so that the near sheet still sees the far one
      swallowed_.push_back(point);
      continue;
    }
    const bool moved = place != points_.positions[point];
    if (moved) points_.founds[point] = points_.found(point, brush.stroke());
    if (moved || places_[i].taken || color != before) tellOf(point);
    points_.positions[point] = place;
    points_.colors[point] = color;
    points_.there[point] = !places_[i].taken;
    if (moved || places_[i].taken) strayed_.push_back(point);
    if (!moved) continue;
    setUnsettled(point);
    if (point >= points_.fromFile) points_.reaches[point - points_.fromFile] = mostReach();
  }
  followInIndex();
}

PlacedBrush::Found CpuSculpture::found(const PlacedBrush& brush, std::uint32_t point) const {
  const SculptedPoints::Found found = points_.found(point, brush.stroke());
  return {DVec3(found.position), DVec3(found.normal)};
}

void CpuSculpture::measure(const PlacedBrush& brush) {
  for (const std::uint32_t point : reached_)
    if (brush.measures(point))
      brush.measure(DVec3(points_.positions[point]), DVec3(points_.normals[point]), found(brush, point), measure_);
}

DVec3 CpuSculpture::smoothed(const PlacedBrush& brush, std::uint32_t point) const {
  const DVec3 place(points_.positions[point]);
  const SurfaceOptions options{.radius = options_.radius, .kind = SurfaceKind::sphere};
  return brush.smoothed(place, found(brush, point),
                        surfaceOf(options, DVec3(points_.normals[point]), [&](double radius, auto&& visit) {
                          grid_.forEachNear(place, radius, [&](const SortedGrid::Placed& near) {
                            visit(DVec3(near.position) - place, points_.normals[near.number]);
                          });
                        }));
}

void CpuSculpture::findUnsettled() {
  std::erase_if(waiting_, [&](std::uint32_t point) { return !points_.there[point]; });
  std::ranges::sort(waiting_);
  unsettled_ = waiting_;
  const std::size_t most = std::max(kMaxAtOnce, std::size_t{points_.fromFile} / kShareAtOnce);
  someWait_ = unsettled_.size() > most;
  if (!someWait_) return;
  // Those that have waited longest: cycles through all in the order of their numbers.
  const auto next = std::ranges::lower_bound(unsettled_, nextUnsettled_);
  std::rotate(unsettled_.begin(), next, unsettled_.end());
  nextUnsettled_ = unsettled_[most];
  unsettled_.resize(most);
  std::ranges::sort(unsettled_);
}

Vec3 CpuSculpture::refitted(std::uint32_t point) const {
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

// A normal takes the side of most normals around it: at a fresh edge a normal may rotate by a right angle in one tick,
// and its previous side is then meaningless. The far sheet of a plate does not count.
void CpuSculpture::refit() {
  normals_.resize(unsettled_.size());
  forEachOf(grid_.team(), unsettled_.size(), kFewestGathers,
            [&](std::size_t i) { normals_[i] = refitted(unsettled_[i]); });
  for (std::size_t i = 0; i < unsettled_.size(); ++i) {
    Vec3& normal = points_.normals[unsettled_[i]];
    if (normal != normals_[i]) tellOf(unsettled_[i]);
    normal = normals_[i];
  }
}

std::optional<DVec3> CpuSculpture::pushedFrom(std::uint32_t point) const {
  if (!pushes_ || points_.founds[point].stroke != pushes_->stroke()) return std::nullopt;
  return pushes_->outward();
}

ResampleRequest CpuSculpture::requestOf(std::uint32_t point, Neighbours& neighbours) const {
  const auto seen = [&](std::uint32_t number, const DVec3& offset) {
    return ResampleNeighbour{.offset = offset,
                             .normal = DVec3(points_.normals[number]),
                             .rest = DVec3(points_.rests[number]),
                             .spacing = points_.spacing(number),
                             .isNew = number >= points_.fromFile,
                             .atRest = carves_ && isAtRest(number),
                             .number = number,
                             .unsettled = points_.unsettled[number] != 0};
  };
  neighbours.clear();
  const DVec3 place(points_.positions[point]);
  const double radius =
      shared::neighbourhoodRadius(static_cast<float>(points_.spacing(point)), static_cast<float>(options_.radius));
  bool complete = true;
  grid_.forEachNear(place, radius, [&](const SortedGrid::Placed& near) {
    if (near.number == point) return;
    if (neighbours.size() < kMaxNeighbours)
      neighbours.push_back(seen(near.number, DVec3(near.position) - place));
    else
      complete = false;
  });
  const SculptedPoints::Found as = cuts_ ? points_.found(point, cuts_->stroke()) : SculptedPoints::Found{};
  return resampleRequest(seen(point, DVec3(0)),
                         {.neighbours = neighbours,
                          .reach = reachOf(point),
                          .fills = fills_ && complete,
                          .carves = carves_,
                          .moved = isMoved(point),
                          .pushedFrom = pushedFrom(point),
                          .found = DVec3(as.position) - place,
                          .foundNormal = DVec3(as.normal),
                          .thick = cuts_ ? double{as.thick} : std::numeric_limits<double>::infinity(),
                          .claims = &claims_,
                          .place = place});
}

void CpuSculpture::resample() {
  requests_.resize(unsettled_.size());
  forEachOf(grid_.team(), unsettled_.size(), kFewestGathers, [&](std::size_t i) {
    thread_local Neighbours neighbours;
    static_cast<ResampleRequest&>(requests_[i]) = requestOf(unsettled_[i], neighbours);
    if (!requests_[i].inserts) return;
    requests_[i].place = Vec3(DVec3(points_.positions[unsettled_[i]]) + requests_[i].offset);
    requests_[i].reach = static_cast<float>(reachOf(unsettled_[i]) - glm::length(requests_[i].offset));
  });
  for (std::size_t i = 0; i < unsettled_.size(); ++i) {
    const std::uint32_t point = unsettled_[i];
    points_.unsettled[point] = requests_[i].unsettled;
    // From now on it counts as part of the sheet that it has reached.
    if (requests_[i].stops) points_.founds[point].normal = Vec3(-pushes_->outward());
    if (requests_[i].thick && cuts_ && points_.founds[point].stroke == cuts_->stroke())
      points_.founds[point].thick = static_cast<float>(*requests_[i].thick);
    settled_ = settled_ && !requests_[i].unsettled;
    if (requests_[i].goes) remove(point);
  }
  insertClaimed();
  followInIndex();
}

void CpuSculpture::insertClaimed() {
  const auto forEachRequest = [&](auto&& visit) {
    for (std::size_t i = 0; i < unsettled_.size(); ++i)
      if (requests_[i].inserts) visit(unsettled_[i], requests_[i]);
  };
  forEachRequest([&](std::uint32_t point, const Request& request) { claims_.claim(request.place, point); });
  forEachRequest([&](std::uint32_t point, const Request& request) { claims_.confirm(request.place, point); });
  forEachRequest([&](std::uint32_t point, const Request& request) {
    if (!claims_.stands(request.place, point)) return;
    claims_.grant(request.place);
    const std::uint32_t parent = request.takesAfterOther ? request.other : point;
    const std::uint32_t added = points_.insertBetween(point, request.other, parent, request.place);
    points_.reaches[added - points_.fromFile] = request.reach;
    waiting_.push_back(added);
    strayed_.push_back(added);
    tellOf(added);
  });
}

}  // namespace palpate
