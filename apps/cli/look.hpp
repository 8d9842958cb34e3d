// How a model stands and what its lengths are called, wherever a picture or a height is made.
#pragma once

#include "apps/cli/model.hpp"
#include "engine/cloud/length_unit.hpp"
#include "engine/cloud/up.hpp"
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

/// What the options say, or the model.
Upright uprightOf(const Model& model, const LookOptions& options);
LengthUnit unitOf(const PointCloud& cloud, const LookOptions& options);

/// The lowest and the highest place that a picture shows, along up, in the file's coordinates.
struct HeightRange {
  double low = 0, high = 0;
};
HeightRange heightsOf(const Model& model, UpAxis up);

}  // namespace palpate
