#include "engine/touch/touch_side.hpp"

#include <algorithm>
#include <utility>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/error.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/touch/part_options.hpp"
#include "engine/touch/question_pipeline.hpp"

namespace palpate {

TouchSide::TouchSide(Device& device, const PointCloud& cloud, const TouchOptions& options)
    : device_(device),
      options_(options),
      origin_(cloud.origin),
      hands_(makeHands()),
      answers_(hands_.size()),
      states_(hands_.back().firstProbe + hands_.back().probes.probes()),
      index_(device, fitting(device, cloud, options), indexOptions(device, cloud, options)),
      record_{.log = EditLog(device, options.brush ? index_.cloud().count() : 0)},
      questions_(device, contactOptions(), index_.hash().grid(), index_.cloud().slots(),
                 options.wait.value_or(device.defaultWait()), options.timing),
      frames_(device, options, index_, cloud.origin),
      rest_(hands_.size(), options.radius) {
  if (options.brush)
    edits_.emplace(device, editOptions(options), index_, record_.log, statistics_, colorsOf(cloud, options));
  makeBridge();
  recordAll();
  if (edits_) edits_->followIndex();
  questions_.warmUp();
  questions_.allowAhead(options.ahead, index_.parity());
  device_.noteUrgentWork(1);
}

TouchSide::~TouchSide() {
  device_.noteUrgentWork(-1);
  try {
    questions_.withdraw();
    frames_.stop();
    device_.waitIdle();
  } catch (const GpuError&) {  // device lost: nothing runs on it any more
  }
}

std::vector<TouchSide::GpuHand> TouchSide::makeHands() const {
  std::vector<GpuHand> hands;
  std::uint32_t probe = 0;
  for (const ProbeGroup& group : makeProbeGroups(options_.tools)) {
    hands.push_back({.probes = group, .firstProbe = probe, .points = {}});
    hands.back().points.assign(group.probes() - 1, {.tracker = ProxyTracker(options_.radius, options_.friction)});
    probe += group.probes();
  }
  return hands;
}

ContactOptions TouchSide::contactOptions() const {
  return {.radius = options_.radius,
          .method = options_.method,
          .surface = options_.surface,
          .localRadius = options_.localRadius,
          .widening = options_.widening,
          .friction = options_.friction,
          .split = options_.split,
          .pointsMove = moves(options_),
          .normalsTurn = normalsTurn(options_),
          .probes = hands_.back().firstProbe + hands_.back().probes.probes()};
}

void TouchSide::makeBridge() {
  bridge_.emplace(device_, index_.hash().grid(), origin_,
                  SurfaceOptions{.radius = options_.radius,
                                 .kind = options_.surface,
                                 .localRadius = options_.localRadius,
                                 .widening = options_.widening},
                  options_.friction, index_.cloud().slots(),
                  PatchFetch::Motion{.pointsMove = moves(options_), .normalsTurn = normalsTurn(options_)});
}

void TouchSide::recordAll() {
  for (int turn = 0; turn < 2; ++turn) {
    questions_.record(index_.parity(), index_.view(), record_.log.head(), frames_.velocities(index_.parity()));
    bridge_->record(index_.parity(), index_.view(), frames_.velocities(index_.parity()));
    if (edits_) edits_->record();
    index_.flip();
  }
  std::vector<ProbeRange> ranges;
  for (const GpuHand& hand : hands_) ranges.push_back({.first = hand.firstProbe, .count = hand.probes.probes()});
  questions_.recordForgetting(ranges);
}

void TouchSide::settle() {
  if (failure_) std::rethrow_exception(failure_);
  questions_.withdraw();
  if (questions_.isOut()) answerWithin(0, hands_.front().probes.ownPose().time_s);
}

void TouchSide::setContact(SurfaceKind surface, double friction, std::string_view name) {
  const QueryMethod method = queryMethodNamed(name);
  requireFused(options_, method);
  finish();
  device_.waitIdle();
  const std::vector<ProxyTracker::State> states = contacts();
  options_.surface = surface;
  options_.friction = friction;
  options_.method = method;
  for (GpuHand& hand : hands_)
    hand.points.assign(hand.points.size(), {.tracker = ProxyTracker(options_.radius, friction)});
  questions_.setContact(contactOptions(), index_.hash().grid(), index_.cloud().slots());
  makeBridge();
  recordAll();
  goOnFrom(states);
}

std::vector<ProxyTracker::State> TouchSide::contacts() const {
  std::vector<ProxyTracker::State> states;
  for (const ProbeState& probe : states_) states.push_back(probe.state);
  // What the patch has answered since then.
  if (const auto newer = bridge_->newerState()) states.front() = *newer;
  for (const GpuHand& hand : hands_)
    for (std::size_t k = 0; k < hand.points.size(); ++k)
      if (hand.points[k].ahead) states[hand.firstProbe + 1 + k] = hand.points[k].tracker.state();
  return states;
}

void TouchSide::restoreContacts(std::span<const ProxyTracker::State> states) {
  requireStates(states.size(), states_.size());
  settle();
  goOnFrom(states);
  if (edits_) edits_->restart();
}

// Also while the GPU is late: the bridge continues from the same states.
void TouchSide::goOnFrom(std::span<const ProxyTracker::State> states) {
  for (std::size_t i = 0; i < states.size(); ++i) states_[i] = {.state = states[i], .restored = true};
  const ProbeGroup& first = hands_.front().probes;
  bridge_->answered(first.own(), first.ownPose(), states_.front().state, first.ownPose().time_s);
  for (GpuHand& hand : hands_)
    for (std::size_t k = 0; k < hand.points.size(); ++k) {
      hand.points[k].tracker.goOnFrom(states[hand.firstProbe + 1 + k]);
      hand.points[k].ahead = false;
    }
}

void TouchSide::setBrush(const std::optional<BrushOptions>& brush) {
  if (!edits_) throw Error("{}: points can only be changed where they can be edited", device_.name());
  finish();
  edits_->setBrush(brush);
}

std::span<const Contact> TouchSide::ask(std::span<const Pose> poses, double budget_us) noexcept {
  PALPATE_CHECK_EQ(poses.size(), hands_.size());
  if (failure_ || !isFiniteAt(poses)) {
    fail(poses);
    return given();
  }
  try {
    if (isAnsweredWithin(poses, budget_us))
      for (GpuHand& hand : hands_) hand.probes.give();
    else
      bridge(poses);
  } catch (...) {
    failure_ = std::current_exception();
    fail(poses);
  }
  return given();
}

bool TouchSide::isAnsweredWithin(std::span<const Pose> poses, double budget_us) {
  const Stopwatch watch;
  const bool realtime = budget_us > 0;
  const double now_s = poses.front().time_s;
  if (realtime && mayRepeat(poses)) return true;
  // No new question while one is in flight.
  if (questions_.isOut() && !lateAnswerIsIn(now_s, budget_us)) return false;
  if (realtime && !questions_.mayAskWithin(budget_us)) return false;
  if (frames_.move() && !realtime) {
    questions_.withdraw();
    frames_.bring(now_s);
  }
  submitQuestion(poses, realtime);
  return answerWithin(realtime ? std::max(kPoll_us, budget_us - watch.elapsed_us()) : 0, now_s);
}

// Moving points, and work that is done after an answer, require questions; so does a tool of many points, which may
// rotate.
bool TouchSide::mayRepeat(std::span<const Pose> poses) const {
  const bool isPoint = states_.size() == hands_.size();
  return questions_.state() == QuestionState::ending && isPoint && !frames_.move() && !(edits_ && edits_->hasWork()) &&
         rest_.restsOn(poses, questions_.question().time_s);
}

bool TouchSide::isFiniteAt(std::span<const Pose> poses) const {
  for (std::size_t i = 0; i < hands_.size(); ++i)
    if (!hands_[i].probes.isFiniteAt(poses[i], origin_)) return false;
  return true;
}

void TouchSide::submitQuestion(std::span<const Pose> poses, bool realtime) {
  const double last_s = questions_.question().time_s;  // time of the states on the GPU
  questions_.begin();
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    GpuHand& hand = hands_[i];
    hand.probes.ask(poses[i]);
    const auto put = [&](std::uint32_t probe, std::optional<ProxyTracker::State> newer) {
      ProbeState& last = states_[hand.firstProbe + probe];
      if (std::exchange(last.restored, false) && !newer) newer = last.state;
      questions_.put(hand.firstProbe + probe, Vec3(hand.probes.place(probe, poses[i]) - origin_), stateOf(newer),
                     frames_.motionSince(newer ? newer->time_s : last_s, poses[i].time_s));
    };
    put(0, i == 0 ? bridge_->newerState() : std::nullopt);
    for (std::uint32_t k = 0; k < hand.points.size(); ++k) {
      const bool ahead = std::exchange(hand.points[k].ahead, false);
      put(1 + k, ahead ? std::optional(hand.points[k].tracker.state()) : std::nullopt);
    }
  }
  bridge_->handedOver();
  questions_.ask(poses.front().time_s, realtime, edits_ && edits_->isUnderWay(), index_.parity());
}

