// Tools of a simulation on a GPU: input of the hands' poses, and reports of the balls.
#pragma once

#include <span>

#include "engine/matter/matter_simulation.hpp"
#include "shaders/shared/matter_state.h"

namespace palpate {

class Buffer;
class Device;
class Queue;

/// Writes the hands' poses at the end of each substep, interpolated from `from` to `to`: `steps` has one entry per tool
/// for each substep.
void writeHandSteps(std::span<const HandPose> from, std::span<const HandPose> to, double substep_s,
                    std::span<shared::HandStep> steps);

/// Spring and damper of the balls of a scene's tool.
shared::ToolSpring springOnGpu(const MatterScene& scene, const MatterPlan& plan);

/// Places the ball of a tool at its hand, at rest. `first`: byte offset of the tools' states in `state`.
void putToHand(Device& device, Queue& queue, const Buffer& state, std::uint64_t first, std::size_t tool);

/// Report of a step that ended with the hand at `hand`.
ToolReport reportOf(const shared::ToolState& tool, const HandPose& hand);

}  // namespace palpate
