// Where the hands of a session are, as it is heard.
#pragma once

#include <optional>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "haptics/shared_presence.hpp"
#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/seen_others.hpp"

namespace palpate::sharing {

/// Hands, or cameras, that wait to be heard, at most.
inline constexpr std::int32_t kMaxShown = 1024;

/// How far a hand or a camera can be from a cloud: farther nobody looks, and nothing that draws or computes has to.
class PresenceRoom {
 public:
  explicit PresenceRoom(const PointCloud& cloud);
  /// Whether somebody can be there.
  bool has(const DVec3& place) const;

 private:
  DVec3 middle_;
  double farthest_;
};

/// One thread uses it at a time.
class HeardHands {
 public:
  /// `cloud`: about which they are. `gone_s`: after which a hand that says nothing is gone. The participant and the
  /// topics outlive it.
  HeardHands(const Participant& participant, const Topics& topics, const PointCloud& cloud, double gone_s);
  /// What has come, of that session; `own`: the client whose hands are not meant.
  void hear(const Id& session, const std::optional<Id>& own = std::nullopt);
  std::vector<SeenHand> all() const { return seen_.all(); }

 private:
  void hear(const HandSample& hand);

  PresenceRoom room_;
  Reader<HandSample> reader_;
  SeenOthers<SeenHand> seen_;
};

}  // namespace palpate::sharing
