#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

namespace palpate {

/// What a tool does to the points that it reaches.
enum class BrushKind {
  push,     ///< to the surface of a round tool (thesis section 5.2)
  carve,    ///< takes points inside the tool away and closes the surface behind them
  inflate,  ///< along their normals, outwards
  smooth,   ///< towards the surface that their neighbours define
  grab,     ///< along with the hand
  paint     ///< gives them a colour
};
constexpr std::array<std::pair<std::string_view, BrushKind>, 6> kBrushKinds = {{{"push", BrushKind::push},
                                                                                {"carve", BrushKind::carve},
                                                                                {"inflate", BrushKind::inflate},
                                                                                {"smooth", BrushKind::smooth},
                                                                                {"grab", BrushKind::grab},
                                                                                {"paint", BrushKind::paint}}};

/// A brush and its settings.
struct BrushOptions {
  BrushKind kind = BrushKind::push;
  double tau = 0;         ///< how deep the HIP may stand behind the proxy before the surface yields, model units
  double beta = 0;        ///< push: share of the way to its target that a point goes in one tick, 0 to 1
  double toolRadius = 0;  ///< of the round tool, model units
  /// The others: how much of its effect a brush has in one tick at the middle of the tool, 0 to 1. For inflate the
  /// whole effect is a thousandth of the tool's radius.
  double strength = 0.5;
  /// How the effect falls off towards the rim: (1 - r^2)^falloff, r the distance in tool radii; 0 is a hard rim.
  double falloff = 1;
  std::array<std::uint8_t, 4> color{255, 0, 0, 255};  ///< paint: RGBA, 0 to 255
};

}  // namespace palpate
