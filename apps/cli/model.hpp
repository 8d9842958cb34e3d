// The model that a subcommand is about, as the command line names it.
#pragma once

#include "apps/cli/context.hpp"
#include "haptics/session/model.hpp"

namespace palpate {

struct NetworkOptions;

/// How large the model is in the hand.
struct ScaleOptions {
  double mm_per_unit = 0;  ///< 0: as the file says, or the longest side becomes 100 mm
  std::string from;        ///< two places of the model and how far apart they are; empty: none

  /// Millimetres per model unit; 0 as above. Throws UsageError.
  double given() const;
};
/// --mm-per-unit and --scale-from.
void addScaleOptions(Options& command, ScaleOptions& options);
/// --all-points.
void addAllPointsOption(Options& command, bool& allPoints);

struct ModelOptions {
  std::string file;
  ScaleOptions scale;
  std::string normals = "keep";
  bool allPoints = false;

  /// Throws UsageError.
  ModelConfig config() const;
};
/// `what` the model may be, for the help; whether there may be another one in its place (stream_options.hpp).
void addModelOptions(Options& command, ModelOptions& options);
void addModelOptions(Options& command, ModelOptions& options, const std::string& what, bool isRequired);

/// What --radius says: a length in mm, or nothing for auto. Throws UsageError.
std::optional<double> radius_mm(const std::string& text);
/// The same as a support radius in model units; for auto the usual one.
double supportRadius(const std::string& text, const Model& model);

/// Where normals are estimated: on the GPU where one is going to be opened anyway.
enum class EstimateOn { cpu, gpu };
/// Reads the file, and sees to normals as the options say. `network`: where a topic of ROS may be heard in place of a
/// file; null: nowhere. Throws FileError, UsageError.
Model loadModel(Context& context, const ModelOptions& options, EstimateOn where,
                const NetworkOptions* network = nullptr);
Model loadModel(Context& context, const SessionConfig& config, EstimateOn where,
                const NetworkOptions* network = nullptr);

}  // namespace palpate
