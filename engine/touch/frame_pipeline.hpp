#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <map>
#include <memory>

#include "engine/core/background_task.hpp"
#include "engine/core/cloud_frame.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/motion/frame_exchange.hpp"
#include "engine/touch/frame_writer.hpp"
#include "engine/touch/live_index.hpp"

namespace palpate {

/// Brings frames into the live cloud: has their points written, builds their index in the back half, and flips. Where a
/// frame has fewer points than there are slots, the others are empty. Nobody waits for a frame: against the clock a
/// thread makes it and hands it to the GPU, where it is built beside the questions, on the queue of the background: in
/// that of throughput it would wait until a picture is drawn. Once it is built, and before it is felt, the next one is
/// made.
class FramePipeline {
 public:
  /// Begins with the frame of time 0. `writer` and `index`, which has as many slots, must outlive it.
  FramePipeline(Device& device, FrameWriter& writer, LiveIndex& index);
  ~FramePipeline() { stop(); }
  FramePipeline(const FramePipeline&) = delete;
  FramePipeline& operator=(const FramePipeline&) = delete;

  /// Virtual time: the frame of that time is felt from now on. Waits for it.
  void bring(double time_s);
  /// Against the clock, between ticks: that time is the newest one, for which frames are made, and the one that is
  /// found built is felt from now on. True where the points have moved. `isRead`: somebody may still read the points as
  /// they are felt so far; after the answer to a question. Throws what the making of a frame has thrown.
  bool goOn(double time_s, bool isRead);
  /// Waits for the frames that are under way.
  void finish();
  /// Waits for what is under way, and drops it: for who goes.
  void stop() noexcept;

  /// The time of the frame in each half of the live cloud, and the velocities of its points, as shaders/shared/motion.h
  /// has them.
  const PointsTime& pointsTime(std::uint32_t parity) const { return times_[parity]; }
  const Buffer& velocities(std::uint32_t parity) const { return velocities_[parity]; }

  /// A frame as it stands in the live cloud. Where it is coloured, the normals' fourth words have the colours: RGB, red
  /// in the lowest byte.
  struct Placed {
    const LiveCloud::Half& half;
    double time_s;
    bool colored;
  };
  /// Calls `read` with the newest whole frame in the live cloud, which is not written meanwhile. False where none has
  /// come since the last time. For one thread, which may be another one.
  bool read(const std::function<void(const Placed&)>& read);
  /// Of each half.
  std::uint32_t slots() const { return index_.cloud().slots(); }
  /// The same on the host. Over the throughput queue.
  bool take(CloudFrame& frame);
  /// The points as they are felt now; not while a frame is under way.
  CloudFrame front() const;

 private:
  std::uint32_t back() const { return 1 - index_.parity(); }
  // By the half that is felt before; and the build alone.
  struct Lists {
    std::array<std::map<SortMethod, std::unique_ptr<CommandList>>, 2> frames, builds;
  };
  void record(const Queue& queue, Lists& lists);
  double frameTime_s(std::uint32_t parity) const { return times_[parity].true_s - times_[parity].comes_s; }
  void fillWithZeros(Queue& queue, const Buffer& velocities) const;
  void runNow();
  void make();
  void startMaking();
  bool isMade(double budget_us);
  void allowWriting(bool may);
  void submit(Queue& queue, const Lists& lists);
  // It is felt from now on.
  void hasArrived();
  CloudFrame fetch(Queue& queue, const Placed& placed) const;

  Device& device_;
  FrameWriter& writer_;
  LiveIndex& index_;
  std::array<Buffer, 2> velocities_;  // by the half
  std::array<PointsTime, 2> times_{};
  std::array<bool, 2> colored_{};
  LiveCloud::Half incoming_;        // in any order
  Lists listsFirst_, listsBeside_;  // before all questions, and beside them
  FrameExchange exchange_;
  std::unique_ptr<Queue> beside_;  // of the background, which no picture has before it, and which gives way
  Queue* on_ = nullptr;            // that builds, and the last frame there
  Queue::Ticket ticket_ = 0;
  bool isBuilding_ = false;   // it is not felt yet
  bool isMaking_ = false;     // the thread makes one: until it has, who builds and what was made are its own
  Queue::Ticket before_ = 0;  // what it waits for first; 0: nothing
  MadeFrame made_ = MadeFrame::none;
  std::atomic<double> wanted_s_ = 0;     // the newest time
  std::atomic<bool> mayWrite_ = true;    // the back half: the last answers from it have come
  std::atomic<bool> isDropped_ = false;  // what is made is nobody's any more
  BackgroundTask task_;                  // goes first
};

}  // namespace palpate
