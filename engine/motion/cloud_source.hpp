// What moves points: the seam between whoever knows where they are at a time, and touch, which feels them there.
#pragma once

#include <cstddef>
#include <optional>

#include "engine/core/cloud_frame.hpp"

namespace palpate {

struct PointCloud;
class FrameCarrier;

/// Points that move, frame by frame, made on the host or on a GPU. For one thread at a time, which need not be the same
/// each time.
class CloudSource {
 public:
  virtual ~CloudSource() = default;

  /// Ids that points may have, from 0: touch makes its memory for so many before the first frame.
  virtual std::size_t size() const = 0;
  /// Whether a point of one frame is the same as that of its id in the next one. Otherwise nothing is known of what
  /// moved where between the two.
  virtual bool keepsPoints() const { return true; }
  /// Whether frames may say how their normals turn.
  virtual bool turnsNormals() const { return false; }
  /// Makes `frame`, whose memory is used again, the newest one that is known at `time_s`, and says in it which time it
  /// is true for. The same time gives the same bytes, whatever was asked for before. Throws Error where it cannot.
  virtual void makeFrame(double time_s, CloudFrame& frame) = 0;
  /// Whether the frame for `time_s` is another one than that which was made last and is true for `than_s`.
  virtual bool hasNewer(double /*time_s*/, double /*than_s*/) { return true; }
  /// Where the points are moved on a GPU: who brings them from there; null: they are moved on the host.
  virtual FrameCarrier* carrier() { return nullptr; }
  /// makeFrame() for who takes them from the carrier: moves them on, and returns the time that they are true for;
  /// nothing where they are of no use any more.
  virtual std::optional<double> goTo(double time_s) { return time_s; }
};

/// The door through which frames come in. Throws Error for what is no number, for more points than `points`, for values
/// that not all points have, and for ids that do not ascend below `points`.
void requireWhole(const CloudFrame& frame, std::size_t points);

/// Puts the points of a cloud where the frame has them; how many have moved, or are there in place of others. Where the
/// frame has other points than the cloud, those are all that is left of it, and what only the cloud's own had is gone.
std::size_t placeAt(const CloudFrame& frame, PointCloud& cloud);

}  // namespace palpate
