#include "haptics/sharing/brick_cloud.hpp"

#include <algorithm>
#include <utility>

#include "haptics/session/session_setup.hpp"
#include "haptics/sharing/brick_touch.hpp"

namespace palpate {

namespace {

std::unique_ptr<FarTouch> feelSurface(BrickSource& source, const BackendSetup& setup) {
  const SessionConfig& config = setup.config;
  const Model& model = setup.model;
  const SurfaceOptions& surface = setup.surface;
  std::vector<ToolShape> tools = toolsOf(config, model);
  double reach = 0;
  for (const ToolPoint& point : tools.front().points) reach = std::max(reach, glm::length(point.place));
  auto felt = setup.kind.make({.model = model,
                               .config = config,
                               .surface = surface,
                               .brush = std::nullopt,
                               .tools = std::move(tools),
                               .threads = setup.threads,
                               .source = &source,
                               .fusion = std::nullopt});
  return std::make_unique<BrickTouch>(source, std::move(felt),
                                      BrickTouchOptions{.radius = surface.radius,
                                                        .widening = surface.widening,
                                                        .tool = reach,
                                                        .origin = model.cloud.origin,
                                                        .brush = brushOf(config.brush, model),
                                                        .fixed = fixedBecause(config, model)});
}

}  // namespace

std::unique_ptr<FarTouch> BrickCloud::makeTouch(const BackendSetup& setup) {
  return setup.model.as<FarPoints>()->scene ? feelMatter(source(), known(), setup) : feelSurface(source(), setup);
}

}  // namespace palpate
