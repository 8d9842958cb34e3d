// A stroke of a pointer: its events become the poses of a stylus.
#pragma once

#include <deque>
#include <optional>

#include "haptics/devices/drawn_strokes.hpp"
#include "haptics/session/found_surface.hpp"

namespace palpate {

struct StrokeOptions {
  double tick_s = 1e-3;  ///< time from pose to pose
  DVec3 origin{0};       ///< of the found surface's coordinates
  double unitsPer_mm = 1;
  double inward = 0;  ///< depth of the stylus below the found surface, model units
  /// Of grab: what the stylus touches first is moved parallel to the picture (DrawnPose::holdsFrom).
  std::optional<double> holdsFrom;
  bool inPlane = false;  ///< the stylus moves parallel to the picture in any case
  /// The stroke is steadied: the pointer pulls the stylus by a string of this length, pixels. The stroke ends where the
  /// stylus is then.
  double string_px = 0;
};

/// From the press of the button to its release and the end of the path that was drawn until then. The path goes along
/// the surface as it was found at the press. Where the path leaves the model or the surface recedes in a step, the
/// stylus is lifted, and put down where the surface continues. Only the times and positions of the events determine the
/// poses, not when they are given or taken.
class PointerStroke {
 public:
  /// The button is pressed at a position of the picture.
  PointerStroke(FoundSurface found, const StrokeOptions& options, const DVec2& place_px, double time_s);

  void moveTo(const DVec2& pointer_px, double time_s);
  /// Presses deeper by `way`, model units, from now on.
  void deepen(double way, double time_s);
  void release(double time_s);
  bool isReleased() const { return release_s_.has_value(); }

  /// Whether next() needs no events but those so far, if all before `known_s` are known.
  bool isKnown(double known_s) const { return release_s_ || now_s() < known_s; }
  /// The pose of the next tick; nothing while the path has not reached the model.
  std::optional<DrawnPose> next();
  /// No pose follows.
  bool isOver() const { return over_; }

 private:
  struct Place {
    DVec2 place_px{0};
    double inward = 0, time_s = 0;
  };
  double now_s() const { return begin_s_ + static_cast<double>(tick_) * options_.tick_s; }
  double step() const;
  std::optional<FoundSpot> spotAt(const DVec2& place_px) const;
  bool advance();
  void putDown(const FoundSpot& spot);
  DrawnPose pose() const;

  FoundSurface found_;
  StrokeOptions options_;
  double begin_s_, event_s_;
  std::uint64_t tick_ = 0;
  std::optional<double> release_s_;
  std::deque<Place> path_;  // not reached yet
  Place last_;              // of the path so far
  double inward_;
  std::optional<FoundSpot> spot_;  // position of the stylus; with holds or inPlane, first_ gives the plane
  std::optional<FoundSpot> first_;
  bool isLifted_ = true;
  std::uint64_t rest_ = 0;  // ticks until the stylus that was put down follows the path
  bool over_ = false;
};

}  // namespace palpate
