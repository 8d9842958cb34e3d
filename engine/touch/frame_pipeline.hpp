#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>

#include "engine/core/background_task.hpp"
#include "engine/core/cloud_frame.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/motion/frame_exchange.hpp"
#include "engine/spatial/live_cloud.hpp"
#include "engine/touch/live_index.hpp"

namespace palpate {

/// Result of FrameWriter::make().
enum class MadeFrame {
  none,      ///< no frame: all due frames have been made
  recorded,  ///< the next run of a recorded list writes it
  incoming   ///< its points are already in the incoming buffers
};

/// Writes the frames of a live cloud: the points that its next index is built from. make() runs on a thread of its own,
/// and never while a list that was recorded here runs.
class FrameWriter {
 public:
  virtual ~FrameWriter() = default;

  /// Slots of the live cloud.
  virtual std::size_t size() const = 0;
  /// Prepares the next of the frames due by `time_s`; `incoming`: the points that its index is built from, in any
  /// order. Throws Error on failure.
  virtual MadeFrame make(double time_s, const LiveCloud::Half& incoming) = 0;
  /// The current points and their velocities.
  struct Front {
    const LiveCloud::Half& points;
    const Buffer& velocities;
  };
  /// Records the writing of the points `incoming`, in any order, and of their velocities (shaders/shared/motion.h).
  virtual void record(CommandList& list, const Front& front, const LiveCloud::Half& incoming,
                      const Buffer& velocities) const = 0;
  /// Whether the frame has angular velocities besides the velocities.
  virtual bool turnsNormals() const { return false; }
  /// Times of the last frame made, as in CloudFrame, and whether the fourth words of its normals hold colours.
  virtual double time_s() const = 0;
  virtual double extrapolationLimit_s() const { return kMaxPointsAge_s; }
  virtual double comes_s() const { return 0; }
  virtual bool isColored() const = 0;
  /// Points of the last frame made; if it is looksAtPoints(), once its list has run.
  virtual std::uint64_t points() const { return size(); }
  /// Whether make() reads the current points: it then runs only after the previous frame has become them.
  virtual bool looksAtPoints() const { return false; }
};

/// Brings frames into the live cloud: has their points written, builds their index in the back half, and flips. If a
/// frame has fewer points than slots, the other slots are empty. No thread waits for a frame: against the clock a
/// thread makes it and submits it to the GPU, which builds it concurrently with the questions, on the background queue:
/// on the throughput queue it would wait for the picture being drawn. The next frame is made between the build of a
/// frame and its flip.
class FramePipeline {
 public:
  /// Starts with the frame of time 0. `writer` and `index`, which has as many slots, must outlive it.
  FramePipeline(Device& device, FrameWriter& writer, LiveIndex& index);
  ~FramePipeline() { stop(); }
  FramePipeline(const FramePipeline&) = delete;
  FramePipeline& operator=(const FramePipeline&) = delete;

  /// Virtual time: the frame of that time is felt from now on. Waits for it.
  void bring(double time_s);
  /// Against the clock, between ticks: requests frames for that time, and flips to a frame whose build is complete.
  /// True if the points have moved. `isRead`: the current points may still be read; call after the answer to a
  /// question. Throws the error that making a frame has thrown.
  bool goOn(double time_s, bool isRead);
  /// Waits for the frames in progress.
  void finish();
  /// Waits for work in progress and drops it, before destruction.
  void stop() noexcept;

  /// Time of the frame in each half of the live cloud, and the velocities of its points, in the layout of
  /// shaders/shared/motion.h.
  const PointsTime& pointsTime(std::uint32_t parity) const { return times_[parity]; }
  const Buffer& velocities(std::uint32_t parity) const { return velocities_[parity]; }

  /// A frame in the live cloud. If it is coloured, the normals' fourth words hold the colours: RGB, red in the lowest
  /// byte.
  struct Placed {
    const LiveCloud::Half& half;
    double time_s;
    bool colored;
    std::uint64_t points;  ///< in its slots
  };
  /// Calls `read` with the newest complete frame in the live cloud, which is not written meanwhile. False if there is
  /// no new frame since the last call. For one thread, any.
  bool read(const std::function<void(const Placed&)>& read);
  /// Slots of each half.
  std::uint32_t slots() const { return index_.cloud().slots(); }
  /// Copies that frame to the host, over the throughput queue.
  bool take(CloudFrame& frame);
  /// The points currently felt; not while a frame is in progress.
  CloudFrame front() const;

 private:
  std::uint32_t back() const { return 1 - index_.parity(); }
  // Indexed by the front half at submission; `builds`: the index build alone.
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
  // The frame is felt from now on.
  void hasArrived();
  CloudFrame fetch(Queue& queue, const Placed& placed) const;

  Device& device_;
  FrameWriter& writer_;
  LiveIndex& index_;
  std::array<Buffer, 2> velocities_;  // indexed by the half
  std::array<PointsTime, 2> times_{};
  std::array<bool, 2> colored_{};
  std::array<std::uint64_t, 2> points_{};
  LiveCloud::Half incoming_;        // in any order
  Lists listsFirst_, listsBeside_;  // on the latency queue, and on the background queue
  FrameExchange exchange_;
  std::unique_ptr<Queue> beside_;  // background queue: no picture precedes it, and it yields
  Queue* on_ = nullptr;            // queue of the last build; ticket_ is its submission
  Queue::Ticket ticket_ = 0;
  bool isBuilding_ = false;   // built or being built, not felt yet
  bool isMaking_ = false;     // the thread is making a frame and owns on_, ticket_ and made_ until it is done
  Queue::Ticket before_ = 0;  // submission that the thread waits for first; 0: none
  MadeFrame made_ = MadeFrame::none;
  std::atomic<double> wanted_s_ = 0;     // the newest requested time
  std::atomic<bool> mayWrite_ = true;    // the back half may be written: no answer from it is outstanding
  std::atomic<bool> isDropped_ = false;  // the frame being made is discarded
  BackgroundTask task_;                  // destroyed first
};

}  // namespace palpate
