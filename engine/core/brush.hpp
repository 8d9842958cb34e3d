#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

namespace palpate {

/// What a brush does to the points that it reaches.
enum class BrushKind {
  push,     ///< down to the underside of a ball (thesis section 5.2)
  carve,    ///< takes points inside the brush away and closes the surface behind them
  inflate,  ///< along their normals, outwards
  smooth,   ///< towards the surface that their neighbours define
  grab,     ///< along with the hand
  paint,    ///< gives them a colour
  flatten   ///< onto the plane of the surface as the stroke found it
};
constexpr std::array<std::pair<std::string_view, BrushKind>, 7> kBrushKinds = {{{"push", BrushKind::push},
                                                                                {"carve", BrushKind::carve},
                                                                                {"inflate", BrushKind::inflate},
                                                                                {"smooth", BrushKind::smooth},
                                                                                {"grab", BrushKind::grab},
                                                                                {"paint", BrushKind::paint},
                                                                                {"flatten", BrushKind::flatten}}};

/// Whether a brush moves what is there, and does no more: it can change the shape in which a soft body rests, whose
/// cells stay the same ones, so that none can be carved away, and whose colours are not its own.
constexpr bool changesShape(BrushKind kind) { return kind != BrushKind::carve && kind != BrushKind::paint; }

/// A brush and its settings. Every brush acts only while the HIP stands deeper than `tau` behind the proxy and does not
/// withdraw. Its tool is fixed to the hand, and stands upright on the surface as the stroke found it (BrushStroke).
/// Push and carve work with a ball on a shaft as wide, whose tip stands tau before the HIP; the others about the place
/// where the surface was found over the hand. Points of a side of the model that faces away stay as they are, but for
/// carve.
struct BrushOptions {
  BrushKind kind = BrushKind::push;
  double tau = 0;     ///< how deep the HIP may stand behind the proxy before the surface yields, model units
  double beta = 0;    ///< push: share of the way to its target that a point goes in one tick, 0 to 1
  double radius = 0;  ///< of its ball, model units
  /// The others: how much of its effect a brush has in one tick, 0 to 1; but for carve, at the middle of the brush. The
  /// whole effect is for carve the way to the brush, for smooth and flatten that to the surface and to the plane, for
  /// grab the way of the hand since it took hold, up to two radii, for inflate a thousandth of the brush's radius until
  /// the surface is raised by as much as the hand presses, for paint the colour.
  double strength = 0.5;
  /// All but push and carve: how the effect falls off towards the rim, (1 - r^2)^falloff, r the distance in
  /// brush radii; a whole number, so that every processor computes the same; 0 is a hard rim, kMaxFalloff the most.
  std::uint32_t falloff = 1;
  std::array<std::uint8_t, 4> color{255, 0, 0, 255};  ///< paint: RGBA, 0 to 255
  bool keepsDensity = true;  ///< points are put in where the surface is stretched, and merge where it is crowded

  bool operator==(const BrushOptions&) const = default;
};
constexpr std::uint32_t kMaxFalloff = 16;

}  // namespace palpate
