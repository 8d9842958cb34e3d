#include "engine/edit/cpu_sculpture.hpp"

#include <algorithm>
#include <numbers>
#include <utility>

#include "engine/core/check.hpp"
#include "engine/core/clock.hpp"
#include "engine/edit/normal_refit.hpp"
#include "engine/edit/spacing_measure.hpp"
#include "shaders/shared/contact.h"

namespace palpate {

namespace {

constexpr std::size_t kFewestCells = 64;  // that a thread takes at a time
constexpr std::size_t kAhead = 8;         // points whose memory is fetched ahead of a brush
constexpr std::size_t kTurns = 8;  // parts of the work that a thread takes, so that all end at about the same time
// Maximum number of points that get normals and are resampled in one edit: this many, or this share of all, whichever
// is more; the others follow in later edits.
constexpr std::size_t kMaxAtOnce = 1024, kShareAtOnce = 16;
// The same in an edit that fits into a tick: the sum of the work of its points, which is 1 for each neighbour and
// kOwnWork for the point itself.
constexpr double kTickWork = 60'000, kOwnWork = 192;
constexpr std::size_t kFewestAtOnce = 32;
// Work for which another thread is woken, and that of looking at a point under the brush.
constexpr double kThreadWork = 4000, kLookWork = 11;
// Priority, in support radii, that a waiting point gains with each edit, so that every point has its turn.
constexpr float kWaitStrain = 1.0f / 512;

// Calls body(i) for every i below `count`, on all threads; a thread takes `fewest` at a time, or more.
template <class Body>
void forEachOf(WorkerTeam& team, std::size_t count, std::size_t fewest, Body&& body) {
  const std::size_t batch = std::max(fewest, count / (kTurns * team.size()));
  team.forEach((count + batch - 1) / batch, [&](std::size_t k) {
    const std::size_t end = std::min(count, (k + 1) * batch);
    for (std::size_t i = k * batch; i < end; ++i) body(i);
  });
}

// As many threads as the work is worth, which are woken while it begins.
void engage(WorkerTeam::Burst& burst, double work) { burst.engage(static_cast<std::size_t>(1 + work / kThreadWork)); }

// Insertions nearer to each other than this spacing requires wait for each other.
double claimSpacing(const SculptOptions& options) {
  return options.radius / static_cast<double>(shared::kSupportSpacings);
}

// Work of looking at the points under a brush on an even surface.
double workUnder(const PlacedBrush& brush, const SculptOptions& options) {
  const double radius_spacings = brush.radius() / claimSpacing(options);
  return kLookWork * std::numbers::pi * radius_spacings * radius_spacings;
}

}  // namespace

CpuSculpture::CpuSculpture(const PointCloud& cloud, const HashGrid& grid, const SculptOptions& options)
    : options_(options),
      points_(cloud),
      grid_(grid, options.threads, SortedGrid::CellTags::on),
      claims_(claimSpacing(options)),
      workOfPoint_(kTickWork / kFewestAtOnce) {
  PALPATE_CHECK_LT(0.0, options.radius);
  const Stopwatch watch;
  grid_.build(points_.positions, points_.there);
  buildTime_us_ = watch.elapsed_us();
  isChanged_.reserve(points_.positions.capacity());
  strains_.reserve(points_.positions.capacity());
  makeRoom();
  if (options.resample) measureSpacings();
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
  // In the order of the index, so that points of a cell are together.
  constexpr std::size_t kPart = 4096;
  const std::span<const SortedGrid::Placed> all = grid_.placed();
  grid_.team().forEach((all.size() + kPart - 1) / kPart, [&](std::size_t part) {
    thread_local CellGroups groups;
    thread_local SpacingMeasure measure;
    const std::span<const SortedGrid::Placed> points =
        all.subspan(part * kPart, std::min(kPart, all.size() - part * kPart));
    groups.assign(grid_.grid(), points.size(),
                  [&](std::size_t i) { return std::pair(DVec3(points[i].position), options_.radius); });
    for (const CellGroups::Group& group : groups.groups()) {
      measure.gather(grid_, group.balls, points_.normals, counts);
      for (const std::uint32_t i : groups.members(group)) {
        const std::uint32_t point = points[i].number;
        const double spacing = measure.at(DVec3(points[i].position), DVec3(points_.normals[point]), options_.radius);
        points_.spacings[point] = static_cast<float>(std::clamp(spacing, least, most));
      }
    }
  });
  for (const float spacing : points_.spacings) widestSpacing_ = std::max(widestSpacing_, double{spacing});
}

bool CpuSculpture::isAtRest(std::uint32_t point) const {
  return glm::distance(points_.positions[point], points_.rests[point]) <=
         shared::kAtRest * static_cast<float>(points_.spacing(point));
}

float CpuSculpture::mostReach() const { return shared::kReach * static_cast<float>(options_.radius); }

// A new point has been moved if its reach is that which a brush gives: an inserted one has less.
bool CpuSculpture::isMoved(std::uint32_t point) const {
  return point < points_.fromFile ? !isAtRest(point) : points_.reaches[point - points_.fromFile] == mostReach();
}

double CpuSculpture::reachOf(std::uint32_t point) const {
  if (point >= points_.fromFile) return double{points_.reaches[point - points_.fromFile]};
  return double{mostReach()};
}

void CpuSculpture::edit(const PlacedBrush& brush, EditSize size) {
  WorkerTeam::Burst burst(grid_.team());
  if (brush.acts()) engage(burst, workUnder(brush, options_));
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
  findUnsettled(size);
  engage(burst, workOfPoint_ * static_cast<double>(unsettled_.size()));
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
  makeRoom();
  for (const std::uint32_t point : waiting_) points_.unsettled[point] = 0;
  for (const std::uint32_t point : waiting_) strains_[point] = 0;
  waiting_.clear();
  swallowed_.clear();
  settled_ = true;
  someWait_ = false;
  backlog_ = {};
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

// For points that were added.
void CpuSculpture::makeRoom() {
  isChanged_.resize(points_.size());
  strains_.resize(points_.size());
}

void CpuSculpture::tellOf(std::uint32_t point) {
  if (std::exchange(isChanged_[point], 1) == 0) changed_.push_back(point);
}

void CpuSculpture::applyBrush(const PlacedBrush& brush) {
  reach(brush);
  const std::size_t layers = grid_.layers(brush.center(), brush.radius());
  for (const Layer& layer : std::span(layers_).first(layers)) {
    measure_.add(layer.measure);
    for (const Brushed& brushed : layer.brushed) apply(brush, brushed);
  }
  followInIndex();
}

void CpuSculpture::apply(const PlacedBrush& brush, const Brushed& to) {
  const std::uint32_t point = to.number;
  if (to.taken && cuts_) {  // removed with the next edit, so that the near sheet still sees the far one
    swallowed_.push_back(point);
    return;
  }
  tellOf(point);
  points_.colors[point] = to.color;
  const Vec3 place(to.position);
  const bool moved = place != points_.positions[point];
  if (!moved && !to.taken) return;
  strayed_.push_back(point);
  points_.there[point] = !to.taken;
  if (!moved) return;
  strain(point, glm::distance(place, points_.positions[point]));
  points_.setFound(point, points_.found(point, brush.stroke()));
  points_.positions[point] = place;
  setUnsettled(point);
  if (point >= points_.fromFile) points_.reaches[point - points_.fromFile] = mostReach();
}

PlacedBrush::Found CpuSculpture::found(const PlacedBrush& brush, std::uint32_t point) const {
  return found(brush, point, points_.positions[point]);
}

PlacedBrush::Found CpuSculpture::found(const PlacedBrush& brush, std::uint32_t point, const Vec3& place) const {
  // Without a copy of the state: it would be written and read back in parts of other sizes, which stalls.
  if (points_.strokes[point] != brush.stroke()) return {DVec3(place), DVec3(points_.normals[point])};
  const SculptedPoints::FoundState& found = points_.founds[point];
  return {DVec3(found.position), DVec3(found.normal)};
}

// Finds the points that the brush changes, and measures the surface under it. Every point reads the previous positions
// of the others.
void CpuSculpture::reach(const PlacedBrush& brush) {
  const std::size_t layers = grid_.layers(brush.center(), brush.radius());
  layers_.resize(std::max(layers_.size(), layers));
  forEachOf(grid_.team(), layers, std::max<std::size_t>(1, kFewestCells / (layers * layers)),
            [&](std::size_t k) { reach(brush, k, layers_[k]); });
}

void CpuSculpture::reach(const PlacedBrush& brush, std::size_t number, Layer& layer) const {
  layer.reached.clear();
  layer.measured.clear();
  layer.measure = {};
  grid_.forEachNear(brush.center(), brush.radius(), number, [&](const SortedGrid::Placed& near) {
    if (brush.measures(near.number)) layer.measured.push_back(near);
    if (brush.mayAffect(DVec3(near.position))) layer.reached.push_back(near.number);
  });
  for (std::size_t i = 0; i < layer.measured.size(); ++i) {
    if (i + 2 * kAhead < layer.measured.size()) points_.prefetchNormal(layer.measured[i + 2 * kAhead].number);
    if (i + kAhead < layer.measured.size()) points_.prefetchFound(layer.measured[i + kAhead].number, brush.stroke());
    const auto& [place, point] = layer.measured[i];
    brush.measure(DVec3(place), DVec3(points_.normals[point]), found(brush, point, place), layer.measure);
  }
  brushEach(brush, layer);
}

void CpuSculpture::brushEach(const PlacedBrush& brush, Layer& layer) const {
  const bool smooths = brush.kind() == BrushKind::smooth, paints = brush.kind() == BrushKind::paint;
  layer.brushed.clear();
  for (std::size_t i = 0; i < layer.reached.size(); ++i) {
    const std::uint32_t point = layer.reached[i], before = points_.colors[point];
    if (i + kAhead < layer.reached.size()) points_.prefetch(layer.reached[i + kAhead]);
    const DVec3 place(points_.positions[point]);
    const PlacedBrush::Found as = found(brush, point);
    const PlacedBrush::Point to =
        smooths ? PlacedBrush::Point{smoothed(brush, point)} : brush.brushed(place, DVec3(points_.normals[point]), as);
    const std::uint32_t color = paints ? brush.painted(place, as, before) : before;
    if (to.taken || color != before || Vec3(to.position) != points_.positions[point])
      layer.brushed.push_back({to, point, color});
  }
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

void CpuSculpture::strain(std::uint32_t point, float by) { strains_[point] += by; }

std::size_t CpuSculpture::mostAtOnce(EditSize size) const {
  if (size == EditSize::tick) return std::max(kFewestAtOnce, static_cast<std::size_t>(kTickWork / workOfPoint_));
  return std::max(kMaxAtOnce, std::size_t{points_.fromFile} / kShareAtOnce);
}

// Those that have moved furthest since their last turn, so that no gap becomes too wide to be filled.
void CpuSculpture::findUnsettled(EditSize size) {
  std::erase_if(waiting_, [&](std::uint32_t point) { return !points_.there[point]; });
  unsettled_ = waiting_;
  const std::size_t most = mostAtOnce(size);
  someWait_ = unsettled_.size() > most;
  backlog_ = {};
  if (someWait_) {
    const auto isFirst = [&](std::uint32_t a, std::uint32_t b) {
      return strains_[a] != strains_[b] ? strains_[a] > strains_[b] : a < b;
    };
    const auto end = unsettled_.begin() + static_cast<std::ptrdiff_t>(most);
    std::ranges::nth_element(unsettled_, end, isFirst);
    backlog_ = {.strain = double{strains_[*end]} / options_.radius, .waits = true};
    for (auto waiting = end; waiting != unsettled_.end(); ++waiting)
      strains_[*waiting] += kWaitStrain * static_cast<float>(options_.radius);
    unsettled_.erase(end, unsettled_.end());
  }
  for (const std::uint32_t point : unsettled_) strains_[point] = 0;
  std::ranges::sort(unsettled_);
}

void CpuSculpture::refit() {
  normals_.resize(unsettled_.size());
  // No neighbourhood of a point is wider, also after rounding.
  const double radius = std::max(options_.radius, double{static_cast<float>(options_.radius)});
  groups_.assign(grid_.grid(), unsettled_.size(),
                 [&](std::size_t i) { return std::pair(DVec3(points_.positions[unsettled_[i]]), radius); });
  surroundings_.resize(std::max(surroundings_.size(), groups_.groups().size()));
  groups_.forEachPart(grid_.team(), kFewestGathers, [&](std::size_t first, std::span<const CellGroups::Group> part) {
    thread_local NormalRefit refit;
    thread_local NearPoints near;
    for (const CellGroups::Group& group : part) {
      Surroundings& around = surroundings_[first++];
      around.points.gather(grid_, group.balls);
      around.near.clear();
      around.closest.clear();
      refit.gather(around.points, points_.normals);
      for (const std::uint32_t i : groups_.members(group)) {
        const std::uint32_t point = unsettled_[i];
        around.points.near(DVec3(points_.positions[point]), radius, near, std::min(radius, closestOf(point)));
        refit.add(i, near, points_.normals[point], options_.radius);
        around.near.add(near.indices());
        around.closest.add(near.closest());
      }
    }
    refit.solve(normals_);
  });
  double work = 0;
  for (std::size_t k = 0; k < groups_.groups().size(); ++k)
    work += kOwnWork * groups_.groups()[k].count + static_cast<double>(surroundings_[k].near.size());
  if (!unsettled_.empty()) workOfPoint_ = work / static_cast<double>(unsettled_.size());
  for (std::size_t i = 0; i < unsettled_.size(); ++i) {
    Vec3& normal = points_.normals[unsettled_[i]];
    if (normal != normals_[i]) tellOf(unsettled_[i]);
    normal = normals_[i];
  }
}

}  // namespace palpate
