#include "engine/matter/soft_touch.hpp"

#include <algorithm>
#include <cmath>

#include "engine/contact/proxy_tracker.hpp"
#include "engine/core/error.hpp"
#include "engine/core/named_values.hpp"

namespace palpate {

namespace {

constexpr double kNoAge_s = 1e-6;     // maximum age of points that count as of the tick itself
constexpr double kQuiet_s = 0.02;     // after a restart of the scene, as its surface may not be updated yet
constexpr double kSlack_N_ms = 0.06;  // maximum change of the force of a kept contact, whatever the body does
constexpr double kMinStiffness = 1e-6;
constexpr double kForVelocity_s = 2e-3;  // interval for the velocity of a hand

}  // namespace

SoftTouch::SoftTouch(std::unique_ptr<SoftSource> source, std::unique_ptr<TouchBackend> surface,
                     const SoftTouchOptions& options)
    : HeldSoftSource{std::move(source)}, TouchDecorator(std::move(surface)), answers_(options.tools.size()) {
  question_.friction = options.friction;
  poses_.reserve(options.tools.size());
  setBrush(options.brush);
  for (const ProbeGroup& probes : makeProbeGroups(options.tools)) {
    const std::size_t touches = std::max<std::size_t>(1, probes.points().size());
    hands_.push_back({.probes = probes,
                      .spring = {},
                      .points = {probes.points().begin(), probes.points().end()},
                      .keepers = std::vector<ContactKeeper>(touches),
                      .contacts = std::vector<Contact>(touches)});
  }
  PALPATE_CHECK_EQ(hands_.size(), inner().hands());
}

void SoftTouch::begin(bool realtime, std::span<const HandSpring> springs) {
  source_->setLeavesOut(realtime);
  PALPATE_CHECK_EQ(springs.size(), hands_.size());
  for (std::size_t i = 0; i < hands_.size(); ++i) hands_[i].spring = springs[i];
}

std::span<const Contact> SoftTouch::ask(std::span<const Pose> poses, double budget_us) noexcept {
  poses_.assign(poses.begin(), poses.end());
  lookAtScene(poses.front().time_s, false);
  if (std::ranges::all_of(poses, [](const Pose& pose) { return isFinite(pose.hip); })) tell(poses);
  const std::span<const Contact> answers = inner().ask(poses, budget_us);
  const double pointsTime_s = framesTime().value_or(PointsTime{}).true_s;
  lookAtScene(poses.front().time_s, std::abs(poses.front().time_s - pointsTime_s) < kNoAge_s);
  keep(poses, answers);
  remember(poses, answers);
  answer(poses, answers);
  return answers_;
}

// After a discontinuity of the surface a hand may be inside the body: it feels nothing until the new surface is certain
// to be present, and is then not pushed out.
void SoftTouch::lookAtScene(double time_s, bool isThere) {
  const bool held = source_->isPaused();
  const bool jumped = held || isPaused_ || beginnings_ != source_->beginnings();
  isPaused_ = held;
  beginnings_ = source_->beginnings();
  if (jumped) quietUntil_s_ = isThere && !held ? time_s : time_s + kQuiet_s;
  if (time_s < quietUntil_s_ - kQuiet_s) quietUntil_s_ = 0;  // time went back
  isQuiet_ = jumped || time_s < quietUntil_s_;
  if (isQuiet_)
    for (std::size_t i = 0; i < hands_.size(); ++i) resetHand(i);
}

// Sends the contacts of the last tick and the present positions of the hands.
void SoftTouch::tell(std::span<const Pose> poses) {
  question_.time_s = poses.front().time_s;
  question_.count = 0;
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    const Hand& hand = hands_[i];
    const std::uint32_t first = hand.points.empty() ? 0 : 1;
    for (std::uint32_t k = first; k < hand.probes.probes(); ++k) {
      SurfaceTouch& touch = question_.touches[question_.count++];
      const double share = first == 0 ? 1 : hand.points[k - 1].share;
      touch.hip = hand.probes.place(k, poses[i]);
      touch.spring = {.stiffness_N_per_unit = share * hand.spring.stiffness_N_per_unit,
                      .damping_N_s_per_unit = share * hand.spring.damping_N_s_per_unit,
                      .most_N = hand.spring.most_N};
      touch.hand = static_cast<std::uint32_t>(i);
      touch.felt = poses[i].felt.share(hand.spring.most_N);
    }
  }
  source_->ask(question_);
}

