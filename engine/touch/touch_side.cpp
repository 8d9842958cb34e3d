#include "engine/touch/touch_side.hpp"

#include <algorithm>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/clock.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"

namespace palpate {

namespace {

constexpr double kLongestMove = 0.25;             // of the support radius, in one tick: a resting proxy keeps its surface
constexpr double kStalest_s = 0.02;               // an older answer says nothing about where the hand is now
constexpr std::size_t kEditTimesReserved = 1 << 16;  // a minute at 1 kHz without an allocation on the servo thread

HashGrid gridFor(const PointCloud& cloud, const TouchOptions& options) {
  const double cell = options.cell > 0 ? options.cell : options.radius;
  return makeHashGrid(Vec3(boundsOf(cloud).min), std::max(cell, smallestCell(options.radius)), cloud.size());
}

}  // namespace

TouchSide::TouchSide(Device& device, const PointCloud& cloud, const TouchOptions& options)
    : device_(device),
      options_(options),
      wait_(options.wait.value_or(device.defaultWait())),
      origin_(cloud.origin),
      live_(device, cloud),
      hash_(device, gridFor(cloud, options), live_.count()),
      contact_(device, options.radius, live_.count()),
      log_(device, options.push ? live_.count() : 0),
      refit_(device, options.push ? live_.count() : 0) {
  if (options.push) {
    push_.emplace(device, *options.push);
    editTimes_us_.reserve(kEditTimesReserved);
  }
  CommandList build(device, device.touch(), "build", CommandList::Timing::sections);
  build.begin();
  hash_.recordBuild(build, live_.side(), live_.otherSide(), live_.count());
  build.end();
  device.touch().run(build);
  buildTime_us_ = build.sectionTime_us("hash");
  live_.flip();
  for (int turn = 0; turn < 2; ++turn) {
    recordQuery(live_.parity());
    if (push_) recordEdit(live_.parity());
    live_.flip();
  }
}

TouchSide::~TouchSide() {
  try {
    device_.waitIdle();
  } catch (const GpuError&) {  // the device is lost: nothing runs on it any more
  }
}

void TouchSide::recordQuery(std::uint32_t parity) {
  auto& list = queries_[parity];
  list = std::make_unique<CommandList>(device_, device_.touch(), "query", options_.timing);
  list->begin();
  contact_.record(*list, hash_.view(live_.side(), live_.count()), log_.head());
  list->end();
}

void TouchSide::recordEdit(std::uint32_t parity) {
  auto& list = edits_[parity];
  list = std::make_unique<CommandList>(device_, device_.touch(), "edit", options_.timing);
  list->begin();
  {
    const auto section = list->section("edit");
    push_->record(*list, live_.side(), live_.count(), contact_.state(), kLongestMove * options_.radius);
    hash_.recordBuild(*list, live_.side(), live_.otherSide(), live_.count());
    refit_.record(*list, hash_.view(live_.otherSide(), live_.count()), log_, options_.radius);
  }
  list->end();
}

Contact TouchSide::query(const Pose& pose, double budget_us) noexcept {
  const Contact invalid{.proxy = pose.hip};
  if (failure_ || !isFinite(pose.hip)) return invalid;
  try {
    const Stopwatch watch;
    // An answer that came too late for its own tick is taken in now; nothing new is asked while one is out.
    if (asked_ && !answerWithin(budget_us)) return held(pose);
    ask(pose);
    if (!answerWithin(budget_us > 0 ? std::max(1.0, budget_us - watch.elapsed_us()) : 0)) return held(pose);
    return last_;
  } catch (...) {
    failure_ = std::current_exception();
    return invalid;
  }
}

void TouchSide::ask(const Pose& pose) {
  contact_.pose() = {.hip = Vec3(pose.hip - origin_), .tick = ++tick_};
  asked_ = Asked{pose, live_.parity(), device_.touch().submit(*queries_[live_.parity()])};
}

bool TouchSide::answerWithin(double budget_us) {
  if (!device_.touch().wait(asked_->ticket, wait_, budget_us)) return false;
  const Asked asked = *asked_;
  asked_.reset();
  const shared::ContactSample sample = contact_.sample();
  collectEdit();
  log_.publish(sample.logHead);
  last_ = {.proxy = asked.pose.hip + DVec3(sample.spring),
           .normal = DVec3(sample.normal),
           .touching = sample.touching != 0,
           .fresh = true,
           .valid = isFinite(sample.spring) && isFinite(sample.normal),
           .neighbours = sample.neighbours,
           .gpu_us = queries_[asked.parity]->sectionTime_us("contact")};
  lastTime_s_ = asked.pose.time_s;
  if (last_.valid) editIfYielding(sample);
  return true;
}

Contact TouchSide::held(const Pose& pose) const {
  Contact contact{.proxy = pose.hip, .valid = true};
  if (!last_.valid || !last_.touching || pose.time_s - lastTime_s_ > kStalest_s) return contact;
  const double depth = glm::dot(last_.proxy - pose.hip, last_.normal);
  if (depth <= 0) return contact;
  contact.touching = true;
  contact.proxy = pose.hip + depth * last_.normal;
  contact.normal = last_.normal;
  contact.neighbours = last_.neighbours;
  return contact;
}

void TouchSide::editIfYielding(const shared::ContactSample& sample) {
  if (!push_ || !sample.touching || glm::length(DVec3(sample.spring)) <= options_.push->tau) return;
  // What the last edit wrote is not published before the next answer: room for two.
  if (log_.room() < 2 * std::uint64_t{live_.count()}) {
    ++skippedEdits_;
    return;
  }
  device_.touch().submit(*edits_[live_.parity()]);
  if (!firstEdit_) firstEdit_ = tick_ - 1;
  editInFlight_ = live_.parity();
  live_.flip();
}

void TouchSide::collectEdit() {
  // Called after a later submission to the same queue has completed, so the edit has as well.
  if (!editInFlight_) return;
  const double time_us = edits_[*editInFlight_]->sectionTime_us("edit");
  editInFlight_.reset();
  if (editTimes_us_.size() < editTimes_us_.capacity()) editTimes_us_.push_back(time_us);
}

void TouchSide::finish() {
  if (failure_) std::rethrow_exception(failure_);
  if (asked_) answerWithin(0);
  log_.publish(download<std::uint32_t>(device_, log_.headBuffer(), 1)[0]);  // waits for the queue
  collectEdit();
}

std::vector<PassRecord> TouchSide::passes() const {
  std::vector<PassRecord> all = queries_[live_.parity()]->passes();
  if (push_) std::ranges::copy(edits_[live_.parity()]->passes(), std::back_inserter(all));
  return all;
}

}  // namespace palpate
