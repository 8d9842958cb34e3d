#include "haptics/session/moving_model.hpp"

#include "engine/motion/depth_source.hpp"
#include "engine/motion/fused_source.hpp"
#include "engine/motion/moving_cloud.hpp"

namespace palpate {

std::optional<RigidMotion> rigidMotion(const SessionConfig& config, const Model& model) {
  if (!config.motion) return std::nullopt;
  const MotionConfig& motion = *config.motion;
  return RigidMotion{.kind = motion.kind,
                     .axis = glm::normalize(motion.axis),
                     .centre = model.shownBounds().center(),
                     .amplitude = model.scale.toUnits(motion.amplitude_mm),
                     .frequency_Hz = motion.frequency_Hz,
                     .speed = model.scale.toUnits(motion.speed_mm_per_s)};
}

std::unique_ptr<CloudSource> makeSource(const SessionConfig& config, const Model& model,
                                        const std::shared_ptr<PlayedStream>& stream,
                                        const std::optional<FusedStream>& fusion) {
  if (fusion) return std::make_unique<FusedSource>(*fusion);
  if (stream) return std::make_unique<DepthSource>(stream, model.cloud.origin);
  const std::optional<RigidMotion> motion = rigidMotion(config, model);
  if (!motion) return nullptr;
  return std::make_unique<MovingCloud>(model.cloud, *motion);
}

}  // namespace palpate