bool TouchSide::answerWithin(double budget_us, double now_s) {
  if (!questions_.isAnsweredWithin(budget_us)) return false;
  takeAnswer(now_s);
  return true;
}

bool TouchSide::lateAnswerIsIn(double now_s, double budget_us) {
  const bool behindEdit = questions_.question().behindEdit, realtime = budget_us > 0;
  if (!answerWithin(realtime ? kPoll_us : 0, now_s)) return false;
  // After an edit the next one waits for an answer in time, so that the hand has felt the last one. If no edit caused
  // the delay, the GPU is slower than the ticks, and all answers are late.
  if (realtime && !behindEdit) editIfYielding(true);
  if (!realtime) return true;
  bringFrame(now_s);
  index_.compactFurther(true);
  return true;
}

void TouchSide::takeAnswer(double now_s) {
  const Question& asked = questions_.question();
  if (edits_) edits_->collect(asked.timed ? nullptr : &asked.since);
  GpuHand& first = hands_.front();
  const shared::ContactSample sample = questions_.sample(first.firstProbe);
  publish(sample.logHead);
  record_.answered = record_.log.published();
  std::uint32_t flags = 0;
  for (GpuHand& hand : hands_) flags |= takeAnswers(hand);
  TouchShortfalls& shortfalls = statistics_.shortfalls;
  shortfalls.truncatedTicks += (flags & shared::kSampleTruncated) != 0;
  shortfalls.thinnedTicks += (flags & shared::kSampleThinned) != 0;
  const Contact own = first.probes.own();
  const Pose& pose = first.probes.ownPose();
  if (edits_ && own.valid)
    edits_->feel(own, pose, origin_);
  else if (edits_)
    edits_->lift();
  for (std::size_t i = 0; i < hands_.size(); ++i)
    if (asked.dropped[i]) forget(hands_[i]);
  if (asked.dropped[0])
    bridge_->heard(now_s);
  else
    bridge_->answered(own, pose, proxyStateOf(sample, pose.hip - origin_, pose.time_s), now_s);
  shortfalls.thinnedPatches = bridge_->thinnedPatches();
}

