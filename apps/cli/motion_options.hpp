// Options for the motion of a model.
#pragma once

#include <optional>
#include <string>

#include "apps/cli/options.hpp"
#include "haptics/session/session_config.hpp"

namespace palpate {

struct MotionOptions {
  std::string kind = "none";
  MotionConfig motion;
};
void addMotionOptions(Options& command, MotionOptions& options);

/// The motion according to the options; empty if the model stands still. Throws UsageError.
std::optional<MotionConfig> motionConfig(const MotionOptions& options);

}  // namespace palpate
