#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/core/cloud_frame.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/spatial/live_cloud.hpp"

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

}  // namespace palpate
