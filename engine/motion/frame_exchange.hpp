#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "engine/core/priority_mutex.hpp"

namespace palpate {

/// Which half of a double-buffered cloud holds the newest complete frame: for one writer that alternates between the
/// halves, and one reader on another thread. The writer never waits for the reader: while a half is read, a write to it
/// is refused and the frame is written later.
class FrameExchange {
 public:
  struct Frame {
    std::uint32_t half = 0;
    double time_s = 0;
    std::uint64_t number = 0;  ///< number of frames published so far, from 1
  };

  // For the writer.
  /// Returns false while the half is read. After true it cannot be read until it is published again.
  bool beginWriting(std::uint32_t half);
  /// The half holds a complete frame, which is true for that time.
  void publish(std::uint32_t half, double time_s);

  // For the reader.
  /// Calls `read` with the newest complete frame, which is not written meanwhile. False if there is none, or none since
  /// the last call.
  bool read(const std::function<void(const Frame&)>& read);

 private:
  PriorityMutex mutex_;
  std::optional<Frame> newest_;
  std::optional<std::uint32_t> reading_;        // half
  std::uint64_t published_ = 0, lastRead_ = 0;  // frame numbers
};

}  // namespace palpate
