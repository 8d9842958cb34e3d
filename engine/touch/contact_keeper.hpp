// A contact with a soft body stays with the place of the body that it presses on.
#pragma once

#include <cstdint>

#include "engine/core/contact_query.hpp"

namespace palpate {

/// Where the place of the body is that a touch presses on, as the simulation has carried it. Model units.
struct PressedPlace {
  std::uint32_t contact = 0;  ///< ContactKeeper::contact() of the touch that presses there; 0: nothing presses
  DVec3 place{0}, velocity{0};
  bool isAlone = false;  ///< no place of the surface is within a support radius
  double time_s = 0;     ///< for which it is true
};

/// For one hand, or one point of its tool. The surface of points answers as long as it goes on from tick to tick. In a
/// dent that is deeper than it is wide the points beside the hand mislead it: they stand on the walls of the dent, or
/// are too few. There it jumps or is lost, and the contact is kept at the place of the body that is pressed, which the
/// cells carry, with the last normal and the surface's friction. While it is kept the surface goes no faster under the
/// hand than the slack allows, whatever the body does, and what has no surface near it any more gives way as fast.
class ContactKeeper {
 public:
  struct Tick {
    DVec3 hip{0};
    double time_s = 0;
    double friction = 0;
    double slack = 0;   ///< by which the surface may come or go under the hand in a millisecond, model units
    double radius = 0;  ///< support radius, model units
  };
  /// The contact of this tick. `felt`: what the surface of points says, which is valid.
  Contact follow(const Contact& felt, const PressedPlace& pressed, const Tick& tick);
  /// Nothing is touched.
  void forget();

  /// Number of the contact, never that of the one before; 0 while nothing is touched.
  std::uint32_t contact() const { return touching_ ? contact_ : 0; }
  /// Where the body is pressed: at the proxy, or, where that comes after the body more slowly than this moves, at the
  /// place that the body carries.
  const DVec3& place() const { return place_; }
  /// It is kept at the place that the body carries.
  bool isKept() const { return isKept_; }
  /// And the place is the same as before, so that the same nodes bear the hand.
  bool isSamePlace() const { return isKept_ && !isElsewhere_; }
  /// In this tick the body went from under the hand faster than it felt, or there was no surface any more.
  bool gaveWay() const { return gaveWay_; }

 private:
  // Since the tick before, and the slack for it.
  struct Step {
    double since_s, allowed;
  };
  void begin(const Contact& felt, const Tick& tick, double allowed);
  bool goesOn(const Contact& felt, const DVec3& expected, double allowed) const;
  PressedPlace placeNow(PressedPlace place, const Tick& tick, double since_s) const;
  Contact goOn(const Contact& felt, const PressedPlace& pressed, const Tick& tick, const Step& step);
  struct Depths {
    double pressed, felt;
  };
  Depths depthsBelow(const Contact& felt, const PressedPlace& pressed, const Tick& tick, double allowed);
  Contact kept(const Contact& felt, const PressedPlace& pressed, const Tick& tick, const Step& step);

  bool touching_ = false, isKept_ = false, isElsewhere_ = false, gaveWay_ = false;
  bool sticks_ = false;
  std::uint32_t contact_ = 0;
  double way_ = 0;   // of the hand, since the tick before
  double slid_ = 0;  // since the nodes that bear the hand were found, model units
  Contact last_;     // while touching
  DVec3 lastHip_{0}, place_{0};
  double lastTime_s_ = 0;
};

}  // namespace palpate