// Updates the contacts: at positions that the body carries if the points around the hands do not determine them.
void SoftTouch::keep(std::span<const Pose> poses, std::span<const Contact> answers) {
  if (const auto newest = source_->pressed()) pressed_ = *newest;
  std::size_t touch = 0;
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    Hand& hand = hands_[i];
    const std::span<const PointContact> points = inner().points(i);
    ContactKeeper::Tick tick{.hip = poses[i].hip,
                             .time_s = poses[i].time_s,
                             .friction = question_.friction,
                             .slack = kSlack_N_ms / std::max(kMinStiffness, hand.spring.stiffness_N_per_unit),
                             .radius = source_->radius()};
    for (std::size_t k = 0; k < hand.keepers.size(); ++k, ++touch) {
      if (!points.empty()) tick.hip = points[k].hip;
      const Contact& felt = points.empty() ? answers[i] : points[k].contact;
      if (!answers[i].valid || !felt.valid || isQuiet_) {
        hand.keepers[k].forget();
        hand.contacts[k] = felt;
      } else {
        hand.contacts[k] = keptBy(hand.keepers[k], felt, pressed_[touch], tick);
      }
    }
  }
}

Contact SoftTouch::keptBy(ContactKeeper& keeper, const Contact& felt, const PressedPlace& pressed,
                          const ContactKeeper::Tick& tick) {
  const Contact contact = keeper.follow(felt, pressed, tick);
  source_->count(keeper.isKept(), keeper.gaveWay());
  return contact;
}

// Stores the contacts for the next tick.
void SoftTouch::remember(std::span<const Pose> poses, std::span<const Contact> answers) {
  const double now_s = poses.front().time_s;
  question_.feltAt_s = now_s;
  question_.pointsTime_s = framesTime().value_or(PointsTime{}).true_s;
  question_.goesOn = question_.goesOn || now_s > question_.pointsTime_s + kNoAge_s;
  const std::size_t place = ticks_++ % kRemembered;
  times_s_[place] = now_s;
  rememberBrush(poses.front(), answers.front());
  std::uint32_t k = 0;
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    hands_[i].hips[place] = poses[i].hip;
    for (std::size_t p = 0; p < hands_[i].contacts.size(); ++p) {
      const Contact& contact = hands_[i].contacts[p];
      SurfaceTouch& touch = question_.touches[k++];
      touch.contact = hands_[i].keepers[p].contact();
      touch.isSamePlace = hands_[i].keepers[p].isSamePlace();
      touch.touching = contact.touching && contact.valid && answers[i].valid && !isQuiet_;
      touch.proxy = touch.touching ? hands_[i].keepers[p].place() : contact.proxy;
      touch.normal = contact.normal;
      touch.velocity = contact.velocity;
    }
  }
}

void SoftTouch::rememberBrush(const Pose& pose, const Contact& answer) {
  SurfaceBrush& brush = question_.brush;
  const bool touches = answer.touching && answer.valid && !isQuiet_;
  brush.hip = pose.hip;
  brush.spring = touches ? answer.proxy - pose.hip : DVec3(0);
  brush.normal = answer.normal;
  brush.touching = touches;
  brush.press = pose.press();
}

DVec3 SoftTouch::hipAt(const Hand& hand, double time_s) const {
  const std::size_t known = std::min(ticks_, kRemembered);
  // Backwards from the newest tick.
  for (std::size_t back = 1; back < known; ++back) {
    const std::size_t later = (ticks_ - back) % kRemembered, before = (ticks_ - back - 1) % kRemembered;
    if (times_s_[before] > time_s || !(times_s_[later] > times_s_[before])) continue;
    const double share = (time_s - times_s_[before]) / (times_s_[later] - times_s_[before]);
    return glm::mix(hand.hips[before], hand.hips[later], std::min(share, 1.0));
  }
  return hand.hips[(ticks_ - known) % kRemembered];
}

