#include "haptics/library/subject.hpp"

#include <algorithm>
#include <utility>

#include "haptics/library/gpu_half.hpp"
#include "haptics/library/options.hpp"
#include "haptics/session/backend_choice.hpp"

namespace palpate::library {

namespace {

std::size_t handsFrom(const pp_session_options& options) {
  if (options.hands > PP_MAX_HANDS) throw UsageError("hands: {} exceed the maximum of {}", options.hands, PP_MAX_HANDS);
  return std::max(1u, options.hands);
}

}  // namespace

SessionConfig configFrom(const Subject& subject, const pp_session_options& options) {
  const pp_contact_options contact = optionsFrom(options.contact, "contact");
  SessionConfig config{.model = subject.model, .surface = surfaceFrom(contact), .force = forceFrom(contact)};
  config.model.mm_per_unit = options.mm_per_unit;
  if (options.estimate_normals) config.model.normals = NormalSource::estimate;
  if (options.tool) config.tool = toolFrom(optionsFrom(options.tool, "tool"));
  config.hands.resize(handsFrom(options));
  config.rate_Hz = options.rate_Hz;
  config.undo.memory_MiB = options.undo_memory_MiB;
  config.backend.name = backendOf(options.backend, {options.gpu, options.vulkan}, hasRealGpu);
  validate(config);
  return config;
}

Model modelFrom(const Subject& subject, const SessionConfig& config, const ModelLoading& loading) {
  if (!subject.hasArrays()) return loadModel(config.model, loading);
  ModelConfig model = config.model;
  PointCloud cloud;
  if (subject.clouds.empty()) {
    cloud = *subject.cloud;
  } else {
    cloud = mergedCloud(subject.clouds, model.normals, loading);
    model.normals = NormalSource::keep;
  }
  if (cloud.empty()) throw UsageError("the cloud contains no points");
  return modelOf(std::move(cloud), model, loading);
}

}  // namespace palpate::library