void TouchSide::publish(std::uint32_t head) {
  if (edits_)
    edits_->publish(head);
  else
    record_.log.publish(head);
}

std::uint32_t TouchSide::takeAnswers(GpuHand& hand) {
  std::uint32_t flags = 0;
  for (std::uint32_t i = 0; i < hand.probes.probes(); ++i) {
    const shared::ContactSample sample = questions_.sample(hand.firstProbe + i);
    flags |= sample.flags;
    const DVec3 hip = hand.probes.place(i, hand.probes.question());
    BridgedPoint* const point = i > 0 ? &hand.points[i - 1] : nullptr;
    // If the patch has continued since the question, the answer is outdated.
    if (point && point->ahead) continue;
    states_[hand.firstProbe + i].state = proxyStateOf(sample, hip - origin_, questions_.question().time_s);
    const Contact contact = contactOf(sample, hip, questions_);
    hand.probes.answered(i, contact);
    if (point && contact.valid)
      point->tracker.goOnFrom(proxyStateOf(sample, hip - origin_, questions_.question().time_s));
  }
  return flags;
}

std::span<const Contact> TouchSide::given() {
  for (std::size_t i = 0; i < hands_.size(); ++i) answers_[i] = hands_[i].probes.answer();
  return answers_;
}

void TouchSide::bridge(std::span<const Pose> poses) {
  GpuHand& first = hands_.front();
  const Contact own = bridge_->answer(poses.front());
  const double trust = bridge_->trust(poses.front().time_s);
  first.probes.bridge(own, poses.front(), trust, [&](std::uint32_t probe, const Pose& at) {
    BridgedPoint& point = first.points[probe - 1];
    const std::optional<Contact> contact = bridge_->follow(point.tracker, at);
    point.ahead = point.ahead || contact;
    return contact;
  });
  for (std::size_t i = 1; i < hands_.size(); ++i) hands_[i].probes.hold(poses[i]);
  bridged_.note(bridge_->isThinned());
}

