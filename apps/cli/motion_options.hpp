// Options for the motion of a model.
#pragma once

#include <optional>
#include <string>

#include "apps/cli/options.hpp"
#include "haptics/session/session_config.hpp"

namespace palpate {

struct MotionOptions {
  std::string kind = "none", axis = "0,0,1";
  double amplitude_mm = MotionConfig{}.amplitude_mm, frequency_Hz = MotionConfig{}.frequency_Hz,
         speed_mm_per_s = MotionConfig{}.speed_mm_per_s;
};
void addMotionOptions(Options& command, MotionOptions& options);

/// The motion according to the options; empty if the model stands still. Throws UsageError.
std::optional<MotionConfig> motionConfig(const MotionOptions& options);

}  // namespace palpate
