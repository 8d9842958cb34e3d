// Tools of a simulation on a GPU: what it is told of hands, and what it says of the balls.
#pragma once

#include <span>

#include "engine/matter/matter_simulation.hpp"
#include "shaders/shared/matter_state.h"

namespace palpate {

class Buffer;
class Device;
class Queue;

/// Where hands are at the end of each substep, while they go from one place to another: `steps` has one for each tool,
/// substep by substep.
void writeHandSteps(std::span<const HandPose> from, std::span<const HandPose> to, double substep_s,
                    std::span<shared::HandStep> steps);

/// What holds the balls of a scene's tool.
shared::ToolSpring springOnGpu(const MatterScene& scene, const MatterPlan& plan);

/// Puts the ball of a tool to where its hand is, at rest: `first`: where the tools' states begin in `state`, bytes.
void putToHand(Device& device, Queue& queue, const Buffer& state, std::uint64_t first, std::size_t tool);

/// Of a step that ended with the hand there.
ToolReport reportOf(const shared::ToolState& tool, const HandPose& hand);

}  // namespace palpate
