#include "engine/touch/brick_sculptor.hpp"

#include "engine/core/clock.hpp"
#include "engine/core/held_contact.hpp"
#include "engine/core/thread_priority.hpp"
#include "engine/edit/cpu_sculpture.hpp"

namespace palpate {

namespace {

constexpr double kPoll_us = 1;  // a budget that lets no thread sleep

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
    : source_(source), radius_(radius), origin_(origin), pace_(kStalest_s) {
  statistics_.editTimes_us.reserve(kEditTimesKept);
  task_ = std::make_unique<BackgroundTask>([this] {
    giveWay();  // to the thread that answers
    edit();
  });
}

void BrickSculptor::setBrush(const std::optional<BrushOptions>& brush) {
  finish();
  brush_ = brush;
}

void BrickSculptor::editIfYielding(const Contact& contact, const Pose& pose, const DVec3& lastHip, double felt_s,
                                   bool realtime) {
  if (!brush_ || !contact.touching || !contact.valid || !pose.sculpts) return;
  if (!finishedWithin(realtime ? kPoll_us : 0)) return;
  if (source_.versionOf(felt_s) < work_.version) return;
  if (realtime && !pace_.mayEdit(pose.time_s)) {
    ++statistics_.shortfalls.editsTooSlow;
    return;
  }
  work_.brush.emplace(*brush_, radius_, pose.hip - origin_, lastHip - origin_, contact.proxy - pose.hip);
  if (!work_.brush->acts()) return;
  if (!statistics_.firstEditTime_s) statistics_.firstEditTime_s = pose.time_s;
  time_s_ = pose.time_s;
  isUnderWay_ = true;
  task_->start();
  if (!realtime) finishedWithin(0);
}

bool BrickSculptor::finishedWithin(double budget_us) {
  if (!isUnderWay_) return true;
  if (!task_->finishedWithin(budget_us)) return false;
  isUnderWay_ = false;
  pace_.took(time_s_, work_.time_us * 1e-6);
  states_ += work_.changes.size();
  if (statistics_.editTimes_us.size() < statistics_.editTimes_us.capacity())
    statistics_.editTimes_us.push_back(work_.time_us);
  return true;
}

void BrickSculptor::finish() { finishedWithin(0); }

void BrickSculptor::edit() {
  const Stopwatch watch;
  const PlacedBrush& brush = *work_.brush;
  work_.points.clear();
  work_.changes.clear();
  // A point stays within twice the brush, and its normal is made of what lies within a support radius of it.
  const DVec3 reach(2 * brush.radius() + 1.01 * radius_);
  source_.pointsIn(brush.center() - reach, brush.center() + reach, work_.points);
  if (!work_.points.empty()) {
    const PointCloud cloud = cloudOf(work_.points);
    CpuSculpture sculpture(cloud, makeHashGrid(Vec3(boundsOf(cloud).min), radius_, cloud.size(), BucketKey::teschner),
                           {.radius = radius_, .keepsDensity = false, .threads = 1});
    sculpture.edit(brush);
    for (const std::uint32_t number : sculpture.changed()) {
      const PointState& from = work_.points[number];
      PointState to = sculpture.points().state(number);
      to.id = from.number() | (to.id & PointState::kGone);
      to.parent = from.number();
      work_.changes.push_back({.from = from, .to = to});
      work_.ever.insert(from.number());
    }
  }
  if (!work_.changes.empty()) work_.version = source_.make(work_.changes);
  work_.time_us = watch.elapsed_us();
}

}  // namespace palpate
