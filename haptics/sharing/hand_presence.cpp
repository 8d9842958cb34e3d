#include "haptics/sharing/hand_presence.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace palpate::sharing {

namespace {

constexpr double kHand_s = 1.0 / 60;  // between two places of a hand
constexpr double kHandSeen_s = 2;     // after which a hand that says nothing is gone
constexpr double kFarthest = 1e6;     // that a hand can be, sizes of the cloud
constexpr std::size_t kMostHands = 256;

}  // namespace

HandRoom::HandRoom(const PointCloud& cloud)
    : middle_(cloud.origin + boundsOf(cloud).center()),
      farthest_(kFarthest * std::max(1.0, boundsOf(cloud).longestSide())) {}

bool HandRoom::has(const DVec3& place) const { return glm::distance(place, middle_) < farthest_; }

std::optional<HandPlace> HandRoom::placeOf(const Hand& hand) const {
  const DVec3 position(hand.position[0], hand.position[1], hand.position[2]);
  const DVec3 proxy(hand.proxy[0], hand.proxy[1], hand.proxy[2]);
  if (!has(position) || !has(proxy)) return std::nullopt;
  return HandPlace{.position = position, .proxy = proxy, .touching = hand.touching, .sculpts = hand.sculpts};
}

HandPresence::HandPresence(const JoinedSession& session, std::string name, const PointCloud& cloud)
    : session_(session),
      name_(std::move(name)),
      room_(cloud),
      writer_(session.participant, session.topics.hands, bestEffortQos()),
      reader_(session.participant, session.topics.hands, keepingInstances(bestEffortQos(), kMostShownHands)) {}

void HandPresence::turn() {
  reader_.take([&](const Hand& hand) { hear(hand); });
  std::erase_if(others_, [](const auto& one) { return one.second.since.elapsed_s() > 5 * kHandSeen_s; });
  if (lastShown_.elapsed_s() >= kHand_s) show();
}

std::vector<SeenHand> HandPresence::others() const {
  std::vector<SeenHand> seen;
  for (const auto& [client, other] : others_) {
    seen.push_back(other.seen);
    seen.back().age_s = other.since.elapsed_s();
    if (seen.back().age_s > kHandSeen_s) seen.pop_back();
  }
  return seen;
}

void HandPresence::hear(const Hand& hand) {
  if (!isSame(hand.session, session_.session) || isSame(hand.client, session_.client)) return;
  const std::optional<HandPlace> place = room_.placeOf(hand);
  if (!place) return;
  const Id client = idOf(hand.client);
  const auto known = others_.find(client);
  if (known == others_.end() && others_.size() >= kMostHands) return;
  if (known != others_.end() && known->second.last >= hand.number && known->second.since.elapsed_s() < kHandSeen_s)
    return;  // overtaken
  Other& other = others_[client];
  std::memcpy(&other.seen.number, client.data(), sizeof other.seen.number);
  other.last = hand.number;
  other.since = {};
  other.seen.name = printable(hand.name);
  other.seen.place = *place;
}

void HandPresence::show() {
  const std::optional<HandPlace> place = place_.load();
  if (!place) return;
  lastShown_ = {};
  Hand hand{};
  set(hand.session, session_.session);
  set(hand.client, session_.client);
  put(hand.name, name_);
  for (int axis = 0; axis < 3; ++axis) {
    hand.position[axis] = place->position[axis];
    hand.proxy[axis] = place->proxy[axis];
  }
  hand.orientation[3] = 1;
  hand.touching = place->touching;
  hand.sculpts = place->sculpts;
  hand.number = static_cast<std::uint32_t>(++shown_);
  writer_.write(hand);
}

}  // namespace palpate::sharing