void TouchSide::fail(std::span<const Pose> poses) {
  for (std::size_t i = 0; i < hands_.size(); ++i) hands_[i].probes.fail(poses[i], failure_ != nullptr);
}

void TouchSide::resetHand(std::size_t hand) noexcept {
  if (failure_) return;
  try {
    questions_.resetHand(hand);
    if (hand == 0) bridge_->reset();
    if (hand == 0 && edits_) edits_->lift();
    forget(hands_[hand]);
  } catch (...) {
    failure_ = std::current_exception();
  }
}

void TouchSide::forget(GpuHand& hand) {
  hand.probes.forget();
  for (std::uint32_t i = 0; i < hand.probes.probes(); ++i) states_[hand.firstProbe + i] = {};
  for (BridgedPoint& point : hand.points) {
    point.tracker.goOnFrom({});
    point.ahead = false;
  }
}

void TouchSide::endTick() noexcept {
  if (failure_) return;
  try {
    if (questions_.isInTick()) followAnswer();
    if (waitsAhead()) questions_.askAhead(index_.parity(), questions_.question().realtime);
  } catch (...) {
    failure_ = std::current_exception();
  }
}

// A question that waits keeps the GPU busy, for a whole tick.
bool TouchSide::waitsAhead() {
  // In virtual time the frame of the next pose must be built first.
  if (!questions_.question().realtime) return !frames_.move();
  const double now_s = questions_.question().time_s;
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    const ProbeGroup& probes = hands_[i].probes;
    rest_.note(i, probes.question().hip, probes.answer().neighbours > 0, now_s);
  }
  return !rest_.rests(now_s);
}

void TouchSide::followAnswer() {
  const bool answered = questions_.state() == QuestionState::answered, realtime = questions_.question().realtime;
  questions_.closeTick();
  const double asked_s = questions_.question().time_s;
  // Before a patch is requested, so that it is of the new frame.
  if (answered && realtime) bringFrame(asked_s);
  if (realtime) bridge_->renew(hands_.front().probes.question(), index_.parity(), frames_.pointsTime());
  if (!answered) return;
  editIfYielding(realtime);
  index_.compactFurther(realtime);
}

void TouchSide::bringFrame(double time_s) {
  if (frames_.goOn(time_s, bridge_->isFetching())) bridge_->edited(time_s);
}

void TouchSide::editIfYielding(bool realtime) {
  const ProbeGroup& hand = hands_.front().probes;
  if (!edits_) return;
  const auto brushEdits = [&] {
    if (!edits_->editIfYielding(hand.ownPose().time_s, realtime)) return false;
    bridge_->edited(hand.ownPose().time_s);
    return true;
  };
  // As on the CPU: in real time the brush and offered changes alternate.
  const bool brushFirst = realtime && hand.own().valid && edits_->lastWasOffer();
  if (brushFirst && brushEdits()) return;
  if (edits_->takeUpOffer(hand.ownPose().time_s, realtime)) {
    bridge_->edited(hand.ownPose().time_s);
    if (realtime) return;  // the brush continues with the next tick
  }
  if (hand.own().valid && !brushFirst) brushEdits();
}

void TouchSide::finish() {
  settle();
  if (edits_)
    edits_->finish();
  else
    publish(download<std::uint32_t>(device_, record_.log.headBuffer(), 1)[0]);  // waits for the queue
  frames_.finish();
}

void TouchSide::change(std::span<const PointChange> changes) {
  if (!edits_) throw Error("{}: points can only be changed where they can be edited", device_.name());
  finish();
  edits_->change(changes);
  record_.answered = record_.log.published();
  bridge_->edited(hands_.front().probes.ownPose().time_s);
}

bool TouchSide::replace(const PointSet& changed, std::span<const PointState> states, const PointSet& without) {
  if (!edits_) return false;
  finish();
  edits_->replace(changed, states, without);
  bridge_->edited(hands_.front().probes.ownPose().time_s);
  return true;
}

void TouchSide::lock(const PointLock& lock) {
  if (!edits_) {
    if (lock.empty()) return;
    throw Error("{}: points can only be locked where they can be edited", device_.name());
  }
  finish();
  edits_->lock(lock);
}

std::size_t TouchSide::readBack(PointCloud& cloud) const {
  if (frames_.move()) return frames_.readBack(cloud);
  return edits_ ? edits_->readBack(cloud) : 0;
}

}  // namespace palpate
