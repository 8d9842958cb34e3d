// The model of a subcommand, from the command line.
#pragma once

#include "apps/cli/context.hpp"
#include "apps/cli/prepare_options.hpp"
#include "haptics/session/model.hpp"

namespace palpate {

struct CloudFormat;
struct NetworkOptions;

/// Scale of the model in the hand.
struct ScaleOptions {
  double mm_per_unit = 0;  ///< 0: as the file says, or the longest side becomes 100 mm
  std::string from;        ///< two positions and their distance; empty: none

  /// Millimetres per model unit; 0 as above. Throws UsageError.
  double given() const;
};
/// --mm-per-unit and --scale-from.
void addScaleOptions(Options& command, ScaleOptions& options);
/// --keep-unreliable.
void addAllPointsOption(Options& command, bool& keepUnreliable);

/// The names of --columns for a file of that format. Throws UsageError if it is not text.
std::vector<std::string> columnsFor(const std::string& names, const CloudFormat& from);

struct ModelOptions {
  std::string file;
  ScaleOptions scale;
  std::string normals = "keep";
  bool keepUnreliable = false;
  PrepareOptions prepare = {};

  /// Throws UsageError.
  ModelConfig config() const;
};
/// `what`: description of the model for the help. Not required if something else can replace it (stream_options.hpp).
void addModelOptions(Options& command, ModelOptions& options);
void addModelOptions(Options& command, ModelOptions& options, const std::string& what, bool isRequired);

/// Value of --radius: a length in mm; empty for auto. Throws UsageError.
std::optional<double> radius_mm(const std::string& text);
/// The same as a support radius in model units; the default one for auto.
double supportRadius(const std::string& text, const Model& model);

/// Where normals are estimated: on the GPU if one is opened anyway.
enum class EstimateOn { cpu, gpu };
/// Loads the model. `network`: for a ROS topic in place of a file; null: not supported. Throws FileError, UsageError.
Model loadModel(Context& context, const ModelConfig& config, EstimateOn where, const NetworkOptions* network = nullptr);

}  // namespace palpate
