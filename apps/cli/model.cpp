#include "apps/cli/model.hpp"

#include <charconv>
#include <cmath>

#include "engine/io/cloud_formats.hpp"
#include "haptics/session/vulkan_backend.hpp"

namespace palpate {

void addModelOptions(Options& command, ModelOptions& options) {
  addModelOptions(command, options,
                  fmt::format("{} file: points, normals, colours; everything else is carried or skipped",
                              cloudFormats().namesRead()),
                  true);
}

void addModelOptions(Options& command, ModelOptions& options, const std::string& what, bool isRequired) {
  Option model = command.add("model", options.file, what).typeName("MODEL");
  if (isRequired) model.required();
  command
      .add("--mm-per-unit", options.mm_per_unit,
           "millimetres per model unit (default: the longest side becomes 100 mm)")
      .check(between(bounds::kLeastScale, bounds::kMostScale));
  command
      .add("--normals", options.normals,
           "keep: the file's, estimated where it has none; estimate: from the points; face: from the faces")
      .check(oneOf({"keep", "estimate", "face"}))
      .showDefault();
}

ModelConfig ModelOptions::config() const {
  ModelConfig config{.file = file, .mm_per_unit = mm_per_unit};
  for (const auto& [name, source] : kNormalSources)
    if (name == normals) config.normals = source;
  return config;
}

std::optional<double> radius_mm(const std::string& text) {
  if (text == "auto") return std::nullopt;
  double radius_mm = 0;
  const char* end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, radius_mm);
  if (error != std::errc() || last != end || !(radius_mm > 0) || !std::isfinite(radius_mm))
    throw UsageError("--radius: '{}' is neither a positive length in mm nor 'auto'", text);
  return radius_mm;
}

double supportRadius(const std::string& text, const Model& model) {
  const std::optional<double> given_mm = radius_mm(text);
  return given_mm ? model.scale.toUnits(*given_mm) : usualSupportRadius(model);
}

Model loadModel(Context& context, const SessionConfig& config, EstimateOn where) {
  ModelLoading loading{.log = context.log(), .threads = context.threads()};
  if (where == EstimateOn::gpu) loading.estimate = estimateNormalsOn([&]() -> Device& { return context.device(); });
  return loadModel(config, loading);
}

Model loadModel(Context& context, const ModelOptions& options, EstimateOn where) {
  return loadModel(context, SessionConfig{.model = options.config()}, where);
}

}  // namespace palpate
