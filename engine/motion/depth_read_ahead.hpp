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

/// Reads some frames of a depth stream ahead, on a thread of its own. A recorded stream waits for whoever takes them;
/// of a live one the oldest is dropped for the newest. It begins when the first frame is asked for.
class DepthReadAhead {
 public:
  /// `loops`: after the last frame of a recorded stream the first one comes again.
  DepthReadAhead(std::shared_ptr<DepthStream> stream, bool loops);
  /// Stops the stream.
  ~DepthReadAhead();
  DepthReadAhead(const DepthReadAhead&) = delete;
  DepthReadAhead& operator=(const DepthReadAhead&) = delete;

  const DepthStream& stream() const { return *stream_; }
  /// Which frame of a recorded stream it is.
  struct Place {
    std::uint64_t pass = 0;  ///< through the recording, from 0
    double time_s = 0;       ///< of the frame, in its pass
    bool isFirst = false;    ///< of those of its pass that could be read
  };

  /// Recorded: that of the next frame to be taken. Where `waits`, it comes or there is none for ever; otherwise it may
  /// be still to come.
  std::optional<Place> peek(bool waits);
  /// Swaps the next frame with `frame`, whose memory is used again; false where there is none. `waits`: as above.
  bool take(DepthFrame& frame, bool waits);

  /// Recorded: goes on with the first frame of that pass.
  void restart(std::uint64_t pass);
  /// Recorded: what comes before the frame that is due at that time of that pass is too late, and need not be read.
  void passOver(std::uint64_t pass, double time_s);
  /// The pass that frames are read of now.
  std::uint64_t pass() const;

  struct Counts {
    std::uint64_t lost = 0;     ///< could not be read
    std::uint64_t dropped = 0;  ///< too late, or for newer ones
    std::string lastLoss;       ///< why the last one of those was lost
    bool ended = false;         ///< no more will come
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

  mutable std::mutex mutex_;  // of what follows
  std::condition_variable changed_;
  std::deque<Read> queue_;
  std::vector<DepthFrame> spares_;  // memory of frames that were taken
  Counts counts_;
  std::uint64_t pass_ = 0, readInPass_ = 0;
  std::optional<Place> late_;  // what comes before it is
  bool stops_ = false, restarts_ = false;

  std::jthread thread_;  // goes first
};

}  // namespace palpate
