// Sculpting of a soft body: its rest shape yields to a brush, stroke by stroke.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "engine/matter/soft_surface.hpp"

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

  /// Only between strokes: undoes or redoes the last one, bitwise exactly. False if there is none.
  bool undo();
  bool redo();
  std::size_t undoCount() const { return strokes_.size() - undone_; }
  std::size_t redoCount() const { return undone_; }
  std::uint64_t strokes() const { return made_; }     ///< total number
  std::uint64_t dropped() const { return dropped_; }  ///< number of oldest strokes no longer kept

 private:
  struct Stroke {
    std::vector<RestPlace> before, after;  // rest displacements of the moved nodes
  };
  struct Near {
    Vec3 place;
    DVec3 way;
  };
  std::vector<Near> placesNear(const DVec3& low, const DVec3& high, std::span<const PlaceWay> ways) const;
  void forget();

  SoftBody& body_;
  const SoftSurface& surface_;
  std::vector<Vec3> began_;  // rest displacements before the current stroke; empty between strokes
  std::deque<Stroke> strokes_;
  std::size_t undone_ = 0;  // number of last strokes undone
  std::size_t kept_ = 0;    // total number of nodes of all strokes
  std::uint64_t made_ = 0, dropped_ = 0;
};

}  // namespace palpate
