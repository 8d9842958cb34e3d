// A model as the subcommands use it: a cloud with normals, its scale, its spacing.
#pragma once

#include "apps/context.hpp"
#include "engine/cloud/point_cloud.hpp"
#include "engine/cloud/up.hpp"
#include "engine/core/units.hpp"

namespace palpate {

struct ModelOptions {
  std::string file;
  double mm_per_unit = 0;  ///< 0: the longest side becomes 100 mm
  std::string normals = "keep";
};
void addModelOptions(CLI::App& command, ModelOptions& options);

struct Model {
  PointCloud cloud;
  ModelScale scale;
  double spacing = 0;      ///< model units
  double wideSpacing = 0;  ///< where the points lie far apart (SpacingRange), model units
  double noise = 0;        ///< of the positions, off their surface (SpacingRange), spacings
  Upright upright;         ///< by the shape
  /// What a picture shows (coreBoundsOf()); all when not given.
  std::optional<Bounds> shown;
  Bounds shownBounds() const { return shown ? *shown : boundsOf(cloud); }
};
/// Where normals are estimated: on the GPU where one is going to be opened anyway; the CPU steps in for a software
/// driver, which takes twice as long for the same.
enum class EstimateOn { cpu, gpu };
/// Reads the file, and sees to normals as the options say. Throws FileError, UsageError.
Model loadModel(Context& context, const ModelOptions& options, EstimateOn where);

/// Support radius in model units: `text` is a length in mm or `auto`, four spacings.
double supportRadius(const std::string& text, const Model& model);

}  // namespace palpate
