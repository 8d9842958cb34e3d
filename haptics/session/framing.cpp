#include "haptics/session/framing.hpp"

#include <algorithm>

namespace palpate {

namespace {

// Where there is but one place a picture shows this much around it, and a disc of this radius, model units.
constexpr double kAroundLone = 1, kLone = 0.3;

}  // namespace

Framing framingOf(const Model& model, UpAxis up) {
  Framing framing{.shown = model.shown, .up = up};
  if (!(model.spacing > 0)) framing.margin = kAroundLone;
  // Where points are many, their discs are as small as the picture's own margin is wide.
  constexpr double kFew = 0.02, kWidest = 0.1;  // of the longest side: a spacing, and the radius of a disc
  const double side = model.shownBounds().longestSide();
  if (model.spacing > kFew * side) framing.margin = std::min(model.spacing, kWidest * side);
  return framing;
}

double discRadiusOf(const Model& model) {
  if (model.discRadius > 0) return model.discRadius;
  return model.spacing > 0 || model.cloud.empty() ? 0 : kLone;
}

}  // namespace palpate
