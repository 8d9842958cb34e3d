#include "engine/edit/cpu_sculpture.hpp"

#include <algorithm>
#include <numbers>
#include <utility>

#include "engine/core/check.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/parallel.hpp"
#include "engine/edit/normal_refit.hpp"
#include "engine/edit/spacing_measure.hpp"
#include "shaders/shared/contact.h"

namespace palpate {

namespace {

constexpr std::size_t kFewestSlices = 1;  // that a thread takes at a time
constexpr std::size_t kAhead = 8;         // points whose memory is fetched ahead of a brush
constexpr std::size_t kTurns = 8;  // parts of the work that a thread takes, so that all end at about the same time
// Work for which another thread is woken, and that of looking at a point under the brush.
constexpr double kThreadWork = 4000, kLookWork = 11;
// The same of moving a point, with its place in the index.
constexpr double kMoveWork = 64;
// Priority, in support radii, of a point that a stroke moves for the first time.
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
      workOfPoint_(kMaxWorkOfPoint) {
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
  carves_ = brush.has(shared::kRemovesPoints);
  fills_ = brush.fills();
  claims_.begin(brush.stroke());
  moves_.reset();
  cuts_.reset();
  resamples_ = brush.resamples();
  if (carves_ && brush.acts() && resamples_) cuts_ = brush;
  if (brush.has(shared::kLooksAhead) && brush.acts()) moves_ = brush;
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
    strayed_.push_back(static_cast<std::uint32_t>(change.to.number));
  }
  std::ranges::sort(strayed_);
  strayed_.erase(std::unique(strayed_.begin(), strayed_.end()), strayed_.end());
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

void CpuSculpture::lock(const PointLock& lock) {
  locked_ = lock.points.bits(lock.points.end());
  lockWeights_ = lock.weights;
}

void CpuSculpture::hold(std::uint32_t point) {
  if (locked_.size() <= point / 64) locked_.resize(point / 64 + 1);
  locked_[point / 64] |= std::uint64_t{1} << point % 64;
}

double CpuSculpture::lockOf(std::uint32_t point) const {
  if (lockWeights_.empty()) return 0;
  return lockWeights_[point < lockWeights_.size() ? point : points_.parents[point]] / 255.0;
}

void CpuSculpture::replace(const PointSet& changed, std::span<const PointState> states, const PointSet& without) {
  set({});
  const std::vector<PointSet::Word> words = changed.list();
  parallelFor(words.size(), static_cast<unsigned>(grid_.threads()), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      words[i].forEach([&](std::uint64_t point, std::uint64_t) {
        if (point >= std::min(states.size(), points_.size())) return;
        points_.set(states[point]);
        strains_[point] = displacements_[point] = 0;
        isBlocked_[point] = Blocked::no;
      });
  });
  without.forEach([&](std::uint64_t point) {
    if (point < points_.size()) points_.there[point] = 0;
  });
  grid_.build(points_.positions, points_.there);
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
    return {DVec3(place), DVec3(points_.normals[point]), double{moves_ ? firstStep() : shared::kUnseen}, lockOf(point)};
  const SculptedPoints::FoundState& found = points_.founds[point];
  return {DVec3(found.position), DVec3(found.normal), double{found.room}, lockOf(point)};
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
    if (brush.mayAffect(DVec3(near.position)) && !isLocked(near.number)) slice.reached.push_back(near.number);
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
  const bool paints = brush.has(shared::kPaintsPoints);
  for (const std::uint32_t point : slice.reached) points_.prefetch(point);
  for (const std::uint32_t point : slice.reached) {
    const DVec3 place(points_.positions[point]);
    const PlacedBrush::Found as = found(brush, point);
    const PlacedBrush::Point to = brushed(brush, point, as, slice);
    const auto free = [&] {
      PlacedBrush::Found open = as;
      open.room = double{shared::kUnseen};
      return brushed(brush, point, open, slice).position;
    };
    // One that has moved since it looked ahead is about to look again, and so is an unsettled one.
    if (brush.mayBlock(as) && !(strains_[point] > 0)) {
      slice.blocked.push_back(point);
      if (points_.unsettled[point] == 0) {
        slice.blockedMoves += brush.isBlocked(place, as, free());
      }
    }
    // Its turn has not come, and it may go no further until then: the tool has to wait for it as for one that goes on.
    if (moves_ && points_.unsettled[point] != 0 && as.room < shared::kLongestMove * options_.radius) {
      const auto held = static_cast<float>(glm::distance(free(), to.position));
      displacements_[point] += held;
      strains_[point] += held;
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
  if (!brush.has(shared::kUsesNeighbours)) return brush.brushed(place, DVec3(points_.normals[point]), as);
  if (!brush.smooths(place, as)) return {place};
  const SurfaceOptions options{.radius = fitRadius(point), .kind = SurfaceKind::sphere};
  return {brush.smoothed(place, as, surfaceOf(options, DVec3(points_.normals[point]), [&](double radius, auto&& visit) {
                           grid_.forEachNear(place, radius, [&](const SortedGrid::Placed& near) {
                             visit(DVec3(near.position) - place, points_.normals[near.number]);
                             ++slice.smoothed;
                           });
                         }))};
}

}  // namespace palpate
