// A contact with a soft body follows the position on the body that it presses on.
#pragma once

#include <cstdint>

#include "engine/core/contact_query.hpp"

namespace palpate {

/// Position on the body that a touch presses on, as carried by the simulation. Model units.
struct PressedPlace {
  std::uint32_t contact = 0;  ///< ContactKeeper::contact() of the touch that presses there; 0: none
  DVec3 place{0}, velocity{0};
  bool isAlone = false;  ///< no surface position is within a support radius
  double time_s = 0;     ///< time at which it is valid
};

/// For one hand, or one point of its tool. The surface of points answers as long as it is continuous from tick to tick.
/// In a dent that is deeper than it is wide the points beside the hand mislead it: they are on the walls of the dent,
/// or too few. If the surface jumps or is lost, the contact is kept at the pressed position on the body, which the
/// cells carry, with the last normal and the surface's friction. While it is kept, the surface moves under the hand no
/// faster than the slack allows, whatever the body does; if no surface is near that position any more, it gives way at
/// that speed.
class ContactKeeper {
 public:
  struct Tick {
    DVec3 hip{0};
    double time_s = 0;
    double friction = 0;
    double slack = 0;   ///< maximum surface displacement under the hand in a millisecond, model units
    double radius = 0;  ///< support radius, model units
  };
  /// Returns the contact of this tick. `felt`: the valid answer of the surface of points.
  Contact follow(const Contact& felt, const PressedPlace& pressed, const Tick& tick);
  /// Ends the contact.
  void forget();

  /// Number of the contact, different from the previous one; 0 while nothing is touched.
  std::uint32_t contact() const { return touching_ ? contact_ : 0; }
  /// Position where the body is pressed: the proxy, or, if the proxy lags behind the body (slack), the position that
  /// the body carries.
  const DVec3& place() const { return place_; }
  /// Whether the contact is kept at the position that the body carries.
  bool isKept() const { return isKept_; }
  /// Whether it is also the same position as before, so that the same nodes bear the hand.
  bool isSamePlace() const { return isKept_ && !isElsewhere_; }
  /// Whether in this tick the body receded from the hand faster than it felt, or no surface was left.
  bool gaveWay() const { return gaveWay_; }

 private:
  // Time since the previous tick, and the slack for it.
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
  double way_ = 0;   // displacement of the hand since the previous tick
  double slid_ = 0;  // path of the proxy since the nodes that bear the hand were found, model units
  Contact last_;     // valid while touching
  DVec3 lastHip_{0}, place_{0};
  double lastTime_s_ = 0;
};

}  // namespace palpate
