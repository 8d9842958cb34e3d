// Which machine answers the poses, and by which method: the options that touch and bench share.
#pragma once

#include "apps/model.hpp"
#include "engine/contact/surface_reference.hpp"
#include "engine/touch/touch_side.hpp"

namespace palpate {

struct BackendOptions {
  std::string backend = "vulkan", index = "incremental", bucketKey = "teschner", sort = "counting", ahead = "auto";
  std::string method, surface, wait;  ///< empty: the back end's own choice
  bool deterministic = false, realtime = false;
  std::string radius = "auto";
  double cell_mm = 0, grid = 0;
  double friction = 0;
  std::string tool = "point", toolAxis;  ///< what touches; the axis empty: -z
  std::size_t toolPoints = 0;            ///< 0: kUsualToolPoints where the tool has many
  double toolSize_mm = 0;                ///< 0: kUsualToolSize_mm
  bool timePasses = false;
  bool secondHand = false;                  ///< is felt for as well; no option of its own
  bool paintable = false;                   ///< keeps colours for a brush that comes later; no option of a session
  std::optional<std::uint32_t> spareSlots;  ///< of an index that follows edits; no option of a session
};
/// Who answers, by which method, and how it is waited for.
void addBackendOptions(CLI::App& command, BackendOptions& options);
/// What the points define, and how it is felt: --surface, --friction and --radius. addBackendOptions() does not add
/// them.
void addSurfaceOptions(CLI::App& command, BackendOptions& options);
void addRadiusOption(CLI::App& command, BackendOptions& options);
/// What touches: --tool and what it looks like. addBackendOptions() does not add them.
void addToolOptions(CLI::App& command, BackendOptions& options);
inline constexpr std::size_t kUsualToolPoints = 16;
inline constexpr double kUsualToolSize_mm = 10;
/// The tool that the options ask for, model units; without points where it is a single one. Throws UsageError.
ToolShape toolShape(const BackendOptions& options, const ModelScale& scale);
/// How the index is laid out and built, and how the GPU is waited for; addBackendOptions() adds them, too.
void addIndexOptions(CLI::App& command, BackendOptions& options);
/// The back end that answers: the one that is named or, for `auto`, what the other options leave: Vulkan on a GPU, and
/// the CPU where there is none or only a software driver, which is slower than the CPU by far and feels the same.
/// Throws GpuError for a GPU that is asked for by name and not there.
std::string chooseBackend(const Context& context, const BackendOptions& options);
/// The back ends and the surfaces that this program has, and the methods of one back end.
std::vector<std::string> backendChoices();
std::vector<std::string> surfaceChoices();
std::vector<std::string> methodChoices(std::string_view backend);
/// Throws UsageError for options that do not go together; before anything is loaded.
void checkBackendOptions(const BackendOptions& options);
/// The method that is used.
std::string methodName(const BackendOptions& options);

/// Where normals are estimated for a session on this back end: the same for it and for its replay.
EstimateOn estimateOn(const BackendOptions& options);

/// The surface and the support radius that the options ask for.
SurfaceOptions surfaceOptions(const Model& model, const BackendOptions& options);

/// The machine that a back end runs on, in words.
std::string machineOf(Context& context, std::string_view backend);

/// The grid that the options ask for.
HashGrid gridFor(const Model& model, const BackendOptions& options);

/// A cloud ready to be touched. Keeps a reference to the model. Opens the GPU only for a back end that is one.
std::unique_ptr<TouchBackend> makeBackend(Context& context, const Model& model, const BackendOptions& options,
                                          const std::optional<BrushOptions>& push);

}  // namespace palpate
