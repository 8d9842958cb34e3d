// Samples of bricks put together, on the side of who gets them: where a foreign one is looked at. Nothing of DDS is
// seen here but its samples.
#pragma once

#include <map>
#include <optional>
#include <set>

#include "engine/motion/brick_source.hpp"
#include "haptics/sharing/messages.hpp"

namespace palpate::sharing {

/// One thread uses it at a time.
class BrickAssembly {
 public:
  /// `room`: points that are known at once, at most.
  BrickAssembly(double edge, std::size_t room) : grid_(edge), room_(room) {}

  /// What is asked for from now on: all anew. What is known stays until it comes again, or has not come with the rest.
  std::uint32_t begin();
  std::uint32_t epoch() const { return epoch_; }
  /// Samples of the epoch that have come.
  std::uint64_t taken() const { return taken_; }

  enum class Heard {
    taken,
    old,  ///< of an epoch before
    gap   ///< something is missing: begin()
  };
  /// Once takeUpdate() has given what the last one completed. Throws NetworkError for what is no piece of such a cloud.
  Heard hear(const Bricks& sample);
  /// Pieces of this client's strokes that the sender has taken, up to this one; what has come has what became of them.
  std::uint64_t acked() const { return acked_; }
  /// A step that is complete, with the sender's time; once.
  std::optional<BrickUpdate> takeUpdate();

 private:
  void add(const BrickPart& part, const Bricks& sample, std::size_t at);
  void require(bool holds, const char* what) const;
  void finish(bool whole);

  BrickGrid grid_;
  std::size_t room_;
  std::uint32_t epoch_ = 0;
  std::uint64_t taken_ = 0, acked_ = 0;
  struct Coming {
    std::uint32_t total = 0;
    std::shared_ptr<Brick> brick;
  };
  std::map<BrickKey, Coming> coming_;  // of the step that is under way
  std::size_t comingPoints_ = 0;
  std::set<BrickKey> known_, before_;  // before_: of an epoch before, and not come again yet
  BrickUpdate next_;
  std::optional<BrickUpdate> ready_;
};

}  // namespace palpate::sharing
