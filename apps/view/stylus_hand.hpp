// The stylus in a hand that holds a mouse, a gamepad or a 3D mouse: how deep it is, by what is seen under the cursor.
#pragma once

#include <optional>

#include "engine/core/vec.hpp"

namespace palpate {

/// What the last picture has under the cursor.
struct Pick {
  DVec2 place_px{0};
  double depth = 0;  ///< model units; 0: nothing is there
};

class StylusHand {
 public:
  bool isHeld() const { return held_; }
  /// Held before the surface, without pressing; or let go.
  void hold(bool on);
  /// Whether it stays held without a key.
  bool isLocked() const { return locked_; }
  void lock(bool on) { locked_ = on; }
  /// Whether a gamepad or a 3D mouse has it, until the mouse moves.
  bool isByPad() const { return byPad_; }
  void giveToPad(bool on) { byPad_ = on; }

  bool isPressing() const { return pressing_; }
  void press();
  void release() { pressing_ = false; }
  /// Deeper while it presses, else nearer or farther.
  void turnWheel(double notches);
  void lower(double way_mm) { hover_mm_ -= way_mm; }
  /// The same with a cap that is held as long as it takes: not farther than a person means.
  void lift(double way_mm);
  /// -1 to 1, by the triggers of a gamepad.
  void pressByTrigger(double share) { trigger_ = share; }

  /// How far from the eye the stylus goes under the cursor; `beside` where no surface was seen there. Nothing while
  /// nobody has looked: it must not begin inside the model, which it would never feel from there.
  std::optional<double> depthAt(const DVec2& cursor_px, const Pick& picked, bool followsSurface, double beside);
  /// How much farther than that the hand means to go, mm. Put down before the surface, also by a hand that presses
  /// already: from behind it nothing would be felt.
  double takeInward_mm(double press_mm);

 private:
  bool held_ = false, locked_ = false, byPad_ = false, pressing_ = false;
  double hover_mm_ = 0, extraPress_mm_ = 0, trigger_ = 0;
  double planeDepth_ = 0;   // of the surface that the stylus goes by, and
  DVec2 planePlace_px_{0};  // where it was seen
  bool putDown_ = false;    // since it is held
};

}  // namespace palpate
