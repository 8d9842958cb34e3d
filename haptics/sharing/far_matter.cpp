#include <algorithm>
#include <utility>

#include "engine/core/parallel.hpp"
#include "engine/matter/matter_pond.hpp"
#include "engine/matter/matter_rules.hpp"
#include "engine/matter/matter_touch.hpp"
#include "haptics/session/session_setup.hpp"
#include "haptics/sharing/brick_cloud.hpp"
#include "haptics/sharing/brick_matter.hpp"
#include "haptics/sharing/brick_touch.hpp"
#include "haptics/simulation/matter_choice.hpp"
#include "haptics/simulation/scene_model.hpp"

namespace palpate {

std::unique_ptr<FarTouch> feelMatter(BrickSource& source, const BackendSetup& setup) {
  const SessionConfig& config = setup.config;
  const Model& model = setup.model;
  if (config.tool.kind != ToolKind::point) throw ConfigError("tool.kind", "in matter a hand holds the scene's ball");
  const MatterScene& scene = matterOf(model.as<FarPoints>()->scene);
  const std::size_t hands = std::max<std::size_t>(1, config.hands.size());
  // Some thousand particles, two or more steps per millisecond: threads that wait for one another need a core each.
  constexpr unsigned kMaxThreads = 4;
  const unsigned threads = std::clamp(threadCount(setup.threads) / kMaxThreads, 1U, kMaxThreads);
  constexpr std::uint64_t kMemory_bytes = std::uint64_t{1} << 32;  // limit for a scene from another program
  auto pond = std::make_unique<MatterPond>(
      scene,
      MatterOptions{.threads = threads, .tools = hands, .memory_bytes = kMemory_bytes, .model = standingOf(model)},
      newsOf(source));
  auto felt =
      std::make_unique<MatterTouch>(std::move(pond), MatterTouchOptions{.hands = hands,
                                                                        .threads = setup.threads,
                                                                        .realtime = true,
                                                                        .machine = cpuBackend()->machine(threads),
                                                                        .varies = true});
  // Reach of the weights.
  const double support = kSupport_spacings * particleSpacing_mm(scene);
  return std::make_unique<BrickTouch>(source, std::move(felt),
                                      BrickTouchOptions{.radius = support,
                                                        .tool = scene.tool.radius_mm,
                                                        .origin = model.cloud.origin,
                                                        .brush = brushOf(config, model),
                                                        .fixed = fixedBecause(config, model)});
}

}  // namespace palpate
