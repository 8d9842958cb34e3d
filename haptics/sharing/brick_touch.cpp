#include "haptics/sharing/brick_touch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/common.hpp>

#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "engine/core/held_contact.hpp"
#include "engine/core/thread_priority.hpp"

namespace palpate {

namespace {

constexpr double kPoll_us = 1;  // budget too short for a thread to sleep

// The points as a cloud of their own, in their order.
PointCloud cloudOf(std::span<const PointState> points) {
  PointCloud cloud;
  bool isColored = false;
  for (const PointState& point : points) {
    cloud.positions.push_back(point.position);
    cloud.normals.push_back(point.normal);
    cloud.colors.push_back(unpackedColor(point.color));
    isColored = isColored || point.color != 0;
  }
  if (!isColored) cloud.colors.clear();
  return cloud;
}

// In support radii: the margin around the paths of the hand and its proxy that an answer depends on; the margin
// requested before the proxy's path is known; and the margin around a script's start.
constexpr double kMadeOf = 1.25, kMayGo = 3, kAtFirst = 12;

}  // namespace

BrickSculptor::BrickSculptor(BrickSource& source, double radius, const DVec3& origin)
    : source_(source), radius_(radius), origin_(origin), stroke_(radius), pace_(kStalest_s) {
  statistics_.editTimes_us.reserve(kEditTimesKept);
  task_ = std::make_unique<BackgroundTask>([this] {
    giveWay();  // lowers the priority below the answering thread
    edit();
  });
}

void BrickSculptor::setBrush(const std::optional<BrushOptions>& brush) {
  finish();
  brush_ = brush;
  stroke_.setBrush(brush.value_or(BrushOptions()));
}

void BrickSculptor::editIfYielding(const Contact& contact, const Pose& pose, double felt_s, bool realtime) {
  if (!brush_ || !contact.valid) return;
  const DVec3 spring = contact.touching ? contact.proxy - pose.hip : DVec3(0);
  stroke_.feel(contact, pose.hip - origin_, spring, pose.press(), pose.time_s);
  if (!stroke_.acts() || !finishedWithin(realtime ? kPoll_us : 0)) return;
  if (source_.versionOf(felt_s) >= work_.version) start(pose.time_s, realtime);
}

void BrickSculptor::start(double time_s, bool realtime) {
  if (realtime && !pace_.mayEdit(time_s)) {
    ++statistics_.shortfalls.editsTooSlow;
    return;
  }
  work_.brush.emplace(*brush_, radius_, stroke_.next(time_s, work_.backlog));
  if (!statistics_.firstEditTime_s) statistics_.firstEditTime_s = time_s;
  time_s_ = time_s;
  isUnderWay_ = true;
  task_->start();
  if (!realtime) finishedWithin(0);
}

bool BrickSculptor::finishedWithin(double budget_us) {
  if (!isUnderWay_) return true;
  if (!task_->finishedWithin(budget_us)) return false;
  isUnderWay_ = false;
  stroke_.note(work_.measure);
  pace_.took(time_s_, work_.time_us * 1e-6);
  states_ += work_.changes.size();
  if (statistics_.editTimes_us.size() < statistics_.editTimes_us.capacity())
    statistics_.editTimes_us.push_back(work_.time_us);
  return true;
}

void BrickSculptor::finish() {
  finishedWithin(0);
  while (brush_ && stroke_.hasWay()) start(time_s_ + 1e-3, false);
  stroke_.end();
  source_.endStroke();
}

// Spacings of the points that this edit may move. They are measured before the stroke changes any point around them, of
// many at a time.
void BrickSculptor::measureSpacings(CpuSculpture& sculpture) {
  const double reach = work_.brush->radius(), soon = reach + radius_;
  std::vector<float> spacings(work_.points.size(), static_cast<float>(radius_));  // any value, where no point moves
  std::vector<std::uint32_t> unknown;
  bool isAnySoon = false;
  for (std::uint32_t i = 0; i < work_.points.size(); ++i) {
    const DVec3 away = DVec3(work_.points[i].position) - work_.brush->center();
    if (std::max({std::abs(away.x), std::abs(away.y), std::abs(away.z)}) >= 2 * reach) continue;
    if (const auto known = work_.spacings.find(work_.points[i].number); known != work_.spacings.end()) {
      spacings[i] = known->second;
    } else {
      unknown.push_back(i);
      isAnySoon = isAnySoon || glm::dot(away, away) < soon * soon;
    }
  }
  if (!isAnySoon) unknown.clear();
  for (const std::uint32_t i : unknown) spacings[i] = 0;
  sculpture.setSpacings(std::move(spacings));
  for (const std::uint32_t i : unknown) work_.spacings[work_.points[i].number] = sculpture.points().spacings[i];
}

void BrickSculptor::edit() {
  const Stopwatch watch;
  const PlacedBrush& brush = *work_.brush;
  work_.points.clear();
  work_.changes.clear();
  work_.measure = {};
  work_.backlog = {};
  if (std::exchange(work_.stroke, brush.stroke()) != brush.stroke()) work_.kept.clear();
  // A point stays within twice the brush radius, and its normal depends on the points within a support radius.
  const DVec3 reach(2 * brush.radius() + 1.01 * radius_);
  source_.pointsIn(brush.center() - reach, brush.center() + reach, work_.points);
  if (!work_.points.empty()) {
    const PointCloud cloud = cloudOf(work_.points);
    CpuSculpture sculpture(cloud, makeHashGrid(Vec3(boundsOf(cloud).min), radius_, cloud.size(), BucketKey::teschner),
                           {.radius = radius_, .threads = 1, .measures = false});
    measureSpacings(sculpture);
    for (std::uint32_t i = 0; i < work_.points.size(); ++i)
      if (const auto kept = work_.kept.find(work_.points[i].number); kept != work_.kept.end())
        sculpture.keep(i, kept->second);
    sculpture.edit(brush);
    work_.measure = sculpture.measure();
    work_.backlog = sculpture.backlog();
    for (const std::uint32_t number : sculpture.changed()) {
      const PointState& from = work_.points[number];
      PointState to = sculpture.points().state(number);
      to.number = to.parent = from.number;
      work_.changes.push_back({.from = from, .to = to});
      work_.ever.insert(from.number);
    }
    for (std::uint32_t i = 0; i < work_.points.size(); ++i)
      if (sculpture.points().strokes[i] == brush.stroke()) work_.kept[work_.points[i].number] = sculpture.kept(i);
  }
  if (!work_.changes.empty()) work_.version = source_.make(work_.changes, brush.stroke());
  work_.time_us = watch.elapsed_us();
}

BrickTouch::BrickTouch(BrickSource& source, std::unique_ptr<TouchBackend> surface, const BrickTouchOptions& options)
    : FarTouch(std::move(surface)),
      source_(source),
      options_(options),
      hands_(inner().hands()),
      answers_(hands_.size()),
      sculptor_(source, options.radius / options.widening, options.origin) {
  if (options.brush) setBrush(options.brush);
  for (std::size_t i = 0; i < hands_.size(); ++i)
    hands_[i].points.assign(inner().points(i).begin(), inner().points(i).end());
}

// The surface query covers the path from the hand's last position to the present one, and the surroundings of its
// proxy.
HandReach BrickTouch::reachOf(std::size_t hand, const DVec3& hip, double around) const {
  const Hand& last = hands_[hand];
  HandReach reach{
      .low = hip, .high = hip, .hip = hip, .proxy = last.proxy.value_or(hip), .touching = last.proxy.has_value()};
  for (const std::optional<DVec3>& place : {last.hip, last.proxy})
    if (place) {
      reach.low = glm::min(reach.low, *place);
      reach.high = glm::max(reach.high, *place);
    }
  reach.low -= options_.origin + around;
  reach.high -= options_.origin - around;
  return reach;
}

void BrickTouch::tell(double time_s, std::span<const Pose> poses) {
  asked_.time_s = time_s;
  asked_.steady_s = steadyNow_s();
  asked_.count = static_cast<std::uint32_t>(poses.size());
  asked_.sculpts = sculptor_.hasBrush();
  for (std::size_t i = 0; i < poses.size(); ++i)
    asked_.hands[i] = reachOf(i, poses[i].hip, kMayGo * options_.radius + options_.tool);
  source_.ask(asked_);
}

bool BrickTouch::awaitAt(double time_s, std::span<const DVec3> hips, double timeout_s) {
  std::vector<Pose> poses(hips.size());
  for (std::size_t i = 0; i < hips.size(); ++i) poses[i].hip = hips[i];
  for (Pose& pose : poses) pose.time_s = time_s;
  tell(time_s, poses);
  HandReaches first = asked_;
  for (HandReach& reach : first.hands) {
    reach.low -= (kAtFirst - kMayGo) * options_.radius;
    reach.high += (kAtFirst - kMayGo) * options_.radius;
  }
  if (!source_.await(asked_, first, timeout_s)) return false;
  inner().query(poses, 0);  // brings the frame with these points
  for (std::size_t i = 0; i < hips.size(); ++i) resetHand(i);
  return true;
}

std::span<const Contact> BrickTouch::ask(std::span<const Pose> poses, double budget_us) noexcept {
  const bool areFinite = std::ranges::all_of(poses, [](const Pose& pose) { return isFinite(pose.hip); });
  if (areFinite) tell(poses.front().time_s, poses);
  const bool waits = budget_us <= 0 && areFinite;
  inVain_ = inVain_ || (waits && !source_.await(asked_, options_.timeout_s));
  const std::span<const Contact> felt = inner().ask(poses, budget_us);
  const std::uint64_t before = without_.load(std::memory_order_relaxed);
  for (std::size_t i = 0; i < hands_.size(); ++i) answer(i, poses[i], felt[i], waits && inVain_);
  // A tick at which two hands lack points counts once.
  without_.store(std::min(without_.load(std::memory_order_relaxed), before + 1), std::memory_order_relaxed);
  ticks_.store(ticks_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  sculpt(poses.front(), budget_us > 0);
  return answers_;
}

// A tool of many points has no brush here: the answer to its hand is not the contact of its HIP alone.
void BrickTouch::sculpt(const Pose& pose, bool realtime) noexcept {
  const auto points = framesTime();
  if (failure_ || !points || !hands_.front().points.empty()) return;
  try {
    sculptor_.editIfYielding(answers_.front(), pose, points->true_s, realtime);
  } catch (...) {
    failure_ = std::current_exception();
  }
}

void BrickTouch::answer(std::size_t hand, const Pose& pose, const Contact& felt, bool late) {
  Hand& own = hands_[hand];
  const double around = kMadeOf * options_.radius + options_.tool;
  HandReach reach = reachOf(hand, pose.hip, around);
  if (felt.touching) {
    reach.low = glm::min(reach.low, felt.proxy - options_.origin - around);
    reach.high = glm::max(reach.high, felt.proxy - options_.origin + around);
  }
  answers_[hand] = felt;
  std::ranges::copy(inner().points(hand), own.points.begin());
  const auto points = framesTime();
  if (!felt.valid || (points && source_.covers(points->true_s, reach.low, reach.high))) {
    own.hip = pose.hip;
    own.proxy = felt.touching ? std::optional(felt.proxy) : std::nullopt;
    return;
  }
  without_.store(without_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  answers_[hand] = {.proxy = pose.hip, .fresh = felt.fresh, .valid = !late, .lost = late};
  for (PointContact& point : own.points) point.contact = {.proxy = point.hip, .fresh = felt.fresh, .valid = !late};
  resetHand(hand);
}

void BrickTouch::resetHand(std::size_t hand) noexcept {
  inner().resetHand(hand);
  hands_[hand].hip.reset();
  hands_[hand].proxy.reset();
  if (hand == 0) sculptor_.lift();
}

void BrickTouch::finish() {
  inner().finish();
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  sculptor_.finish();
  if (inVain_)
    throw Error("the points around a hand were not received within {:.0f} s: the server is not running, or too slow",
                options_.timeout_s);
}

std::size_t BrickTouch::readBack(PointCloud& cloud) const {
  if (source_.moves()) return inner().readBack(cloud);
  PointCloud known = source_.cloud();
  known.origin = cloud.origin;
  known.storedAs = std::move(cloud.storedAs);
  cloud = std::move(known);
  return sculptor_.points();
}

void BrickTouch::change(std::span<const PointChange> changes) {
  sculptor_.finish();
  sculptor_.setVersion(source_.change(changes));
}

void BrickTouch::setBrush(const std::optional<BrushOptions>& brush) {
  if (brush && !options_.fixed.empty()) throw UsageError("{}", options_.fixed);
  if (brush && brushHas(brush->kind, shared::kPaintsPoints) && !source_.isColored())
    throw UsageError(
        "paint: the points have no colours, and none can be added with only the points around the hands; join all of "
        "them");
  if (brush && !hands_.front().points.empty())
    throw UsageError("a tool of many points cannot sculpt with only the points around the hands; join all of them");
  sculptor_.setBrush(brush);
}

BackendReport BrickTouch::report() const {
  BackendReport report = inner().report();
  const TouchStatistics& edits = sculptor_.statistics();
  report.editTimes_us = edits.editTimes_us;
  report.firstEdit_s = edits.firstEditTime_s;
  report.costs = {.requests_us = {}, .states = sculptor_.states()};
  report.shortfalls.editsTooSlow += edits.shortfalls.editsTooSlow;
  return report;
}

}  // namespace palpate
