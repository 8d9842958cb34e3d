#include "haptics/sharing/brick_sculptor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/clock.hpp"
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

}  // namespace palpate
