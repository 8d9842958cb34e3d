#include "apps/model.hpp"

#include <algorithm>
#include <charconv>

#include "engine/cloud/gist.hpp"
#include "engine/cloud/normals.hpp"
#include "engine/cloud/ply_reader.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/contact/normal_estimate.hpp"
#include "engine/core/clock.hpp"
#include "shaders/shared/contact.h"

namespace palpate {

void addModelOptions(CLI::App& command, ModelOptions& options) {
  command
      .add_option("model", options.file, "PLY file: points, normals, colours; everything else is carried or skipped")
      ->required()
      ->type_name("MODEL");
  command
      .add_option("--mm-per-unit", options.mm_per_unit,
                  "millimetres per model unit (default: the longest side becomes 100 mm)")
      ->check(between(bounds::kLeastScale, bounds::kMostScale));
  command
      .add_option("--normals", options.normals,
                  "keep: the file's, estimated where it has none; estimate: from the points; face: from the faces")
      ->check(CLI::IsMember({"keep", "estimate", "face"}))
      ->capture_default_str();
}

namespace {

void seeToNormals(Context& context, const ModelOptions& options, EstimateOn where, PointCloud& cloud) {
  if (cloud.hasNormals() && options.normals != "estimate") return;
  const Stopwatch watch;
  if (where == EstimateOn::cpu || context.device().isCpu()) {
    estimateNormals(cloud, 16, context.threads());
    if (!cloud.empty())
      context.log().say("{}: normals are estimated from the points: {:.0f} ms on the CPU", options.file,
                        watch.elapsed_us() * 1e-3);
    return;
  }
  const NormalEstimateCost cost = estimateNormals(context.device(), cloud, context.threads());
  if (!cloud.empty())
    context.log().say("{}: normals are estimated from the points: planes {:.0f} ms on {}, signs {:.0f} ms on the CPU",
                      options.file, cost.planes_ms, context.device().name(), cost.signs_ms);
}

}  // namespace

Model loadModel(Context& context, const ModelOptions& options, EstimateOn where) {
  Model model;
  Log& log = context.log();
  model.cloud = readPly(options.file, &log, {.normalsFromFaces = options.normals == "face"});
  PointCloud& cloud = model.cloud;
  // Before normals are estimated, so that all who read the file find the same.
  model.upright = findUp(cloud);
  model.shown = coreBoundsOf(cloud);
  const bool estimates = !cloud.hasNormals() || options.normals == "estimate";
  seeToNormals(context, options, where, cloud);
  // One or two points lie in no plane: their discs face whoever looks at them.
  constexpr std::size_t kNoPlane = 2;
  if (estimates && cloud.size() <= kNoPlane) cloud.normals.assign(cloud.size(), Vec3(frontOf(model.upright.up)));
  model.scale =
      options.mm_per_unit > 0 ? ModelScale{options.mm_per_unit} : ModelScale::fitting(boundsOf(cloud).longestSide());
  const SpacingRange spacing = spacingRange(cloud, context.threads());
  model.spacing = spacing.mean;
  model.wideSpacing = spacing.wide;
  model.noise = spacing.noise;
  return model;
}

double supportRadius(const std::string& text, const Model& model) {
  if (text == "auto") {
    if (model.spacing > 0) return static_cast<double>(shared::kSupportSpacings) * model.spacing;
    return model.scale.toUnits(1.0);  // nothing to measure: any length will do
  }
  double radius_mm = 0;
  const char* end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, radius_mm);
  if (error != std::errc() || last != end || !(radius_mm > 0) || !std::isfinite(radius_mm))
    throw UsageError("--radius: '{}' is neither a positive length in mm nor 'auto'", text);
  return model.scale.toUnits(radius_mm);
}

}  // namespace palpate
