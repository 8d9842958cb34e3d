// Options for a depth camera as the model, recorded or live.
#pragma once

#include <optional>
#include <string>

#include "apps/cli/model.hpp"
#include "apps/cli/options.hpp"
#include "apps/cli/sharing_options.hpp"
#include "haptics/session/session_config.hpp"

namespace palpate {

struct StreamOptions {
  std::string live;  ///< a device, "-", or a topic of ROS; empty: none
  StreamConfig stream;
  std::string fuse = "off";
};
/// --intrinsics and --depth-scale.
void addDepthOptions(Options& command, StreamOptions& options);
/// The same, and --live, --speed, --loop and --fuse.
void addStreamOptions(Options& command, StreamOptions& options);

/// Content that a command accepts from a ROS topic in place of a file.
enum class RosModels { none, clouds, cloudsAndPictures };
/// Description of the model for the help.
std::string modelsAndStreams(RosModels ros = RosModels::cloudsAndPictures);

/// Network on which the content of a ROS topic is determined, and the log for that.
struct RosQuestion {
  const NetworkOptions& network;
  Log& log;
};
/// The stream according to the options, for a model's file, or a live camera in place of it; empty if the model is a
/// cloud. With `ros`, waits for the first message of a ROS topic: depth pictures make it a live camera. Throws
/// UsageError for incompatible options, NetworkError.
std::optional<StreamConfig> streamConfig(const StreamOptions& options, std::string& modelFile,
                                         const RosQuestion* ros = nullptr);
/// Sets the stream of a model, or else the scene that its file names. As streamConfig().
void setSource(ModelConfig& model, const StreamOptions& options, const RosQuestion* ros = nullptr);
/// The model of a command that may also join a session in place of a file. As joinConfig() and streamConfig().
ModelConfig chosenModel(const ModelOptions& options, const StreamOptions& stream, const JoinOptionsGiven& join,
                        Log& log);

}  // namespace palpate
