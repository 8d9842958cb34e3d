// Interface between the owner of moving points and touch, which feels them.
#pragma once

#include <cstddef>
#include <optional>

#include "engine/core/cloud_frame.hpp"

namespace palpate {

struct PointCloud;
class FrameCarrier;

/// Model unit of points that a GPU carries (CloudSource::carrier()), m.
inline constexpr double kCarriedUnit_m = 1e-3;

/// Points that move, frame by frame, made on the host or on a GPU. For one thread at a time; the thread may change.
class CloudSource {
 public:
  virtual ~CloudSource() = default;

  /// Number of ids (from 0): touch allocates memory for them before the first frame.
  virtual std::size_t size() const = 0;
  /// Whether a point has the same id in each frame. Otherwise the motion of points between frames is unknown.
  virtual bool keepsPoints() const { return true; }
  /// Whether frames may contain rotations of their normals.
  virtual bool turnsNormals() const { return false; }
  /// Makes `frame`, whose memory is reused, the newest one known at `time_s`, and sets the time that it is true for.
  /// The same time gives the same bytes, independent of earlier calls. Throws Error on failure.
  virtual void makeFrame(double time_s, CloudFrame& frame) = 0;
  /// Whether the frame for `time_s` differs from the last one made, which is true for `than_s`.
  virtual bool hasNewer(double /*time_s*/, double /*than_s*/) { return true; }
  /// If the points are moved on a GPU: transfers them from there; null: they are moved on the host.
  virtual FrameCarrier* carrier() { return nullptr; }
  /// makeFrame() for users of the carrier: moves the points, and returns the time that they are true for; nothing if
  /// they are outdated.
  virtual std::optional<double> goTo(double time_s) { return time_s; }
};

/// Validates every frame. Throws Error for values that are not finite, for more than `points` points, for arrays whose
/// size differs from the number of points, and for ids that do not ascend or are not below `points`.
void requireWhole(const CloudFrame& frame, std::size_t points);

/// Moves the points of a cloud to their positions in the frame; returns the number of points that moved or were
/// replaced. If the frame has other points than the cloud, it replaces them, and attributes that only the cloud has are
/// lost.
std::size_t placeAt(const CloudFrame& frame, PointCloud& cloud);

}  // namespace palpate
