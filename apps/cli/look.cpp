#include "apps/cli/look.hpp"

#include <algorithm>

#include "engine/core/named_values.hpp"

namespace palpate {

void addLookOptions(Options& command, LookOptions& options) {
  command
      .add("--up", options.up,
           "up axis for pictures and heights: x, y, z, -x, -y, -z, or auto (from the shape: ground, base "
           "of a statue)")
      .check(oneOf(namesOf(kUpAxes, {"auto"})))
      .showDefault();
  command
      .add("--unit", options.unit,
           "unit of the lengths in the file, for display only: mm, cm, m, in, ft, or auto (as the file "
           "says, else \"units\")")
      .check(oneOf(namesOf(kLengthUnits, {"auto"})))
      .showDefault();
}

std::optional<UpAxis> upNamed(std::string_view name) { return valueNamed(kUpAxes, name); }

std::optional<LengthUnit> unitNamed(std::string_view name) { return valueNamed(kLengthUnits, name); }

Upright uprightOf(const Model& model, const LookOptions& options) {
  if (const auto up = upNamed(options.up)) return {*up, "as --up says", Sureness::known, model.upright.frontFor(*up)};
  return model.upright;
}

LengthUnit unitOf(const PointCloud& cloud, const LookOptions& options) {
  return unitNamed(options.unit).value_or(unitSaidIn(cloud.storedAs.comments));
}

HeightRange heightsOf(const Model& model, UpAxis up) {
  const DVec3 top = directionOf(up);
  const Bounds shown = model.shownBounds();
  const double a = glm::dot(shown.min + model.cloud.origin, top);
  const double b = glm::dot(shown.max + model.cloud.origin, top);
  return {std::min(a, b), std::max(a, b)};
}

Legend heightLegend(const Model& model, UpAxis up, LengthUnit unit, ColorMap map) {
  const HeightRange heights = heightsOf(model, up);
  return legendOf("height", unit, heights.low, heights.high, map);
}

}  // namespace palpate
