// Reassembles bricks from samples on the client; samples of foreign origin are validated here. Depends on nothing of
// DDS but the sample types.
#pragma once

#include <map>
#include <optional>
#include <set>

#include "haptics/sharing/brick_source.hpp"
#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/sample_order.hpp"

namespace palpate::sharing {

/// Not thread-safe.
class BrickAssembly {
 public:
  /// `room`: maximum number of points known at once.
  BrickAssembly(double edge, std::size_t room) : grid_(edge), room_(room) {}

  /// Starts a new epoch, in which everything is requested again. Known bricks stay until they are received again, or
  /// until a whole update of the new epoch lacks them.
  std::uint32_t begin();
  std::uint32_t epoch() const { return order_.epoch(); }
  /// Samples received in this epoch.
  std::uint64_t taken() const { return order_.taken(); }

  /// A gap: call begin(). Requires that takeUpdate() has returned the previous completed step. Throws NetworkError if
  /// the sample is not a valid part of such a cloud.
  Heard hear(const Points& sample);
  /// Last piece of this client's strokes that the sender has taken; the received bricks contain its effect.
  std::uint64_t acked() const { return acked_; }
  /// The completed step, with the sender's time; returned once.
  std::optional<BrickUpdate> takeUpdate();

 private:
  void add(const BrickPart& part, const Points& sample, std::size_t at);
  void require(bool holds, const char* what) const;
  void finish(bool whole);

  BrickGrid grid_;
  std::size_t room_;
  SampleOrder order_;
  std::uint64_t acked_ = 0;
  struct Coming {
    std::uint32_t total = 0;
    std::uint64_t checksum = 0;
    std::shared_ptr<Brick> brick;
  };
  std::map<BrickKey, Coming> coming_;  // of the step in progress
  std::size_t comingPoints_ = 0;
  std::set<BrickKey> known_, before_;  // before_: bricks of an earlier epoch that were not received again yet
  BrickUpdate next_;
  std::optional<BrickUpdate> ready_;
};

}  // namespace palpate::sharing
