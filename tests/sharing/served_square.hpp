// Clients that receive only the points around their hands, and a square cloud for them.
#pragma once

#include <doctest/doctest.h>

#include <optional>
#include <string>

#include "haptics/sharing/brick_cloud.hpp"
#include "haptics/sharing/messages.hpp"
#include "tests/sharing/own_network.hpp"

namespace palpate {

/// A square of 200 x 200 points, one apart.
inline PointCloud square(float height = 0) {
  PointCloud cloud;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      cloud.positions.emplace_back(x, y, height);
      cloud.normals.emplace_back(0, 0, 1);
    }
  return cloud;
}

inline JoinedCloud joinNear(const std::string& name, Log* log = nullptr) {
  return joinCloud(name, {.network = ownNetwork(), .partial = true, .log = log});
}

inline HandReaches handAt(const DVec3& hip) {
  HandReaches hands{.time_s = steadyNow_s(), .steady_s = steadyNow_s(), .count = 1};
  hands.hands[0] = {.low = hip - 3.0, .high = hip + 3.0, .hip = hip, .proxy = hip};
  return hands;
}

/// A hand moves there; whether the points around it are known, or are received within half a minute.
inline bool comesTo(const DVec3& hip, BrickSource& source) {
  const HandReaches hands = handAt(hip);
  source.ask(hands);
  return source.await(hands, 30);
}

/// Number of points of the newest frame within 3 of the hand.
inline std::size_t around(BrickSource& source, const DVec3& hip, CloudFrame& frame) {
  source.makeFrame(steadyNow_s(), frame);
  std::size_t found = 0;
  for (const Vec3& position : frame.positions) found += glm::distance(DVec3(position), hip) < 3;
  return found;
}

/// Facts of the one session that is served here.
inline sharing::Facts announcedFacts(dds_entity_t participant, const sharing::Topics& topics) {
  const sharing::Reader<sharing::Facts> facts(participant, topics.facts, sharing::reliableQos(true));
  std::optional<sharing::Facts> heard;
  REQUIRE(within(30, [&] {
    facts.take([&](const sharing::Facts& one) { heard = one; });
    return heard.has_value();
  }));
  return *heard;
}

}  // namespace palpate
