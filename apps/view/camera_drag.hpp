// How the mouse turns and moves the camera while a button is down.
#pragma once

#include "engine/render/camera.hpp"

namespace palpate {

class CameraDrag {
 public:
  /// Turns about `pivot`, or moves along with it.
  void begin(const Camera& camera, const DVec3& pivot, bool pans);
  /// The mouse is busy with something else, which counts as a drag.
  void beginOther() { kind_ = Kind::other; }
  void end() { kind_ = Kind::none; }
  bool isUnderWay() const { return kind_ != Kind::none; }
  Camera moved(const Camera& camera, const DVec2& way_px, const DVec2& size_px) const;

  /// Whether a button that goes down there and then does so for the second time.
  bool isDoubleClick(double time_s, const DVec2& place_px) const;
  void noteClick(double time_s, const DVec2& place_px);

 private:
  enum class Kind { none, orbit, pan, other };
  Kind kind_ = Kind::none;
  DVec3 pivot_{0};
  double depth_ = 0;
  double clicked_s_ = -1e9;
  DVec2 clicked_px_{-1e9};
};

}  // namespace palpate
