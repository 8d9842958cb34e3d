#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "engine/core/priority_mutex.hpp"

namespace palpate {

/// Which half of a double-buffered cloud holds the newest whole frame: for one who writes frames, into one half and
/// the other, and one who reads whole ones on a thread of its own. The writer never waits for the reader: a half that
/// is read may not be written, and the frame that was meant for it comes later.
class FrameExchange {
 public:
  struct Frame {
    std::uint32_t half = 0;
    double time_s = 0;
    std::uint64_t number = 0;  ///< of all that were published, from 1
  };

  // Writer.
  /// Whether nobody reads the half. Then nobody will, until it is published again.
  bool beginWriting(std::uint32_t half);
  /// It holds a whole frame, which is true for that time.
  void publish(std::uint32_t half, double time_s);

  // Reader.
  /// Calls `read` with the newest whole frame, which is not written meanwhile. False where there is none, or none since
  /// the last time.
  bool read(const std::function<void(const Frame&)>& read);

 private:
  PriorityMutex mutex_;
  std::optional<Frame> newest_;
  std::optional<std::uint32_t> reading_;        // half
  std::uint64_t published_ = 0, lastRead_ = 0;  // numbers of frames
};

}  // namespace palpate
