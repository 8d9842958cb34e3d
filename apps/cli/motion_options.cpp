#include "apps/cli/motion_options.hpp"

#include "apps/cli/parse_list.hpp"
#include "haptics/session/bounds.hpp"

namespace palpate {

void addMotionOptions(Options& command, MotionOptions& options) {
  std::vector<std::string> kinds{"none"};
  for (const auto& [name, kind] : kMotionKinds) kinds.emplace_back(name);
  command
      .add("--motion", options.kind,
           "rigid motion of the model: none, oscillate or drift along --motion-axis, or turn about it; a "
           "moving model cannot be sculpted (vulkan, cpu)")
      .check(oneOf(std::move(kinds)))
      .showDefault();
  command.add("--motion-axis", options.axis, "axis X,Y,Z in the axes of the model, of any length").showDefault();
  command.add("--motion-amplitude", options.amplitude_mm, "oscillate: amplitude, mm")
      .check(between(0, bounds::kLongest_mm))
      .showDefault();
  command.add("--motion-frequency", options.frequency_Hz, "oscillate, turn: frequency, Hz")
      .check(between(0, bounds::kMaxRate_Hz))
      .showDefault();
  command.add("--motion-speed", options.speed_mm_per_s, "drift: speed, mm/s")
      .check(between(0, bounds::kLongest_mm))
      .showDefault();
}

std::optional<MotionConfig> motionConfig(const MotionOptions& options) {
  for (const auto& [name, kind] : kMotionKinds) {
    if (options.kind != name) continue;
    const auto [x, y, z] = parseList<double, 3>(options.axis, ',', "--motion-axis", "X,Y,Z");
    const DVec3 axis(x, y, z);
    if (!isFinite(axis) || !(glm::length(axis) > 0))
      throw UsageError("--motion-axis: {} is not a direction", options.axis);
    return MotionConfig{.kind = kind,
                        .axis = axis,
                        .amplitude_mm = options.amplitude_mm,
                        .frequency_Hz = options.frequency_Hz,
                        .speed_mm_per_s = options.speed_mm_per_s};
  }
  return std::nullopt;
}

}  // namespace palpate
