// Positions of a session's hands, as received.
#pragma once

#include <optional>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "haptics/shared_presence.hpp"
#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/seen_others.hpp"

namespace palpate::sharing {

/// Maximum number of hands, or cameras, waiting to be read.
inline constexpr std::int32_t kMaxShown = 1024;

/// How far a hand or a camera can be from a cloud. Farther ones are ignored, so that drawing and computing need not
/// handle them.
class PresenceRoom {
 public:
  explicit PresenceRoom(const PointCloud& cloud);
  /// Whether a hand or a camera can be there.
  bool has(const DVec3& place) const;

 private:
  DVec3 middle_;
  double farthest_;
};

/// Not thread-safe.
class HeardHands {
 public:
  /// `cloud`: the hands are around it. `gone_s`: a hand that is silent for this long is removed. The participant and
  /// the topics must outlive it.
  HeardHands(const Participant& participant, const Topics& topics, const PointCloud& cloud, double gone_s);
  /// Processes what was received of that session; `own`: the client whose hands are ignored.
  void hear(const Id& session, const std::optional<Id>& own = std::nullopt);
  std::vector<SeenHand> all() const { return seen_.all(); }

 private:
  void hear(const HandSample& hand);

  PresenceRoom room_;
  Reader<HandSample> reader_;
  SeenOthers<SeenHand> seen_;
};

}  // namespace palpate::sharing
