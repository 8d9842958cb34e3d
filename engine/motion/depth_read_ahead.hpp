#pragma once

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "engine/core/depth_stream.hpp"

namespace palpate {

/// Reads frames of a depth stream ahead on a thread of its own. A recorded stream waits until frames are taken; of a
/// live stream the oldest frame is dropped for the newest. Reading starts with the first request.
class DepthReadAhead {
 public:
  /// `loops`: after the last frame of a recorded stream the first one follows.
  DepthReadAhead(std::shared_ptr<DepthStream> stream, bool loops);
  /// Stops the stream.
  ~DepthReadAhead();
  DepthReadAhead(const DepthReadAhead&) = delete;
  DepthReadAhead& operator=(const DepthReadAhead&) = delete;

  const DepthStream& stream() const { return *stream_; }
  /// Position of a frame in a recorded stream.
  struct Place {
    std::uint64_t pass = 0;  ///< through the recording, from 0
    double time_s = 0;       ///< time of the frame in its pass
    bool isFirst = false;    ///< first readable frame of its pass
  };

  /// Recorded: position of the next frame to be taken. With `waits`, none means that no frame will follow; otherwise
  /// the next frame may still be read.
  std::optional<Place> peek(bool waits);
  /// Swaps the next frame with `frame`, whose memory is reused; false if there is none. `waits`: see peek().
  bool take(DepthFrame& frame, bool waits);

  /// Recorded: continues with the first frame of that pass.
  void restart(std::uint64_t pass);
  /// Recorded: frames before the one due at that time of that pass are late and need not be read.
  void passOver(std::uint64_t pass, double time_s);
  /// The pass that is being read.
  std::uint64_t pass() const;

  struct Counts {
    std::uint64_t lost = 0;     ///< could not be read
    std::uint64_t dropped = 0;  ///< late, or superseded by newer frames
    std::string lastLoss;       ///< reason of the last loss
    bool ended = false;         ///< no more frames will follow
  };
  /// From any thread.
  Counts counts() const;

 private:
  struct Read {
    DepthFrame frame;
    Place place;
  };
  using Lock = std::unique_lock<std::mutex>;
  void serve();
  bool waitForRoom(Lock& lock);
  void readOne(Lock& lock);
  void keep(DepthFrame frame);
  void endPass();
  bool waitForFrame(Lock& lock, bool waits);

  const std::shared_ptr<DepthStream> stream_;
  const bool isRecorded_, loops_;

  mutable std::mutex mutex_;  // guards the following members
  std::condition_variable changed_;
  std::deque<Read> queue_;
  std::vector<DepthFrame> spares_;  // memory of frames that were taken, for reuse
  Counts counts_;
  std::uint64_t pass_ = 0, readInPass_ = 0;
  std::optional<Place> late_;  // frames before it are late
  bool stops_ = false, restarts_ = false;

  std::jthread thread_;  // destroyed (joined) first
};

}  // namespace palpate
