// Up axis and length unit of a model, for pictures and heights.
#pragma once

#include "apps/cli/model.hpp"
#include "engine/cloud/length_unit.hpp"
#include "engine/cloud/up.hpp"
#include "haptics/session/colored_field.hpp"
#include "haptics/session/framing.hpp"

namespace palpate {

struct LookOptions {
  std::string up = "auto", unit = "auto";
};
/// --up and --unit.
void addLookOptions(Options& command, LookOptions& options);

/// Nothing for auto.
std::optional<UpAxis> upNamed(std::string_view name);
/// Nothing for auto.
std::optional<LengthUnit> unitNamed(std::string_view name);

/// From the options, or else from the model.
Upright uprightOf(const Model& model, const LookOptions& options);
LengthUnit unitOf(const PointCloud& cloud, const LookOptions& options);

/// Minimum and maximum shown position along the up axis, in the file's coordinates.
struct HeightRange {
  double low = 0, high = 0;
};
HeightRange heightsOf(const Model& model, UpAxis up);
Legend heightLegend(const Model& model, UpAxis up, LengthUnit unit, ColorMap map);

}  // namespace palpate
