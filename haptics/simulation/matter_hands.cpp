#include "haptics/simulation/matter_hands.hpp"

#include <algorithm>

#include "engine/matter/matter_touch.hpp"
#include "engine/matter/soft_touch.hpp"
#include "haptics/simulation/scene_model.hpp"
#include "haptics/simulation/simulator.hpp"

namespace palpate {

namespace {

// A soft body, whose points are felt as those of any moving cloud.
std::unique_ptr<TouchBackend> touchSoft(const MatterScene& scene, const BackendKind& backend,
                                        const BackendRequest& request) {
  // Maximum number of steps per frame in real time: more would only delay the answers further.
  constexpr std::uint32_t kMaxAtOnce = 4;
  MatterOptions options{.threads = request.threads};
  options.soft = softBodyOf(request.model);
  double reach = 0;
  for (const ToolPoint& point : request.tools.front().points) reach = std::max(reach, glm::length(point.place));
  auto world = simulatorOf(backend).simulate(scene, options);
  auto source = std::make_unique<SoftSource>(std::move(world), SoftSourceOptions{.points = request.model.cloud.size(),
                                                                                 .hands = request.tools.size(),
                                                                                 .radius = request.surface.radius,
                                                                                 .toolReach = reach,
                                                                                 .mostAtOnce = kMaxAtOnce});
  BackendRequest felt = request;
  felt.source = source.get();
  felt.brush.reset();  // the body has the brush, and its points follow
  felt.paintable = false;
  auto surface = backend.make(felt);
  return std::make_unique<SoftTouch>(
      std::move(source), std::move(surface),
      SoftTouchOptions{.tools = request.tools, .friction = request.config.surface.friction, .brush = request.brush});
}

}  // namespace

std::unique_ptr<TouchBackend> touchMatter(const MatterScene& scene, const BackendKind& backend,
                                          const BackendRequest& request) {
  if (scene.matter == Matter::soft) return touchSoft(scene, backend, request);
  const std::size_t hands = request.tools.size();
  return std::make_unique<MatterTouch>(
      simulatorOf(backend).simulate(scene,
                                    {.threads = request.threads, .tools = hands, .model = standingOf(request.model)}),
      MatterTouchOptions{.hands = hands,
                         .threads = request.threads,
                         .realtime = request.config.realtime,
                         .machine = backend.machine(request.threads)});
}

}  // namespace palpate
