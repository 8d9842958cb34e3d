// A soft body that is sculpted: its rest shape yields to a brush, stroke by stroke.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "engine/matter/soft_surface.hpp"

namespace palpate {

/// How far a place of the surface is to go, m.
struct PlaceWay {
  std::uint32_t place = 0;
  DVec3 way{0};
};

/// What a brush asks of places of the surface becomes a smooth motion of the nodes about them, within kReach_spacings
/// of the cells, as a mean with Wendland's weights that fades into the depth; and that a plastic one: where nodes
/// rest goes along, through the inverse of what the body is strained by (SoftBody::yield()). Mass stays, nothing else
/// does within that reach, and everything without. What a cell cannot follow it does not. For one thread.
class SoftSculpture {
 public:
  static constexpr double kReach_spacings = 2;

  /// Both outlive it.
  SoftSculpture(SoftBody& body, const SoftSurface& surface) : body_(body), surface_(surface) {}

  const SoftBody& body() const { return body_; }
  const SoftSurface& surface() const { return surface_; }
  /// Of the stroke that goes on, or of a new one. How many nodes have moved. `ways`: each place once.
  std::size_t yield(std::span<const PlaceWay> ways);
  /// The stroke is over, if one goes on.
  void endStroke();

  /// While no stroke goes on: takes the last one back, or does it again, to the bit. False where there is none.
  bool undo();
  bool redo();
  std::size_t undoable() const { return strokes_.size() - undone_; }
  std::size_t redoable() const { return undone_; }
  std::uint64_t strokes() const { return made_; }     ///< in all
  std::uint64_t dropped() const { return dropped_; }  ///< of them, the oldest, which are kept no more

 private:
  struct Stroke {
    std::vector<RestPlace> before, after;  // of the nodes that it has moved
  };
  struct Near {
    Vec3 place;
    DVec3 way;
  };
  std::vector<Near> placesNear(const DVec3& low, const DVec3& high, std::span<const PlaceWay> ways) const;
  void forget();

  SoftBody& body_;
  const SoftSurface& surface_;
  std::vector<Vec3> began_;  // where nodes rested before the stroke that goes on; empty where none does
  std::deque<Stroke> strokes_;
  std::size_t undone_ = 0;  // of the last ones
  std::size_t kept_ = 0;    // nodes of all of them
  std::uint64_t made_ = 0, dropped_ = 0;
};

}  // namespace palpate
