// What a session is configured with: one value, typed and nested, which every program fills and a session log carries.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/contact/surface_kind.hpp"
#include "engine/core/brush.hpp"
#include "engine/core/error.hpp"
#include "engine/core/index_options.hpp"
#include "engine/core/tool_shape.hpp"
#include "engine/core/vec.hpp"
#include "engine/matter/matter_scene.hpp"
#include "engine/motion/rigid_motion.hpp"
#include "haptics/force_law.hpp"
#include "haptics/passivity.hpp"

namespace palpate {

/// A field of a configuration that is out of its bounds or does not go with another one. The text begins with the
/// field's path, as in "brush.radius_mm".
class ConfigError : public UsageError {
 public:
  template <class... Args>
  explicit ConfigError(std::string_view field, fmt::format_string<Args...> text, Args&&... args)
      : UsageError("{}: {}", field, fmt::format(text, std::forward<Args>(args)...)), field_(field) {}

  const std::string& field() const { return field_; }

 private:
  std::string field_;
};

/// Where a model's normals come from: the file's own, estimated where it has none; always estimated from the points; or
/// from the faces.
enum class NormalSource { keep, estimate, face };
inline constexpr std::array<std::pair<std::string_view, NormalSource>, 3> kNormalSources{
    {{"keep", NormalSource::keep}, {"estimate", NormalSource::estimate}, {"face", NormalSource::face}}};

struct ModelConfig {
  std::string file;
  double mm_per_unit = 0;  ///< millimetres per model unit; 0: as the file says, or the longest side becomes 100 mm
  NormalSource normals = NormalSource::keep;
  bool allPoints = false;  ///< of a reconstruction also those that its own measures tell to be unreliable

  bool operator==(const ModelConfig&) const = default;
};

/// What the points define, and how it is felt.
struct SurfaceConfig {
  SurfaceKind kind = SurfaceKind::average;
  double friction = 0;  ///< coefficient of a proxy that slides; 0 is none, bounds::kMaxFriction the most
  /// Support radius, mm; nothing: four spacings, wider where points are noisy, place by place where spacings differ.
  std::optional<double> radius_mm;

  bool operator==(const SurfaceConfig&) const = default;
};

/// How the index is laid out, built and kept.
struct IndexConfig {
  IndexFollow follow = IndexFollow::incremental;
  BucketKey bucketKey = BucketKey::teschner;
  SortMethod sort = kDefaultSort;
  double cell_mm = 0;         ///< edge of a cell; 0: the support radius, unless `cellsAlongSide` says otherwise
  double cellsAlongSide = 0;  ///< cells along the model's longest side; 0: as cell_mm says. Only one of the two.
  std::optional<std::uint32_t> spareSlots;  ///< for new points; in proportion to the cloud when not given

  bool operator==(const IndexConfig&) const = default;
};

/// Which machine answers the poses, and by which method.
struct BackendConfig {
  std::string name = "auto";   ///< of a back end (Backends); auto: the best that this machine has
  std::string method;          ///< of that back end; empty: its own choice
  bool deterministic = false;  ///< bit-identical results run after run in real time; virtual time is so in any case
  std::optional<Wait> wait;    ///< for the GPU; by driver and cores when not given
  std::optional<bool> ahead;   ///< ask before the hand has moved; where the driver is known for it when not given
  bool timesPasses = false;    ///< takes the time of each pass

  bool operator==(const BackendConfig&) const = default;
};

/// What touches: a single point, or many that share the stiffness.
struct ToolConfig {
  ToolKind kind = ToolKind::point;
  std::size_t points = 16;  ///< of a pad, ball or spatula
  double size_mm = 10;      ///< diameter of a pad or ball, length of a spatula
  DVec3 axis{0, 0, -1};     ///< where the face looks while the stylus is not turned, in the model's axes

  bool operator==(const ToolConfig&) const = default;
};

/// What changes the points that are touched (BrushOptions), in mm.
struct BrushConfig {
  BrushKind kind = BrushKind::push;
  double tau_mm = 0.5, beta = 0.1, radius_mm = 6, strength = 0.5;
  std::uint32_t falloff = 1;
  std::array<std::uint8_t, 3> color{255, 0, 0};
  bool keepsDensity = true;

  bool operator==(const BrushConfig&) const = default;
};

/// How the device's millimetres meet the model's: the path (or the model, for a device in a hand) in the middle of the
/// workspace, shrunk if it is too large; or the origins together, true to scale.
enum class WorkspaceFit { fit, identity };
inline constexpr std::array<std::pair<std::string_view, WorkspaceFit>, 2> kWorkspaceFits{
    {{"fit", WorkspaceFit::fit}, {"identity", WorkspaceFit::identity}}};

/// What holds a HIP: a person at a haptic device, a script, a recording, or a model of a hand.
struct HandConfig {
  std::string device = "path";  ///< path, sim, replay:FILE, or one that a person holds (deviceChoices())
  std::string path;             ///< of path and sim: a CSV file, or builtin:NAME
  double penetration_mm = 2;    ///< how deep builtin:press goes
  WorkspaceFit fit = WorkspaceFit::fit;
  std::optional<PassivityMode> passivity;  ///< on for a device in a hand and off for a script when not given
  double stiffness_N_per_mm = 0, damping_N_s_per_mm = 0;  ///< of a simulated hand; 0: its own
  bool ownScheduler = false;  ///< palpate's servo thread calls the ticks of a device whose driver would
  bool rumbles = false;       ///< a gamepad does, at each contact

