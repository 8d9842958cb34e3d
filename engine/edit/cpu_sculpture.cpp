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

constexpr std::size_t kFewestSlices = 1;  // that a thread takes at a time
constexpr std::size_t kAhead = 8;         // points whose memory is fetched ahead of a brush
constexpr std::size_t kTurns = 8;  // parts of the work that a thread takes, so that all end at about the same time
// The same of unsettled points, of which a part has this many at least: points of a cell in two parts are gathered for
// twice.
constexpr std::size_t kTurnsToRefit = 3, kFewestToRefit = 16;
// Maximum number of points that get normals and are resampled in one edit: this many, or this share of all, whichever
// is more; the others follow in later edits.
constexpr std::size_t kMaxAtOnce = 1024, kShareAtOnce = 16;
// The same in an edit that fits into a tick: the sum of the work of its points, which is 1 for each neighbour and
// kOwnWork for the point itself.
constexpr double kTickWork = 60'000, kOwnWork = 192;
constexpr std::size_t kFewestAtOnce = 32;
// With so many points in a bucket, or so much work for a point, a cloud is crowded: points coincide. The work of its
// edits, in a tick and at leisure, is then limited by the points in the cells around each, before these are visited.
constexpr std::uint32_t kCrowd = 2048;
constexpr double kCrowdedTickWork = 2 * kTickWork, kCrowdedWork = 2'000'000;
// Work for which another thread is woken, and that of looking at a point under the brush.
constexpr double kThreadWork = 4000, kLookWork = 11;
// The same of moving a point, with its place in the index.
constexpr double kMoveWork = 64;
// Priority, in support radii, that a waiting point gains with each edit, so that every point has its turn.
constexpr float kWaitStrain = 1.0f / 512;
// Less than the tool waits for: points that wait for long slow it down, and only those that have moved far stop it.
constexpr float kMaxWaitStrain = 15.0f / 32;
// The same of a point that a stroke moves for the first time.
constexpr float kFirstStrain = 1.0f / 8;

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
std::size_t engage(WorkerTeam::Burst& burst, double work) {
  return burst.engage(static_cast<std::size_t>(1 + work / kThreadWork));
}

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
  for (std::uint32_t bucket = 0; bucket <= grid.bucketMask && !crowded_; ++bucket)
    crowded_ = grid_.bucket(bucket).size() > kCrowd;
  isChanged_.reserve(points_.positions.capacity());
  isBlocked_.reserve(points_.positions.capacity());
  strains_.reserve(points_.positions.capacity());
  displacements_.reserve(points_.positions.capacity());
  makeRoom();
  if (options.measures) setSpacings(std::vector<float>(cloud.size()));
}

void CpuSculpture::setSpacings(std::vector<float> known) {
  points_.spacings = measuredSpacings(grid_, points_.positions, points_.normals, options_.radius, std::move(known));
  for (const float spacing : points_.spacings) widestSpacing_ = std::max(widestSpacing_, double{spacing});
}

CpuSculpture::Kept CpuSculpture::kept(std::uint32_t point) const {
  return {.found = points_.lastFound(point),
          .strain = strains_[point],
          .displacement = displacements_[point],
          .unsettled = points_.unsettled[point] != 0,
          .blocked = isBlocked_[point] != Blocked::no};
}

