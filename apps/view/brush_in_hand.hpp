// The brush as the user holds it: with Shift it smooths, with Ctrl it is inverted, and a drag changes its size or
// strength.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/view/pointing_devices.hpp"
#include "apps/view/settings.hpp"

namespace palpate {

/// What is shown of it at the cursor, in the panels' layer, so that the model is not drawn again.
struct BrushHint {
  std::optional<BrushKind> kind;  ///< that works now; empty: the chosen one
  std::vector<DVec2> ring_px;     ///< the brush's size on the surface under the cursor; empty: none
  DVec2 place_px{0};              ///< of the words
  std::string words;              ///< of keys that are held, or of a drag; empty: none
};

class BrushInHand {
 public:
  /// Keys of the brush; `shift` wins.
  struct Keys {
    bool shift = false, control = false;
    bool operator==(const Keys&) const = default;
  };
  /// Between strokes: the keys that are held. A stroke keeps those with which it began.
  void follow(const Keys& keys) { keys_ = keys; }
  /// The chosen brush, or what these keys make of it.
  BrushSettings brushFrom(const BrushSettings& chosen) const;
  /// That in words; empty: as chosen.
  std::string wordsFor(const BrushSettings& chosen) const;

  // A drag; all positions are of the cursor, pixels.
  enum class Drag { size, strength };
  /// Begins where the surface is under the cursor; the ring stays there.
  void begin(Drag what, const DVec2& place_px, const BrushSettings& brush, const Pointed& at);
  bool isDragging() const { return drag_.has_value(); }
  /// To the right: larger, stronger.
  void moveTo(const DVec2& place_px, BrushSettings& brush) const;
  /// The brush stays as it is dragged, or gets back what it had.
  void accept() { drag_.reset(); }
  void giveUp(BrushSettings& brush);

  /// `words`: of a drag; `isOnModel`: the cursor is not over a panel, and no stroke is in progress.
  BrushHint hint(const BrushSettings& chosen, const ViewSettings& view, const DVec2& cursor_px, bool isOnModel,
                 const Pointed& at) const;

 private:
  struct Spot {
    DVec3 place{0}, normal{0};
  };
  struct Dragged {
    Drag what;
    DVec2 from_px{0};
    double had = 0;
    std::optional<Spot> spot;
  };
  static double& valueOf(Drag what, BrushSettings& brush);
  static std::optional<Spot> spotUnder(const Pointed& at);

  Keys keys_;
  std::optional<Dragged> drag_;
};

}  // namespace palpate
