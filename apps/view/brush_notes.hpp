// Remarks to the user about the present brush.
#pragma once

#include <cstdint>
#include <string>

#include "apps/view/settings.hpp"

namespace palpate {

class Messages;

class BrushNotes {
 public:
  /// `gain`: of the hand, at the start.
  explicit BrushNotes(double gain) : gain_(gain) {}
  /// Called when another model is opened.
  void forget() { *this = BrushNotes(gain_); }
  /// Reports a brush that is too small to edit points: once, and again at each press.
  void noteSize(const WindowSession& session, const ViewSettings& view, std::uint64_t presses, Messages& messages);
  /// Shows the points' own colours when a paint stroke begins, so that the paint is visible, and reports it.
  void notePaint(const WindowSession& session, ViewSettings& view, Messages& messages);
  /// Called once per frame, at that time.
  void noteBlocked(const WindowSession& session, double now_s);
  /// Reports, once for each model, that brushes do nothing at the back of an open surface.
  void noteBack(const WindowSession& session, Messages& messages);
  /// Reports a change of the gain of the hand, which is only for devices.
  void noteGain(double gain, bool hasDevice, Messages& messages);
  /// Why nothing under the pressed brush moves; empty: it moves, or the hand does not press.
  const std::string& blocked() const { return blocked_; }

 private:
  std::string tooSmall_, blocked_;
  std::uint64_t blockedEdits_ = 0;
  double blockedUntil_s_ = 0;
  std::uint64_t presses_ = 0;
  double gain_;
  bool inStroke_ = false, knowsBack_ = false;
};

}  // namespace palpate
