// The stylus held by mouse, gamepad or 3D mouse: its depth follows from the surface visible under the cursor, except
// during a stroke of the mouse (PointerStroke).
#pragma once

#include <optional>

#include "haptics/session/found_surface.hpp"

namespace palpate {

class StylusHand {
 public:
  bool isHeld() const { return held_; }
  /// Holds the stylus in front of the surface, without pressing; or releases it.
  void hold(bool on);
  /// Whether the stylus stays held without a key.
  bool isLocked() const { return locked_; }
  void lock(bool on) { locked_ = on; }
  /// Whether a gamepad or a 3D mouse moves the stylus, until the mouse moves.
  bool isByPad() const { return byPad_; }
  void giveToPad(bool on) { byPad_ = on; }

  /// Whether the stylus aims into the surface, by pad; one stroke lasts as long as this is true.
  bool sculpts() const { return trigger_ > 0 || hover_mm_ < 0; }
  void lower(double way_mm) { hover_mm_ -= way_mm; }
  /// Raises the stylus by the cap of a 3D mouse; limited, as a cap is held for a long time.
  void lift(double way_mm);
  /// Press by the triggers of a gamepad, -1 to 1.
  void pressByTrigger(double share) { trigger_ = share; }

  /// Puts the stylus down again, in front of the surface.
  void putDownAgain() { putDown_ = false; }
  /// Depth of the stylus from the eye under the cursor; `beside` where no surface is visible there. Nothing until a
  /// depth was picked there: a stylus that begins inside the model would never feel its surface.
  std::optional<double> depthAt(const DVec2& cursor_px, const Pick& picked, bool followsSurface, double beside);
  /// Displacement beyond that depth, mm. The first call after hold() or putDownAgain() returns a position in front of
  /// the surface, even while a trigger is pulled: from behind it nothing would be felt.
  double takeInward_mm(double press_mm);

 private:
  bool held_ = false, locked_ = false, byPad_ = false;
  double hover_mm_ = 0, trigger_ = 0;
  double planeDepth_ = 0;   // depth of the surface that the stylus follows; 0: none yet
  DVec2 planePlace_px_{0};  // its position in the picture
  bool putDown_ = false;    // put down since hold() or putDownAgain()
};

}  // namespace palpate
