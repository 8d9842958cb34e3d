#include "apps/cli/look.hpp"

#include <algorithm>

#include "engine/core/named_values.hpp"

namespace palpate {

namespace {

// Where there is but one place a picture shows this much around it, and a disc of this radius, model units.
constexpr double kAroundLone = 1, kLone = 0.3;

}  // namespace

void addLookOptions(Options& command, LookOptions& options) {
  command
      .add("--up", options.up,
           "which way is up, in pictures and for heights: x, y, z, -x, -y, -z, or auto (by the shape: ground, and "
           "what stands on a base)")
      .check(oneOf(namesOf(kUpAxes, {"auto"})))
      .showDefault();
  command
      .add("--unit", options.unit,
           "the file's unit of length, for scale bars, heights and reports: mm, cm, m, in, ft, or auto (what a "
           "comment of the file says); scales nothing, as --mm-per-unit does")
      .check(oneOf(namesOf(kLengthUnits, {"auto"})))
      .showDefault();
}

std::optional<UpAxis> upNamed(std::string_view name) { return valueNamed(kUpAxes, name); }

std::optional<LengthUnit> unitNamed(std::string_view name) { return valueNamed(kLengthUnits, name); }

Upright uprightOf(const Model& model, const LookOptions& options) {
  if (const auto up = upNamed(options.up)) return {*up, "as --up says"};
  return model.upright;
}

LengthUnit unitOf(const PointCloud& cloud, const LookOptions& options) {
  return unitNamed(options.unit).value_or(unitSaidIn(cloud.storedAs.comments));
}

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

HeightRange heightsOf(const Model& model, UpAxis up) {
  const DVec3 top = directionOf(up);
  const Bounds shown = model.shownBounds();
  const double a = glm::dot(shown.min + model.cloud.origin, top);
  const double b = glm::dot(shown.max + model.cloud.origin, top);
  return {std::min(a, b), std::max(a, b)};
}

}  // namespace palpate
