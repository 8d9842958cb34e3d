// Options that choose the answering machine and its method, shared by touch and bench.
#pragma once

#include "apps/cli/model.hpp"
#include "engine/contact/query_method.hpp"
#include "haptics/session/backends.hpp"

namespace palpate {

struct BackendOptions {
  std::string backend = "vulkan", index = "incremental", bucketKey = "teschner", ahead = "auto";
  std::string method, surface;  ///< empty: the back end's default
  bool deterministic = false, realtime = false;
  std::string radius = "auto";
  double cell_mm = 0, friction = 0;
  std::string tool = "point", toolAxis;  ///< empty axis: -z
  std::size_t toolPoints = 0;            ///< 0: the default number, if the tool has many
  double toolSize_mm = 0;                ///< 0: the default size
  bool timePasses = false;
};
/// Back end, method and index, with addIndexOptions().
void addBackendOptions(Options& command, BackendOptions& options);
/// Surface, friction and support radius: --surface, --friction and --radius; not included in addBackendOptions().
void addSurfaceOptions(Options& command, BackendOptions& options);
void addRadiusOption(Options& command, BackendOptions& options);
/// The tool: --tool and its shape; not included in addBackendOptions().
void addToolOptions(Options& command, BackendOptions& options);
/// Sets a session's back end, index, surface, tool and real time from the options. Throws UsageError.
void setBackend(SessionConfig& config, const BackendOptions& options);
/// Layout of the index, and when it is asked; included in addBackendOptions(). Returns --cell.
Option addIndexOptions(Options& command, BackendOptions& options);
/// The answering back end before a model is loaded.
struct ChosenBackend {
  std::string name;
  bool isOpen = false;  ///< a GPU that `auto` took without an option that requires it: the CPU may answer sooner
};
/// The given one or, for `auto`, the one that the other options require, else Vulkan on a GPU, or the CPU if there is
/// none or only a software driver, which is far slower and feels the same. Throws GpuError for a GPU that is requested
/// by name and missing.
ChosenBackend chooseBackend(const Context& context, const BackendOptions& options);
/// For a back end that is open, in real time: which of GPU and CPU answers this session sooner (soonerBackend()).
/// `laterBrush`: a brush that the session may get; empty: it keeps the configured one, or none.
std::string soonerBackend(Context& context, const SessionConfig& config, const Model& model,
                          const std::optional<BrushConfig>& laterBrush = {});
/// Names of this program's back ends.
std::vector<std::string> backendChoices();
/// Throws ConfigError for options that the back end does not support; before anything is loaded.
void checkBackendOptions(const Context& context, const BackendOptions& options);

}  // namespace palpate
