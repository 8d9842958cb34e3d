// Which machine answers the poses, and by which method: the options that touch and bench share.
#pragma once

#include "apps/cli/model.hpp"
#include "engine/contact/query_method.hpp"
#include "engine/spatial/hash_grid.hpp"
#include "haptics/session/backends.hpp"

namespace palpate {

struct BackendOptions {
  std::string backend = "vulkan", index = "incremental", bucketKey = "teschner", sort = "counting", ahead = "auto";
  std::string method, surface, wait;  ///< empty: the back end's own choice
  bool deterministic = false, realtime = false;
  std::string radius = "auto";
  double cell_mm = 0, grid = 0;
  double friction = 0;
  std::string tool = "point", toolAxis;  ///< what touches; the axis empty: -z
  std::size_t toolPoints = 0;            ///< 0: the usual number where the tool has many
  double toolSize_mm = 0;                ///< 0: the usual size
  bool timePasses = false;
  std::optional<std::uint32_t> spareSlots;  ///< of an index that follows edits; no option of a session
};
/// Who answers, by which method, and how it is waited for.
void addBackendOptions(Options& command, BackendOptions& options);
/// What the points define, and how it is felt: --surface, --friction and --radius. addBackendOptions() does not add
/// them.
void addSurfaceOptions(Options& command, BackendOptions& options);
void addRadiusOption(Options& command, BackendOptions& options);
/// What touches: --tool and what it looks like. addBackendOptions() does not add them.
void addToolOptions(Options& command, BackendOptions& options);
/// What the options say of a session's back end, index, surface and tool, and whether it is in real time. Throws
/// UsageError.
void setBackend(SessionConfig& config, const BackendOptions& options);
/// How the index is laid out and built, and how the GPU is waited for; addBackendOptions() adds them, too.
void addIndexOptions(Options& command, BackendOptions& options);
/// The back end that answers: the one that is named or, for `auto`, what the other options leave: Vulkan on a GPU, and
/// the CPU where there is none or only a software driver, which is slower than the CPU by far and feels the same.
/// Throws GpuError for a GPU that is asked for by name and not there.
std::string chooseBackend(const Context& context, const BackendOptions& options);
/// The back ends that this program has.
std::vector<std::string> backendChoices();
/// Throws ConfigError for what the back end cannot do; before anything is loaded.
void checkBackendOptions(const Context& context, const BackendOptions& options);

/// The surface and the support radius that the options ask for.
SurfaceOptions surfaceOptions(Context& context, const Model& model, const BackendOptions& options);

/// The grid that the options ask for.
HashGrid gridFor(Context& context, const Model& model, const BackendOptions& options);

}  // namespace palpate
