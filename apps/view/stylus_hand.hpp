// The stylus in a hand that holds a mouse, a gamepad or a 3D mouse: how deep it is, by what is seen under the cursor.
#pragma once

#include <array>
#include <optional>

#include "engine/render/camera.hpp"

namespace palpate {

/// What the last picture has under the cursor; while a stroke goes on, what it has found there.
struct Pick {
  DVec2 place_px{0};
  double depth = 0;  ///< model units; 0: nothing is there
  double beside_px = 0;
  std::array<double, 4> beside{};  ///< the same so many pixels to the left, right, over and under it
};

/// The normal of the surface that is seen there, towards the eye; straight to the eye where little is seen.
DVec3 normalAt(const Pick& pick, const Camera& camera, const DVec2& size_px);

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
  /// Whether it means to go into the surface, by whatever it is held with: from then on until it no longer does is one
  /// stroke.
  bool sculpts() const { return pressing_ || trigger_ > 0 || hover_mm_ < 0; }
  /// Whether it presses where no surface is seen.
  bool isBeside() const { return isBeside_; }
  /// Deeper while it presses, else nearer or farther.
  void turnWheel(double notches);
  void lower(double way_mm) { hover_mm_ -= way_mm; }
  /// The same with a cap that is held as long as it takes: not farther than a person means.
  void lift(double way_mm);
  /// -1 to 1, by the triggers of a gamepad.
  void pressByTrigger(double share) { trigger_ = share; }

  /// The surface that it presses on goes on behind the one that it was on: it must be put down there anew.
  void putDownAgain() { putDown_ = false; }
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
  bool isBeside_ = false;
};

}  // namespace palpate
