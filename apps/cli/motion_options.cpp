#include "apps/cli/motion_options.hpp"

#include "apps/cli/setting_options.hpp"

namespace palpate {

void addMotionOptions(Options& command, MotionOptions& options) {
  addSettingFor<MotionConfig>(command, options.kind, "kind")
      .check(oneOf(choicesOf<MotionConfig>("kind", {"none"})))
      .showDefault();
  addSettings(command, options.motion, "kind");
}

std::optional<MotionConfig> motionConfig(const MotionOptions& options) {
  const auto kind = valueNamed(kMotionKinds, options.kind);
  if (!kind) return std::nullopt;
  MotionConfig motion = options.motion;
  motion.kind = *kind;
  if (!isFinite(motion.axis) || !(glm::length(motion.axis) > 0))
    throw UsageError("--motion-axis: {} is not a direction", listText(motion.axis));
  return motion;
}

}  // namespace palpate
