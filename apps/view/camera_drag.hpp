// Rotates and moves the camera by the mouse while a button is down.
#pragma once

#include "engine/render/camera.hpp"

namespace palpate {

class CameraDrag {
 public:
  /// Begins to rotate about `pivot`, or to pan so that `pivot` stays under the cursor.
  void begin(const Camera& camera, const DVec3& pivot, bool pans);
  /// Begins to turn the camera where it is.
  void beginTurn() { kind_ = Kind::turn; }
  /// Begins a drag that does not move the camera, e.g. a press of the stylus.
  void beginOther() { kind_ = Kind::other; }
  void end() { kind_ = Kind::none; }
  Camera moved(const Camera& camera, const DVec2& way_px, const DVec2& size_px) const;

  /// Whether a press at that time and position is the second one of a double click.
  bool isDoubleClick(double time_s, const DVec2& place_px) const;
  void noteClick(double time_s, const DVec2& place_px);

 private:
  enum class Kind { none, orbit, pan, turn, other };
  Kind kind_ = Kind::none;
  DVec3 pivot_{0};
  double depth_ = 0;
  double clicked_s_ = -1e9;
  DVec2 clicked_px_{-1e9};
};

}  // namespace palpate