  bool operator==(const HandConfig&) const = default;
};

/// How the model moves, as a whole, as a function of the session's time; at rest's place at time 0.
struct MotionConfig {
  MotionKind kind = MotionKind::oscillate;
  DVec3 axis{0, 0, 1};         ///< along which it goes, or about which it turns, through its middle; of any length
  double amplitude_mm = 5;     ///< of oscillate: half the way from one end to the other
  double frequency_Hz = 0.5;   ///< of oscillate and turn: times to and fro, or about, in a second
  double speed_mm_per_s = 10;  ///< of drift

  bool operator==(const MotionConfig&) const = default;
};

/// A depth camera, whose newest frame is the model: recorded in the folder that ModelConfig::file names, or live.
struct StreamConfig {
  bool live = false;  ///< ModelConfig::file is a camera's device, "-": raw frames on standard input, or a topic of ROS
  double speed = 1;   ///< of a recording: its seconds in one of the session's
  bool loop = false;  ///< of a recording: after its last frame it begins again
  bool fuse = false;  ///< its frames become one map; otherwise the newest one is the cloud
  double depthScale = 0;   ///< depth values per metre; 0: as the source says
  std::string intrinsics;  ///< a JSON file; empty: as the source says

  bool operator==(const StreamConfig&) const = default;
};

/// A session that another program serves over a network, by the name that ModelConfig::file says: its points are the
/// model.
struct JoinConfig {
  std::string network;             ///< interface, by name or address; empty: this machine alone
  std::vector<std::string> peers;  ///< addresses of machines to ask, where the network carries no multicast
  std::uint32_t domain = 0;        ///< of DDS
  std::string security;            ///< a folder of keys; empty: nothing is encrypted
  bool near = false;  ///< of its points those around the hands alone come here; what moves comes so in any case

  bool operator==(const JoinConfig&) const = default;
};

/// What is taken back once the path of a session has ended.
struct UndoConfig {
  std::size_t undo = 0, redo = 0;  ///< strokes
  double memory_MiB = 1024;        ///< of strokes that can be taken back; past it the oldest are forgotten

  bool operator==(const UndoConfig&) const = default;
};

struct SessionConfig {
  /// Of the text that configText() writes.
  static constexpr int kVersion = 1;

  ModelConfig model;
  BackendConfig backend;
  IndexConfig index;
  SurfaceConfig surface;
  ToolConfig tool;
  std::optional<BrushConfig> brush;  ///< nothing: only feel
  ForceOptions force;
  UndoConfig undo;
  std::optional<MotionConfig> motion;           ///< nothing: the model stands still, unless it is a stream
  std::optional<StreamConfig> stream;           ///< nothing: the model is a cloud in a file
  std::optional<JoinConfig> join;               ///< the model is served by another program
  std::optional<MatterScene> matter;            ///< that the model is, with a tool; its file is only a name then
  std::vector<HandConfig> hands{HandConfig{}};  ///< the first one may sculpt, the others feel
  double rate_Hz = 1000;                        ///< ticks per second
  double duration_s = 0;                        ///< 0: as long as the paths
  bool realtime = false;  ///< against the wall clock; otherwise in virtual time, as fast as it goes

  bool operator==(const SessionConfig&) const = default;
  /// Whether the points move by themselves.
  bool moves() const { return motion || stream || matter; }
};

/// Throws ConfigError that names the first field which is out of its bounds, and the bounds.
void validate(const SessionConfig& config);

/// The brush and the tool in model units.
BrushOptions brushOptions(const BrushConfig& brush, const ModelScale& scale);
/// Without points for a tool of one. Throws UsageError for what makes no tool.
ToolShape toolShape(const ToolConfig& tool, const ModelScale& scale);

/// What strokes that can be taken back may take, bytes; 0 where none are.
std::uint64_t undoBytes(const UndoConfig& undo);

/// The configuration as JSON text, with its version. What is at its default is written, too, so that a default that
/// changes changes no recorded session.
std::string configText(const SessionConfig& config);
/// Reads it. Throws Error for another version, an unknown field or name, and as validate().
SessionConfig parseConfig(std::string_view text);

/// A scene of matter as JSON text in a line, and back. Throws as parseConfig().
std::string sceneText(const MatterScene& scene);
MatterScene parseScene(std::string_view text);

}  // namespace palpate
