// Sculpting of a soft body: its rest shape yields to a brush, stroke by stroke.
#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "engine/core/shape_strokes.hpp"
#include "engine/matter/soft_press.hpp"

namespace palpate {

/// Requested displacement of a surface position, m.
struct PlaceWay {
  std::uint32_t place = 0;
  DVec3 way{0};
};

/// Turns a brush's displacements of surface positions into a smooth motion of the nodes within kReach_spacings, as a
/// mean with Wendland's weights that fades with depth. The motion is plastic: the rest positions move along, through
/// the inverse of the body's strain (SoftBody::yield()). Masses stay; nothing outside that reach changes. Displacements
/// that a cell cannot follow are omitted. For one thread.
class SoftSculpture {
 public:
  static constexpr double kReach_spacings = 2;

  /// Both must outlive it.
  SoftSculpture(SoftBody& body, const SoftSurface& surface) : body_(body), surface_(surface) {}

  const SoftBody& body() const { return body_; }
  const SoftSurface& surface() const { return surface_; }
  /// Continues the stroke, or begins one. Returns the number of moved nodes. `ways`: each position at most once.
  std::size_t yield(std::span<const PlaceWay> ways);
  /// Ends the stroke, if one is in progress.
  void endStroke();

  /// ShapeStrokes::take().
  void take(std::vector<ShapeStroke>& strokes);
  /// ShapeStrokes::exchange(), between strokes.
  void exchange(ShapeStroke& stroke);

 private:
  struct Near {
    Vec3 place;
    DVec3 way;
  };
  std::vector<Near> placesNear(const DVec3& low, const DVec3& high, std::span<const PlaceWay> ways) const;

  SoftBody& body_;
  const SoftSurface& surface_;
  std::vector<Vec3> began_;         // rest displacements before the current stroke; empty between strokes
  std::mutex lock_;                 // protects ended_
  std::vector<ShapeStroke> ended_;  // and not taken
};

}  // namespace palpate
