// Where the hands of a session are: this one is shown to the others, and they are seen.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/latest_value.hpp"
#include "haptics/shared_follower.hpp"
#include "haptics/sharing/joined_session.hpp"

namespace palpate::sharing {

/// Clients whose hands wait to be heard, at most.
inline constexpr std::int32_t kMostShownHands = 1024;

/// How far a hand can be from a cloud: farther nobody looks, and nothing that draws or computes has to.
class HandRoom {
 public:
  explicit HandRoom(const PointCloud& cloud);
  /// Nothing where it is beyond, or nowhere.
  std::optional<HandPlace> placeOf(const Hand& hand) const;
  /// Whether somebody can be there.
  bool has(const DVec3& place) const;

 private:
  DVec3 middle_;
  double farthest_;
};

/// One thread uses it at a time, but for moved() and place().
class HandPresence {
 public:
  /// The session outlives it. `name`: of this hand, where the others see it. `cloud`: about which the others are.
  HandPresence(const JoinedSession& session, std::string name, const PointCloud& cloud);
  /// Where this hand is. Waits for nobody.
  void moved(const HandPlace& place) noexcept { place_.store(place); }
  std::optional<HandPlace> place() const noexcept { return place_.load(); }
  /// Hears of the others, and shows this hand when it is time to.
  void turn();
  /// Those that were heard within the last seconds.
  std::vector<SeenHand> others() const;

 private:
  struct Other {
    SeenHand seen;
    Stopwatch since;
    std::uint64_t last = 0;
  };
  void hear(const Hand& hand);
  void show();

  const JoinedSession& session_;
  std::string name_;
  HandRoom room_;
  Writer<Hand> writer_;
  Reader<Hand> reader_;
  std::map<Id, Other> others_;
  std::uint64_t shown_ = 0;  // times
  Stopwatch lastShown_;
  LatestValue<HandPlace> place_;
};

}  // namespace palpate::sharing
