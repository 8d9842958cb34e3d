#include "haptics/sharing/near_feed.hpp"

#include <algorithm>
#include <cmath>

#include "haptics/sharing/seen_others.hpp"

namespace palpate::sharing {

namespace {

constexpr LedgerLimits kStillLimits{.known = 1 << 17, .atOnce = 1024};
constexpr LedgerLimits kMovingLimits{.known = 1 << 13, .atOnce = 1 << 13};
// Sizes within a sample, which is one Ethernet frame (messages.hpp).
constexpr std::size_t kRoom_bytes = 1200, kHead_bytes = 24, kPoint_bytes = 32, kVelocity_bytes = 12;

}  // namespace

void NearPoints::show(std::shared_ptr<const CloudFrame> frame, std::span<const SeenHand> hands) {
  forces_N_.clear();
  for (const SeenHand& hand : hands)
    if (hand.force_N != DVec3(0)) forces_N_[hand.number] = hand.force_N;
  frame_ = std::move(frame);
  isOld_ = true;
}

HandsForces NearPoints::forcesOn(const Id& client) const {
  HandsForces forces{};
  for (std::uint8_t hand = 0; hand < kMaxHands; ++hand)
    if (const auto on = forces_N_.find(handNumber(client, hand)); on != forces_N_.end())
      for (int axis = 0; axis < 3; ++axis) forces[3 * hand + axis] = static_cast<float>(on->second[axis]);
  return forces;
}

double NearPoints::showDue_s() const {
  constexpr double kApart_s = 0.005;  // between two searches of a frame
  if (!frame_ || !isOld_) return kIdle_s;
  return since_ ? kApart_s - since_->elapsed_s() : 0;
}

void NearPoints::showNow(const std::unordered_set<BrickKey>& wanted) {
  since_.emplace();
  isOld_ = false;
  bricks_.show(*frame_, wanted);
}

// Applies the edits of a static cloud to its bricks.
void NearPoints::follow() {
  if (!isBuilt_) {
    isBuilt_ = true;
    place_.upTo = points_.head();
    bricks_.build(points_.points());
  }
  constexpr std::size_t kAtOnce = 4096;
  while (points_.isBehind(place_)) {
    states_.clear();
    points_.collect(place_, Id{}, kAtOnce, states_);
    for (const PointState& state : states_) bricks_.follow(state.number);
  }
}

bool NearFeed::isValid(const Want& want) {
  constexpr double kFarthest = 1e30;  // fits into float32
  const std::span<const palpate_sharing_Ball> balls(want.balls._buffer, want.balls._length);
  return balls.size() <= kMaxBalls && std::ranges::all_of(balls, [](const palpate_sharing_Ball& ball) {
           return ball.radius >= 0 && ball.radius <= kFarthest &&
                  std::ranges::all_of(ball.center, [](double x) { return std::abs(x) <= kFarthest; });
         });
}

void NearFeed::take(const Want& want) {
  std::vector<Ball> balls;
  for (std::uint32_t i = 0; i < want.balls._length; ++i) {
    const palpate_sharing_Ball& ball = want.balls._buffer[i];
    balls.push_back({.center = DVec3(ball.center[0], ball.center[1], ball.center[2]), .radius = ball.radius});
  }
  if (balls == (asked_ ? *asked_ : balls_)) return;
  if (!asked_) since_ = Stopwatch::Clock::now();
  asked_ = std::move(balls);
}

std::optional<Stopwatch::Clock::time_point> NearFeed::waitsSince() const {
  return asked_ ? std::optional(since_) : std::nullopt;
}

void NearFeed::lookUp() {
  balls_ = std::move(*asked_);
  asked_.reset();
  wanted_ = bricksIn(balls_, points_.bricks().grid());
  wantsMore_ = true;
  points_.wantOthers();
}

bool NearFeed::next(StreamSample& sample, const ClientStream& to) {
  if (!outgoing_ && !begin(to)) return false;
  fill(sample);
  const BrickLedger::Step& step = outgoing_->step;
  sample.head.true_s = outgoing_->true_s;
  sample.head.whole = step.whole;
  sample.head.acked = outgoing_->acked;
  sample.head.last = outgoing_->dropped == step.dropped.size() && outgoing_->brick == step.bricks.size();
  if (sample.head.last) outgoing_.reset();
  return true;
}

// Bricks were just updated: a client that has all it wants also has the results of its strokes so far. Moving points
// are useless once newer ones exist: nothing is queued on a link that is too slow for all frames.
bool NearFeed::begin(const ClientStream& to) {
  const std::uint64_t acked = points_.edited().lastOf(client_);
  const bool moves = points_.moves();
  const bool isNews = wantsMore_ || seen_ != points_.bricks().version() || acked > acked_;
  if (!isNews || (moves && !(points_.isShown() && to.keepsUp()))) return false;
  Outgoing going{.step = ledger_.next(balls_, wanted_, points_.bricks(), moves ? kMovingLimits : kStillLimits),
                 .forces = points_.forcesOn(client_),
                 .true_s = points_.bricks().true_s(),
                 .acked = acked_};
  wantsMore_ = !going.step.whole;
  seen_ = points_.bricks().version();
  if (going.step.whole) going.acked = acked;
  // A force that does not change is sent again, or it would count as old.
  const bool isFelt = going.forces != HandsForces{} || going.forces != forces_;
  if (going.step.isEmpty() && going.acked == acked_ && !isFelt) return false;
  acked_ = going.acked;
  forces_ = going.forces;
  outgoing_ = std::move(going);
  ++steps_;
  return true;
}

void NearFeed::fill(StreamSample& sample) {
  Outgoing& going = *outgoing_;
  sample.forces = going.forces;
  std::size_t room = kRoom_bytes;
  if (going.forces != HandsForces{}) room -= sizeof going.forces;
  const BrickLedger::Step& step = going.step;
  for (; going.dropped < step.dropped.size() && room >= kHead_bytes; ++going.dropped, room -= kHead_bytes)
    sample.parts.push_back({.key = step.dropped[going.dropped], .total = kBrickDropped, .count = 0, .checksum = 0});
  while (going.brick < step.bricks.size() && room >= kHead_bytes) {
    const auto& [key, block] = step.bricks[going.brick];
    const std::shared_ptr<const Brick>& brick = block.points;
    const bool moves = !brick->velocities.empty();
    const std::size_t each = kPoint_bytes + (moves ? kVelocity_bytes : 0);
    const std::size_t count = std::min(brick->size() - going.point, (room - kHead_bytes) / each);
    if (count == 0 && brick->size() > 0) break;
    sample.parts.push_back({.key = key,
                            .total = static_cast<std::uint32_t>(brick->size()),
                            .count = static_cast<std::uint32_t>(count),
                            .checksum = block.checksum});
    for (std::size_t i = going.point; i < going.point + count; ++i) {
      Point point{};
      for (int axis = 0; axis < 3; ++axis) {
        point.position[axis] = brick->positions[i][axis];
        point.normal[axis] = brick->normals[i][axis];
        if (moves) sample.velocities.push_back(brick->velocities[i][axis]);
      }
      if (!brick->colors.empty()) point.color = brick->colors[i];
      sample.ids.push_back(brick->ids[i]);
      sample.points.push_back(point);
    }
    room -= kHead_bytes + count * each;
    going.point += count;
    if (going.point < brick->size()) break;
    ++going.brick;
    going.point = 0;
  }
}

}  // namespace palpate::sharing
