#include "apps/look.hpp"

#include <algorithm>

namespace palpate {

namespace {

std::vector<std::string> namesWithAuto(const auto& table) {
  std::vector<std::string> names{"auto"};
  for (const auto& [name, each] : table) names.emplace_back(name);
  return names;
}

template <class T>
std::optional<T> found(const auto& table, std::string_view name) {
  for (const auto& [each, value] : table)
    if (each == name) return value;
  return std::nullopt;
}

}  // namespace

void addLookOptions(CLI::App& command, LookOptions& options) {
  command
      .add_option(
          "--up", options.up,
          "which way is up, in pictures and for heights: x, y, z, -x, -y, -z, or auto (by the shape: ground, and "
          "what stands on a base)")
      ->check(CLI::IsMember(namesWithAuto(kUpAxes)))
      ->capture_default_str();
  command
      .add_option("--unit", options.unit,
                  "the file's unit of length, for scale bars, heights and reports: mm, cm, m, in, ft, or auto (what a "
                  "comment of the file says); scales nothing, as --mm-per-unit does")
      ->check(CLI::IsMember(namesWithAuto(kLengthUnits)))
      ->capture_default_str();
}

std::optional<UpAxis> upNamed(std::string_view name) { return found<UpAxis>(kUpAxes, name); }

std::optional<LengthUnit> unitNamed(std::string_view name) { return found<LengthUnit>(kLengthUnits, name); }

Upright uprightOf(const Model& model, const LookOptions& options) {
  if (const auto up = upNamed(options.up)) return {*up, "as --up says"};
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

}  // namespace palpate
