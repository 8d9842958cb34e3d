#include "engine/touch/touch_side.hpp"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/point_cloud.hpp"
#include "engine/core/error.hpp"
#include "engine/core/held_contact.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/touch/memory.hpp"
#include "shaders/shared/edit.h"

namespace palpate {

namespace {

constexpr double kLook_us = 1;  // a budget that lets no thread sleep
constexpr double kNap_us = 40;  // between looks, where spinning would starve the driver

// A question that was submitted ahead ends within so long after it was withdrawn, where the GPU hears the host at all.
constexpr double kLongestDeafness_us = 5000;

// Drivers that are known to bring what the host writes before a shader that is running. Where sight has the same queue,
// its frames would wait behind a question that waits.
bool mayHearTheHost(const Device& device) {
  return device.driverId() == VK_DRIVER_ID_NVIDIA_PROPRIETARY && !device.roles().shared();
}

// A cloud whose index is always built anew needs spare slots for new points alone.
constexpr std::uint32_t kFewerSpare = 4;

std::uint32_t spareSlots(const PointCloud& cloud, const TouchOptions& options) {
  const std::uint32_t spare = HashUpdate::spareSlots(cloud.size());
  return options.index == IndexFollow::rebuild ? spare / kFewerSpare : options.spareSlots.value_or(spare);
}

// RGBA8 of every point; none where the cloud has none and none are painted.
std::vector<std::uint32_t> colorsOf(const PointCloud& cloud, const TouchOptions& options) {
  std::vector<std::uint32_t> colors;
  if (!cloud.hasColors() && !options.paintable && options.brush->kind != BrushKind::paint) return colors;
  for (std::size_t i = 0; i < cloud.size(); ++i) colors.push_back(packedColor(cloud, i));
  return colors;
}

// The cloud, once it is known to fit: before a byte of it is uploaded.
const PointCloud& fitting(const Device& device, const PointCloud& cloud, const TouchOptions& options) {
  requireGpuMemory(device, cloud.size(), options.brush.has_value());
  return cloud;
}

HashGrid gridFor(const PointCloud& cloud, const TouchOptions& options) {
  const double cell = options.cell > 0 ? options.cell : options.radius;
  return makeHashGrid(Vec3(boundsOf(cloud).min), std::max(cell, smallestCell(options.radius)), cloud.size(),
                      options.bucketKey);
}

// What the GPU finds beside its question. Places relative to the cloud's origin.
shared::ContactState stateOf(const std::optional<ProxyTracker::Story>& story) {
  if (!story) return {};
  return {.lastHip = Vec3(story->lastHip),
          .touching = !story->touching ? shared::kFree
                      : story->sticks  ? shared::kSticking
                                       : shared::kSliding,
          .spring = Vec3(story->proxy - story->lastHip),
          .side = story->side,
          .facing = Vec3(story->facing),
          .started = story->started ? 1u : 0u};
}

// What the GPU's answer to a HIP, relative to the cloud's origin, leaves to the next tick.
ProxyTracker::Story storyOf(const shared::ContactSample& sample, const DVec3& hip) {
  const std::uint32_t side = sample.flags >> shared::kSampleSideShift;
  const bool touching = sample.touching != shared::kFree;
  const DVec3 normal(sample.normal);
  return {.started = true,
          .touching = touching,
          .sticks = sample.touching == shared::kSticking,
          .side = side,
          .facing = touching && side == shared::kSideBehind ? -normal : normal,
          .lastHip = hip,
          .proxy = hip + DVec3(sample.spring)};
}

}  // namespace

TouchSide::TouchSide(Device& device, const PointCloud& cloud, const TouchOptions& options)
    : device_(device),
      options_(options),
      wait_(options.wait.value_or(device.defaultWait())),
      origin_(cloud.origin),
      live_(device, fitting(device, cloud, options), options.brush ? spareSlots(cloud, options) : 0),
      hash_(device, gridFor(cloud, options), live_.slots(), options.sort, options.bucketOrder,
            options.brush ? Slots::spare : Slots::full),
      contact_(device, contactOptions(), hash_.grid(), live_.slots()),
      log_(device, options.brush ? live_.count() : 0),
      forget_(device, device.touch(), "begin anew"),
      pace_(kStalest_s) {
  buildTime_us_ = hash_.build(live_);
  if (options.brush) {
    edit_.emplace(device, *options.brush, hash_, live_, log_, colorsOf(cloud, options), options.radius);
    editTimes_us_.reserve(kEditTimesKept);
    wishTimes_us_.reserve(kEditTimesKept);
  }
  makeBridge();
  recordAll();
  if (edit_ && options.index == IndexFollow::incremental)
    compaction_.emplace(device, hash_, live_, edit_->update(), options.compaction);
  const bool mayAskAhead = wait_ == Wait::spin && mayHearTheHost(device);
  ahead_ = contact_.canWait() && options.ahead.value_or(mayAskAhead && hearsTheHost());
  device_.noteTouch(1);
}

TouchSide::~TouchSide() {
  device_.noteTouch(-1);
  try {
    withdraw();
    device_.waitIdle();
  } catch (const GpuError&) {  // the device is lost: nothing runs on it any more
  }
}

ContactOptions TouchSide::contactOptions() const {
  return {.radius = options_.radius,
          .method = options_.method,
          .surface = options_.surface,
          .localRadius = options_.localRadius,
          .friction = options_.friction,
          .split = options_.split};
}

void TouchSide::makeBridge() {
  bridge_.emplace(
      device_, hash_.grid(), origin_,
      SurfaceOptions{.radius = options_.radius, .kind = options_.surface, .localRadius = options_.localRadius},
      options_.friction, live_.slots());
}

void TouchSide::recordAll() {
  for (int turn = 0; turn < 2; ++turn) {
    recordQuery(live_.parity());
    bridge_->record(live_.parity(), hash_.view(live_.side(), live_.slots()));
    if (edit_) recordEdits();
    live_.flip();
  }
  forget_.begin();
  forget_.fill(contact_.state(), 0, contact_.state().bytes());
  forget_.end();
}

void TouchSide::settle() {
  if (failure_) std::rethrow_exception(failure_);
  closeTick();
  withdraw();
  if (asked_) answerWithin(0, lastPose_.time_s);
}

void TouchSide::setContact(SurfaceKind surface, double friction, QueryMethod method) {
  finish();
  device_.waitIdle();
  options_.surface = surface;
  options_.friction = friction;
  options_.method = method;
  ended_.reset();
  contact_ = ContactStep(device_, contactOptions(), hash_.grid(), live_.slots());
  makeBridge();
  recordAll();
  lastQuery_ = {};
  last_ = {};
  ahead_ = ahead_ && contact_.canWait();
}

void TouchSide::beginAnew() noexcept {
  if (failure_) return;
  try {
    closeTick();
    withdraw();
    if (asked_) asked_->dropped = true;
    settleLast();
    device_.touch().wait(device_.touch().submit(forget_), wait_);
    bridge_->beginAnew();
    last_.touching = false;
  } catch (...) {
    failure_ = std::current_exception();
  }
}

void TouchSide::recordQuery(std::uint32_t parity) {
  queries_[parity].clear();
  for (std::uint32_t i = 0; i < contact_.lists(); ++i) {
    auto& list = queries_[parity].emplace_back(
        std::make_unique<CommandList>(device_, device_.touch(), "query", options_.timing));
    list->begin();
    contact_.record(*list, i, hash_.view(live_.side(), live_.slots()), log_.head());
    list->end();
  }
}

Contact TouchSide::query(const Pose& pose, double budget_us) noexcept {
  Contact invalid{.proxy = pose.hip, .lost = failure_ != nullptr};
  if (failure_ || !isFinite(Vec3(pose.hip - origin_))) return invalid;
  try {
    const Stopwatch watch;
    const bool realtime = budget_us > 0;
    closeTick();
    // Nothing new is asked while a question is out.
    if (asked_ && !lateAnswerIsIn(pose, budget_us)) return bridge_->answer(pose);
    if (realtime && !mayAskWithin(budget_us)) return bridge_->answer(pose);
    ask(pose, realtime);
    open_ = Open{.pose = pose, .realtime = realtime};
    const double left_us = realtime ? std::max(kLook_us, budget_us - watch.elapsed_us()) : 0;
    if (!answerWithin(left_us, pose.time_s)) return bridge_->answer(pose);
    open_->answered = true;
    if (!realtime) closeTick();
    return last_;
  } catch (...) {
    failure_ = std::current_exception();
    invalid.lost = true;
    return invalid;
  }
}

void TouchSide::prepare() noexcept {
  if (failure_) return;
  try {
    closeTick();
    if (ahead_ && !asked_ && !waiting_) askAhead();
  } catch (...) {
    failure_ = std::current_exception();
  }
}

void TouchSide::closeTick() {
  const std::optional<Open> open = std::exchange(open_, std::nullopt);
  if (!open) return;
  if (open->realtime) bridge_->renew(open->pose, live_.parity());
  if (!open->answered) return;
  if (last_.valid) editIfYielding(open->realtime);
  compactFurther(open->realtime);
}

void TouchSide::askAhead() {
  settleLast();
  const std::uint32_t first = contact_.waiting(contact_.firstList());
  const Run run{live_.parity(), first, first};
  contact_.awaitAnother();
  waiting_ = Waiting{run, device_.touch().submit(lastList(run))};
}

void TouchSide::withdraw() {
  if (!waiting_) return;
  contact_.put({.pose = {.hip = Vec3(0), .tick = ++tick_}, .withdrawn = 1});
  device_.touch().wait(std::exchange(waiting_, std::nullopt)->ticket);
}

bool TouchSide::hearsTheHost() {
  askAhead();
  const Queue::Ticket ticket = waiting_->ticket;
  const bool waits = !device_.touch().isDone(ticket);
  const Stopwatch watch;
  withdraw();
  return waits && watch.elapsed_us() < kLongestDeafness_us;
}

bool TouchSide::lateAnswerIsIn(const Pose& pose, double budget_us) {
  const bool behindEdit = asked_->behindEdit;
  if (!answerWithin(budget_us > 0 ? kLook_us : 0, pose.time_s)) return false;
  // After an edit the next one waits for an answer in time: until the hand has felt the last. Where no edit was in the
  // way the GPU is slower than the ticks, and late answers are all there are.
  if (budget_us > 0 && last_.valid && !behindEdit) editIfYielding(true);
  if (budget_us > 0) compactFurther(true);
  return true;
}

bool TouchSide::mayAskWithin(double budget_us) const {
  if (wait_ == Wait::spin || !ended_) return true;  // ask() spins those us
  const Stopwatch watch;
  while (!device_.touch().isDone(*ended_)) {
    if (watch.elapsed_us() + kNap_us > budget_us) return false;
    std::this_thread::sleep_for(std::chrono::duration<double, std::micro>(kNap_us));
  }
  return true;
}

void TouchSide::ask(const Pose& pose, bool realtime) {
  settleLast();
  contact_.put({.pose = {.hip = Vec3(pose.hip - origin_), .tick = ++tick_}, .carried = stateOf(bridge_->newerStory())});
  bridge_->handedOver();
  sinceAsked_ = Stopwatch();
  asked_ = Asked{.pose = pose, .behindEdit = editInFlight_, .timed = wait_ == Wait::spin || !realtime};
  if (waiting_) {
    asked_->run = waiting_->run;
    asked_->ticket = std::exchange(waiting_, std::nullopt)->ticket;
  } else {
    submitQuestion();
  }
}

void TouchSide::submitQuestion() {
  const std::uint32_t first = contact_.firstList();
  asked_->run = {live_.parity(), first, first};
  asked_->ticket = device_.touch().submit(lastList(asked_->run));
}

void TouchSide::settleLast() {
  // The answer may have been seen some us before the driver lets its list run again.
  if (!ended_) return;
  device_.touch().wait(*std::exchange(ended_, std::nullopt), Wait::spin);
  if (wait_ == Wait::spin) lastTime_us_ += lastList(lastQuery_).sectionTime_us("contact");
}

bool TouchSide::answerWithin(double budget_us, double now_s) {
  const Stopwatch watch;
  while (true) {
    const double left_us = budget_us > 0 ? std::max(1.0, budget_us - watch.elapsed_us()) : 0;
    if (!runEndsWithin(left_us)) return false;
    const bool ahead = contact_.waits(asked_->run.last);
    if (ahead && !contact_.hasAnswered(tick_)) {  // it had ended before the question came
      submitQuestion();
      continue;
    }
    answeredAhead_ += ahead;
    const CommandList& ran = lastList(asked_->run);
    const auto next = contact_.nextList(asked_->run.last);
    if (next) {
      asked_->run.last = *next;
      asked_->ticket = device_.touch().submit(lastList(asked_->run));
    }
    if (asked_->timed && (next || wait_ != Wait::spin)) asked_->gpu_us += ran.sectionTime_us("contact");
    if (!next) break;
  }
  const Asked asked = *asked_;
  asked_.reset();
  ended_ = asked.ticket;
  lastQuery_ = asked.run;
  // Seen in memory, an answer comes before its time does: then it tells that of the run before.
  const double time_us = wait_ == Wait::spin ? std::exchange(lastTime_us_, asked.gpu_us) : asked.gpu_us;
  const shared::ContactSample sample = contact_.sample();
  collectEdit(asked.timed);
  log_.publish(sample.logHead);
  editsAnswered_ = log_.published();
  shortfalls_.truncatedTicks += (sample.flags & shared::kSampleTruncated) != 0;
  shortfalls_.thinnedTicks += (sample.flags & shared::kSampleThinned) != 0;
  last_ = {.proxy = asked.pose.hip + DVec3(sample.spring),
           .normal = DVec3(sample.normal),
           .touching = sample.touching != 0,
           .fresh = true,
           .valid = contact_.hasAnswered(tick_) && isFinite(sample.spring) && isFinite(sample.normal),
           .neighbours = sample.neighbours,
           .gpu_us = time_us};
  lastPose_ = asked.pose;
  if ((!last_.touching || !last_.valid) && !(edit_ && brushOn_ && edit_->unsettled())) endStroke();
  if (asked.dropped) {
    last_.touching = false;
    bridge_->heard(now_s);
  } else {
    bridge_->answered(last_, lastPose_, storyOf(sample, lastPose_.hip - origin_), now_s);
  }
  shortfalls_.thinnedPatches = bridge_->thinnedPatches();
  return true;
}

bool TouchSide::runEndsWithin(double budget_us) {
  Queue& queue = device_.touch();
  const bool answers = contact_.answers(asked_->run.last);
  // In real time a thread that may not spin naps: asleep in the driver it would wait for the driver's own threads,
  // which have no priority over anybody.
  const bool naps = wait_ != Wait::spin && budget_us > 0;
  if (!naps && (wait_ != Wait::spin || !answers)) return queue.wait(asked_->ticket, wait_, budget_us);
  // The shader's own words in the host's memory are the fastest sign. Now and then the driver is asked, who knows when
  // none will come, but may hold us up.
  constexpr int kLooks = 256;
  const bool asksDriver = !naps || !answers || budget_us <= kLook_us;
  const Stopwatch watch;
  while (true) {
    for (int look = 0; answers && look < (naps ? 1 : kLooks); ++look)
      if (contact_.hasAnswered(tick_)) return true;
    if (asksDriver && queue.isDone(asked_->ticket)) return true;
    const double left_us = budget_us > 0 ? budget_us - watch.elapsed_us() : kNap_us;
    if (left_us <= kLook_us) return false;
    if (naps) std::this_thread::sleep_for(std::chrono::duration<double, std::micro>(std::min(kNap_us, left_us)));
  }
}

void TouchSide::finish() {
  settle();
  log_.publish(download<std::uint32_t>(device_, log_.headBuffer(), 1)[0]);  // waits for the queue
  collectEdit(true);
  endStroke();
}

std::vector<PassRecord> TouchSide::passes() const {
  std::vector<PassRecord> all;
  for (std::uint32_t list = lastQuery_.first; list <= lastQuery_.last; ++list)
    std::ranges::copy(queries_[lastQuery_.parity][list]->passes(), std::back_inserter(all));
  if (edit_) {
    const CommandList& edit = lastEdit_ ? *lastEdit_ : chosenEdit();
    std::ranges::copy(edit.passes(), std::back_inserter(all));
  }
  return all;
}

}  // namespace palpate
