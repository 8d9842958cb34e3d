#pragma once

#include <cstddef>

#include "engine/core/cloud_frame.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/spatial/live_cloud.hpp"

namespace palpate {

/// What a FrameWriter has made ready.
enum class MadeFrame {
  none,      ///< nothing: all that are due have been made
  recorded,  ///< the next run of a recorded list brings it
  incoming   ///< its points stand in the incoming ones already
};

/// Where the frames of a live cloud come from: whoever writes the points that its next index is built from. make() runs
/// on a thread of its own, and not while a list that was recorded here runs.
class FrameWriter {
 public:
  virtual ~FrameWriter() = default;

  /// Slots of the live cloud.
  virtual std::size_t size() const = 0;
  /// Makes ready the next one of the frames that are due by `time_s`; `incoming`: the points that its index is built
  /// from, in any order. Throws Error where it cannot.
  virtual MadeFrame make(double time_s, const LiveCloud::Half& incoming) = 0;
  /// The points so far, and their velocities.
  struct Front {
    const LiveCloud::Half& points;
    const Buffer& velocities;
  };
  /// Records how it becomes the points `incoming`, in any order, and their velocities (shaders/shared/motion.h).
  virtual void record(CommandList& list, const Front& front, const LiveCloud::Half& incoming,
                      const Buffer& velocities) const = 0;
  /// Whether there are turns beside the velocities.
  virtual bool turnsNormals() const { return false; }
  /// Of what was made last: CloudFrame's times, and whether the normals' fourth words have colours.
  virtual double time_s() const = 0;
  virtual double goOn_s() const { return kMaxPointsAge_s; }
  virtual double comes_s() const { return 0; }
  virtual bool isColored() const = 0;
  /// Whether make() looks at the points so far: it runs then only once the frame before has become them.
  virtual bool looksAtPoints() const { return false; }
};

}  // namespace palpate
