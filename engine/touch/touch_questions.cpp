// The part of TouchSide that asks the GPU and takes its answers: ahead of the pose or with it, in time or late.
#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "engine/gpu/device.hpp"
#include "engine/touch/touch_side.hpp"

namespace palpate {

namespace {

constexpr double kLook_us = 1;  // a budget that lets no thread sleep
constexpr double kNap_us = 40;  // between looks, where spinning would starve the driver

// A question that was submitted ahead ends within so long after it was withdrawn, where the GPU hears the host at all.
constexpr double kLongestDeafness_us = 5000;

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

Contact TouchSide::query(const Pose& pose, double budget_us) noexcept {
  Contact invalid{.proxy = pose.hip, .lost = failure_ != nullptr};
  if (second_) second_->ask(pose);
  if (failure_ || !isFinite(Vec3(pose.hip - origin_)) || (tool_ && !tool_->isFiniteAt(pose, origin_)) ||
      (second_ && !isFinite(Vec3(SecondContact::placeOf(pose) - origin_))))
    return invalid;
  try {
    const Stopwatch watch;
    const bool realtime = budget_us > 0;
    closeTick();
    // Nothing new is asked while a question is out.
    if (asked_ && !lateAnswerIsIn(pose, budget_us)) return bridged(pose);
    if (realtime && !mayAskWithin(budget_us)) return bridged(pose);
    ask(pose, realtime);
    open_ = Open{.pose = pose, .realtime = realtime};
    const double left_us = realtime ? std::max(kLook_us, budget_us - watch.elapsed_us()) : 0;
    if (!answerWithin(left_us, pose.time_s)) return bridged(pose);
    open_->answered = true;
    if (!realtime) closeTick();
    return told();
  } catch (...) {
    failure_ = std::current_exception();
    invalid.lost = true;
    return invalid;
  }
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
  contact_.withdraw(++tick_);
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
  for (std::uint32_t i = 0; tool_ && i < tool_->size(); ++i) {
    const bool ahead = std::exchange(toolTrackers_[i].ahead, false);
    contact_.put({.pose = {.hip = Vec3(tool_->hip(i, pose) - origin_), .tick = tick_},
                  .carried = stateOf(ahead ? std::optional(toolTrackers_[i].tracker.story()) : std::nullopt)},
                 1 + i);
  }
  if (second_)
    contact_.put({.pose = {.hip = Vec3(SecondContact::placeOf(pose) - origin_), .tick = tick_}}, secondProbe());
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
  std::uint32_t flags = sample.flags;
  last_ = contactOf(sample, asked.pose.hip, time_us);
  lastPose_ = asked.pose;
  if (tool_) tool_->answered(last_, lastPose_);
  for (std::uint32_t i = 0; tool_ && i < tool_->size(); ++i) {
    const shared::ContactSample point = contact_.sample(1 + i);
    flags |= point.flags;
    // Where the patch has gone on since it was asked, an answer comes from the past.
    if (toolTrackers_[i].ahead) continue;
    const DVec3 hip = tool_->hip(i, lastPose_);
    const Contact contact = contactOf(point, hip, time_us);
    tool_->answered(i, contact);
    if (contact.valid) toolTrackers_[i].tracker.goOnFrom(storyOf(point, hip - origin_));
  }
  if (second_) {
    const shared::ContactSample theirs = contact_.sample(secondProbe());
    flags |= theirs.flags;
    second_->answered(contactOf(theirs, SecondContact::placeOf(lastPose_), time_us), lastPose_);
    if (asked.secondDropped) second_->forget();
  }
  shortfalls_.truncatedTicks += (flags & shared::kSampleTruncated) != 0;
  shortfalls_.thinnedTicks += (flags & shared::kSampleThinned) != 0;
  const bool rests = !last_.touching || !last_.valid || !lastPose_.sculpts;
  if (rests && !(edit_ && brushOn_ && edit_->unsettled())) endStroke();
  if (asked.dropped) {
    last_.touching = false;
    forgetTool();
    bridge_->heard(now_s);
  } else {
    bridge_->answered(last_, lastPose_, storyOf(sample, lastPose_.hip - origin_), now_s);
  }
  shortfalls_.thinnedPatches = bridge_->thinnedPatches();
  return true;
}

Contact TouchSide::contactOf(const shared::ContactSample& sample, const DVec3& hip, double time_us) const {
  return {.proxy = hip + DVec3(sample.spring),
          .normal = DVec3(sample.normal),
          .touching = sample.touching != 0,
          .fresh = true,
          .valid = contact_.hasAnswered(tick_) && isFinite(sample.spring) && isFinite(sample.normal),
          .neighbours = sample.neighbours,
          .gpu_us = time_us};
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

}  // namespace palpate
