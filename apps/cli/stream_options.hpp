// A depth camera as the model, recorded or live, as the command line names it.
#pragma once

#include <optional>
#include <string>

#include "apps/cli/options.hpp"
#include "apps/cli/sharing_options.hpp"
#include "haptics/session/session_config.hpp"

namespace palpate {

struct StreamOptions {
  std::string live;  ///< a device, "-", or a topic of ROS; empty: none
  std::string intrinsics;
  double depthScale = 0, speed = 1;
  bool loop = false;
  std::string fuse = "off";
};
/// --intrinsics and --depth-scale.
void addDepthOptions(Options& command, StreamOptions& options);
/// Those, and --live, --speed, --loop and --fuse.
void addStreamOptions(Options& command, StreamOptions& options);

/// What a command takes from a topic of ROS in place of a file.
enum class RosModels { none, clouds, cloudsAndPictures };
/// Of the model, as the help calls it.
std::string modelsAndStreams(RosModels ros = RosModels::cloudsAndPictures);

/// Where it is asked what is sent on a topic of ROS, and who hears of it.
struct RosQuestion {
  const NetworkOptions& network;
  Log& log;
};
/// What the options say of a model's file, which a live camera is instead of one; nothing where it is a cloud. A topic
/// of ROS is a live camera where pictures of depth are sent there: `ros`, if any, is asked, and waits for who sends.
/// Throws UsageError for options that do not go with it, NetworkError.
std::optional<StreamConfig> streamConfig(const StreamOptions& options, std::string& modelFile,
                                         const RosQuestion* ros = nullptr);

}  // namespace palpate
