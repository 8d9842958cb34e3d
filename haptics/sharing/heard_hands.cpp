#include "haptics/sharing/heard_hands.hpp"

#include <algorithm>

namespace palpate::sharing {

namespace {

constexpr double kFarthest = 1e6;  // maximum distance of a hand, in sizes of the cloud

}  // namespace

PresenceRoom::PresenceRoom(const PointCloud& cloud)
    : middle_(cloud.origin + boundsOf(cloud).center()),
      farthest_(kFarthest * std::max(1.0, boundsOf(cloud).longestSide())) {}

bool PresenceRoom::has(const DVec3& place) const { return glm::distance(place, middle_) < farthest_; }

HeardHands::HeardHands(const Participant& participant, const Topics& topics, const PointCloud& cloud, double gone_s)
    : room_(cloud), reader_(participant, topics.hands, keepingInstances(bestEffortQos(), kMaxShown)), seen_(gone_s) {}

void HeardHands::hear(const Id& session, const std::optional<Id>& own) {
  seen_.forget();
  reader_.take([&](const HandSample& hand) {
    if (isSame(hand.session, session) && !(own && isSame(hand.client, *own))) hear(hand);
  });
}

void HeardHands::hear(const HandSample& hand) {
  const HandPlace place{.position = DVec3(hand.position[0], hand.position[1], hand.position[2]),
                        .proxy = DVec3(hand.proxy[0], hand.proxy[1], hand.proxy[2]),
                        .touching = hand.touching,
                        .sculpts = hand.sculpts};
  if (hand.which >= kMaxHands || !room_.has(place.position) || !room_.has(place.proxy)) return;
  std::string name = printable(hand.name);
  if (hand.which > 0) name += fmt::format(", hand {}", hand.which + 1);
  seen_.hear(idOf(hand.client), hand.which, hand.number, {.name = std::move(name), .place = place});
}

}  // namespace palpate::sharing