void CpuSculpture::keep(std::uint32_t point, const Kept& kept) {
  points_.setFound(point, kept.found);
  strains_[point] = kept.strain;
  displacements_[point] = kept.displacement;
  if (kept.unsettled && std::exchange(points_.unsettled[point], 1) == 0) waiting_.push_back(point);
  if (kept.blocked && std::exchange(isBlocked_[point], Blocked::before) == Blocked::no) blocked_.push_back(point);
  blockedBy_ = kept.found.stroke;
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
  PALPATE_CHECK_EQ(points_.spacings.size(), std::size_t{points_.fromFile});
  WorkerTeam::Burst burst(grid_.team());
  // Those that the unsettled points will need wake while the brush is applied: often about as many as last time.
  engaged_.atFirst = engage(burst, brush.acts() ? std::max(workUnder(brush, options_), refitWork_) : 0);
  for (const std::uint32_t point : changed_) isChanged_[point] = 0;
  changed_.clear();
  const bool sameStroke = std::exchange(blockedBy_, brush.stroke()) == brush.stroke();
  std::erase_if(blocked_, [&](std::uint32_t point) {
    const bool stays = sameStroke && isBlocked_[point] != Blocked::no;
    isBlocked_[point] = stays ? Blocked::before : Blocked::no;
    return !stays;
  });
  measure_ = {};
  work_ = 0;
  takeSwallowed();
  carves_ = brush.kind() == BrushKind::carve;
  fills_ = brush.fills();
  claims_.begin(brush.stroke());
  moves_.reset();
  cuts_.reset();
  resamples_ = brush.resamples();
  if (carves_ && brush.acts() && resamples_) cuts_ = brush;
  if (brush.looksAhead() && brush.acts()) moves_ = brush;
  if (brush.acts()) applyBrush(brush);
  findUnsettled(size);
  engaged_.unsettled = engage(burst, workOfPoint_ * static_cast<double>(unsettled_.size()));
  refit();
  work_ += refitWork_;
  settled_ = !someWait_;
  if (resamples_ || moves_)
    examine();
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

void CpuSculpture::receive(std::span<const PointChange> changes) {
  for (const PointChange& change : changes) {
    points_.set(change.to);
    strayed_.push_back(change.to.number());
  }
  std::ranges::sort(strayed_);
  const auto again = std::ranges::unique(strayed_);
  strayed_.erase(again.begin(), again.end());
  makeRoom();
  for (const std::uint32_t point : strayed_) {
    strains_[point] = displacements_[point] = 0;
    isBlocked_[point] = Blocked::no;
  }
  std::erase_if(waiting_, [&](std::uint32_t point) { return !points_.unsettled[point]; });
  followInIndex();
}

void CpuSculpture::set(std::span<const PointChange> changes) {
  for (const std::uint32_t point : waiting_) points_.unsettled[point] = 0;
  for (const std::uint32_t point : waiting_) strains_[point] = displacements_[point] = 0;
  waiting_.clear();
  swallowed_.clear();
  settled_ = true;
  someWait_ = false;
  backlog_ = {};
  receive(changes);
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

void CpuSculpture::remove(std::uint32_t point) {
  points_.there[point] = 0;
  strayed_.push_back(point);
  tellOf(point);
}

// For points that were added.
void CpuSculpture::makeRoom() {
  isChanged_.resize(points_.size());
  isBlocked_.resize(points_.size());
  strains_.resize(points_.size());
  displacements_.resize(points_.size());
}

void CpuSculpture::tellOf(std::uint32_t point) {
  if (std::exchange(isChanged_[point], 1) == 0) changed_.push_back(point);
}

// Measures the surface under the brush, and changes points. Every point reads the previous positions of the others,
// those in the index.
void CpuSculpture::applyBrush(const PlacedBrush& brush) {
  const std::size_t slices = grid_.slices(brush.center(), brush.radius());
  slices_.resize(std::max(slices_.size(), slices));
  forEachOf(grid_.team(), slices, kFewestSlices, [&](std::size_t k) { this->brush(brush, k, slices_[k]); });
  const auto append = [](std::vector<std::uint32_t>& to, const std::vector<std::uint32_t>& more) {
    to.insert(to.end(), more.begin(), more.end());
  };
  for (const Slice& slice : std::span(slices_).first(slices)) {
    work_ += kLookWork * static_cast<double>(slice.reached.size() + slice.measured.size()) +
             kMoveWork * static_cast<double>(slice.strayed.size()) + static_cast<double>(slice.smoothed);
    if (!slice.measured.empty()) measure_.add(slice.measure);
    measure_.blocked += slice.blockedMoves;
    for (const std::uint32_t point : slice.blocked)
      if (std::exchange(isBlocked_[point], Blocked::now) == Blocked::no) blocked_.push_back(point);
    append(changed_, slice.changed);
    append(strayed_, slice.strayed);
    append(waiting_, slice.waiting);
    append(swallowed_, slice.swallowed);
  }
  followInIndex();
}

void CpuSculpture::apply(const PlacedBrush& brush, std::uint32_t point, const PlacedBrush::Point& to, Slice& slice) {
  if (to.taken && cuts_) {  // removed with the next edit, so that the near sheet still sees the far one
    slice.swallowed.push_back(point);
    return;
  }
  if (std::exchange(isChanged_[point], 1) == 0) slice.changed.push_back(point);
  const Vec3 place(to.position);
  const bool moved = place != points_.positions[point];
  if (!moved && !to.taken) return;
  slice.strayed.push_back(point);
  if (to.taken) points_.there[point] = 0;
  if (!moved) return;
  const float displacement = glm::distance(place, points_.positions[point]);
  displacements_[point] += displacement;
  strains_[point] += displacement;
  if (points_.strokes[point] != brush.stroke()) {
    SculptedPoints::Found found = points_.found(point, brush.stroke());
    if (moves_) {
      // It is soon to look ahead.
      found.room = firstStep();
      strains_[point] += kFirstStrain * static_cast<float>(options_.radius);
    }
    points_.setFound(point, found);
  }
  if (moves_) points_.founds[point].room -= displacement;
  points_.positions[point] = place;
  if (std::exchange(points_.unsettled[point], 1) == 0) slice.waiting.push_back(point);
  if (point >= points_.fromFile) points_.reaches[point - points_.fromFile] = mostReach();
}

PlacedBrush::Found CpuSculpture::found(const PlacedBrush& brush, std::uint32_t point) const {
  return found(brush, point, points_.positions[point]);
}

PlacedBrush::Found CpuSculpture::found(const PlacedBrush& brush, std::uint32_t point, const Vec3& place) const {
  // Without a copy of the state: it would be written and read back in parts of other sizes, which stalls.
  if (points_.strokes[point] != brush.stroke())
    return {DVec3(place), DVec3(points_.normals[point]), double{moves_ ? firstStep() : shared::kUnseen}};
  const SculptedPoints::FoundState& found = points_.founds[point];
  return {DVec3(found.position), DVec3(found.normal), double{found.room}};
}

void CpuSculpture::brush(const PlacedBrush& brush, std::size_t number, Slice& slice) {
  for (std::vector<std::uint32_t>* list :
       {&slice.reached, &slice.changed, &slice.strayed, &slice.waiting, &slice.swallowed, &slice.blocked})
    list->clear();
  slice.measured.clear();
  slice.blockedMoves = 0;
  slice.smoothed = 0;
  grid_.forEachNear(brush.center(), brush.radius(), number, [&](const SortedGrid::Placed& near) {
    if (brush.measures(near.number)) {
      points_.prefetchNormal(near.number);
      slice.measured.push_back(near);
    }
    if (brush.mayAffect(DVec3(near.position))) slice.reached.push_back(near.number);
  });
  if (!slice.measured.empty()) measure(brush, slice);
  brushEach(brush, slice);
}

void CpuSculpture::measure(const PlacedBrush& brush, Slice& slice) const {
  slice.measure = {};
  for (std::size_t i = 0; i < slice.measured.size(); ++i) {
    if (i + kAhead < slice.measured.size()) points_.prefetchFound(slice.measured[i + kAhead].number, brush.stroke());
    const auto& [place, point] = slice.measured[i];
    brush.measure(DVec3(place), found(brush, point, place), slice.measure);
  }
}

void CpuSculpture::brushEach(const PlacedBrush& brush, Slice& slice) {
  const bool paints = brush.kind() == BrushKind::paint;
  for (const std::uint32_t point : slice.reached) points_.prefetch(point);
  for (const std::uint32_t point : slice.reached) {
    const DVec3 place(points_.positions[point]);
    const PlacedBrush::Found as = found(brush, point);
    const PlacedBrush::Point to = brushed(brush, point, as, slice);
    // One that has moved since it looked ahead is about to look again, and so is an unsettled one.
    if (brush.mayBlock(as) && !(strains_[point] > 0)) {
      slice.blocked.push_back(point);
      if (points_.unsettled[point] == 0) {
        const DVec3 free = brushed(brush, point, {as.position, as.normal, double{shared::kUnseen}}, slice).position;
        slice.blockedMoves += brush.isBlocked(place, as, free);
      }
    }
    bool painted = false;
    if (paints) {
      const std::uint32_t before =
          std::exchange(points_.colors[point], brush.painted(place, as, points_.colors[point]));
      painted = points_.colors[point] != before;
    }
    if (to.taken || painted || Vec3(to.position) != points_.positions[point]) apply(brush, point, to, slice);
  }
}

PlacedBrush::Point CpuSculpture::brushed(const PlacedBrush& brush, std::uint32_t point, const PlacedBrush::Found& as,
                                         Slice& slice) const {
  const DVec3 place(points_.positions[point]);
  if (brush.kind() != BrushKind::smooth) return brush.brushed(place, DVec3(points_.normals[point]), as);
  if (!brush.smooths(place, as)) return {place};
  const SurfaceOptions options{.radius = fitRadius(point), .kind = SurfaceKind::sphere};
  return {brush.smoothed(place, as, surfaceOf(options, DVec3(points_.normals[point]), [&](double radius, auto&& visit) {
                           grid_.forEachNear(place, radius, [&](const SortedGrid::Placed& near) {
                             visit(DVec3(near.position) - place, points_.normals[near.number]);
                             ++slice.smoothed;
                           });
                         }))};
}

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
}

}  // namespace palpate