DVec3 SoftTouch::strayed(const Hand& hand, const Pose& pose, double age_s) const {
  const double from_s = pose.time_s - age_s;
  const DVec3 there = hipAt(hand, from_s);
  const DVec3 velocity = (there - hipAt(hand, from_s - kForVelocity_s)) / kForVelocity_s;
  const PointsTime points = *framesTime();
  return pose.hip - (there + std::min(age_s, points.extrapolationLimit_s) * velocity);
}

// The surface as if the hand's spring pressed on a spring as soft as the body there. It only yields: a hand that
// retracts earlier than extrapolated loses the surface that much earlier.
Contact SoftTouch::givenWay(Contact contact, const DVec3& strayed, double share) const {
  const double deeper = -glm::dot(strayed, contact.normal);
  if (contact.touching && deeper > 0) contact.proxy -= share * deeper * contact.normal;
  return contact;
}

void SoftTouch::answer(std::span<const Pose> poses, std::span<const Contact> answers) {
  const auto points = framesTime();
  const bool failed = !source_->failure().empty();
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    Hand& hand = hands_[i];
    const double age_s = points ? poses[i].time_s - points->true_s : 0;
    const double yields = hand.spring.stiffness_N_per_unit * source_->compliance(i);
    const DVec3 away = age_s > kNoAge_s ? strayed(hand, poses[i], age_s) : DVec3(0);
    const auto given = [&](const Contact& contact) { return givenWay(contact, away, yields / (1 + yields)); };
    const std::span<const PointContact> felt = inner().points(i);
    answers_[i] = given(felt.empty() ? hand.contacts.front() : answers[i]);
    for (std::size_t k = 0; k < felt.size(); ++k) {
      hand.points[k] = felt[k];
      hand.points[k].contact = given(hand.contacts[k]);
    }
    if (!failed && !isQuiet_) continue;
    answers_[i] = {.proxy = poses[i].hip, .fresh = answers[i].fresh, .valid = answers[i].valid && !failed};
    for (PointContact& point : hand.points) point.contact = {.proxy = point.hip, .valid = answers_[i].valid};
  }
}

void SoftTouch::resetHand(std::size_t hand) noexcept {
  inner().resetHand(hand);
  for (ContactKeeper& keeper : hands_[hand].keepers) keeper.forget();
  for (std::uint32_t k = 0; k < question_.count; ++k)
    if (question_.touches[k].hand == hand) question_.touches[k].touching = false;
  if (hand == 0) question_.brush.press = Press::none;
}

void SoftTouch::finish() {
  inner().finish();
  source_->endStroke();
  if (const std::string failure = source_->failure(); !failure.empty())
    throw Error("the simulation {}; restart it with more substeps or a slower hand", failure);
}

void SoftTouch::setBrush(const std::optional<BrushOptions>& brush) {
  if (brush && !brushHas(brush->kind, shared::kShapesBodies))
    throw UsageError("{} cannot change the shape of a soft body", nameOf(kBrushKinds, brush->kind));
  question_.brush.brush = brush;
}

void SoftTouch::exchange(ShapeStroke& stroke) {
  source_->exchange(stroke);
  if (!poses_.empty()) inner().query(poses_, 0);  // updates the felt surface, for readers before the next tick
}

BackendReport SoftTouch::report() const {
  BackendReport report = inner().report();
  report.scope = {.edits = false, .paints = false, .newPoints = 0};
  report.firstEdit_s.reset();
  return report;
}

void SoftTouch::setContact(SurfaceKind surface, double friction, std::string_view method) {
  inner().setContact(surface, friction, method);
  question_.friction = friction;
}

}  // namespace palpate
