#include "engine/matter/gpu_tools.hpp"

#include <glm/gtc/quaternion.hpp>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/device.hpp"
#include "engine/matter/tool_body.hpp"

namespace palpate {

void writeHandSteps(std::span<const HandPose> from, std::span<const HandPose> to, double substep_s,
                    std::span<shared::HandStep> steps) {
  const std::size_t tools = to.size();
  if (tools == 0) return;
  const std::size_t substeps = steps.size() / tools;
  for (std::size_t tool = 0; tool < tools; ++tool) {
    HandPose before = from[tool];
    for (std::size_t substep = 0; substep < substeps; ++substep) {
      const HandPose now =
          between(from[tool], to[tool], (static_cast<double>(substep) + 1.0) / static_cast<double>(substeps));
      const glm::mat3 turn(glm::mat3_cast(glm::normalize(now.orientation)));
      steps[substep * tools + tool] = {.place = now.place_m,
                                       .move = now.place_m - before.place_m,
                                       .spin = spinBetween(before.orientation, now.orientation, substep_s),
                                       .x = turn[0],
                                       .y = turn[1],
                                       .z = turn[2],
                                       .grown = 0};
      before = now;
    }
  }
}

shared::ToolSpring springOnGpu(const MatterScene& scene, const MatterPlan& plan) {
  const shared::ToolSpringOf<double> spring = toolSpring(scene.tool, plan.substep_s);
  return {.mass = static_cast<float>(spring.mass),
          .stiffness = static_cast<float>(spring.stiffness),
          .damping = static_cast<float>(spring.damping),
          .step = static_cast<float>(spring.step)};
}

// A position is stored relative to the hand's, so all zeros is a ball at the hand.
void putToHand(Device& device, Queue& queue, const Buffer& state, std::uint64_t first, std::size_t tool) {
  CommandList list(device, queue, "place a tool");
  list.begin();
  list.fill(state, 0, sizeof(shared::ToolState), first + tool * sizeof(shared::ToolState));
  list.end();
  queue.run(list);
}

ToolReport reportOf(const shared::ToolState& tool, const HandPose& hand) {
  return {.springImpulse = tool.springImpulse,
          .impulse = tool.impulse,
          .angular = tool.angular,
          .modelImpulse = tool.modelImpulse,
          .portWork_J = static_cast<double>(tool.portWork),
          .place_m = hand.place_m + DVec3(tool.lag),
          .velocity_m_s = tool.velocity};
}

}  // namespace palpate
