// Configuration of a session: one typed, nested value, which every program fills and a session log carries.
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
#include "engine/core/index_options.hpp"
#include "engine/core/setting.hpp"
#include "engine/core/tool_shape.hpp"
#include "engine/core/vec.hpp"
#include "engine/motion/rigid_motion.hpp"
#include "engine/select/preparation.hpp"
#include "haptics/force_law.hpp"
#include "haptics/passivity.hpp"
#include "haptics/session/simulated_scene.hpp"

namespace palpate {

/// Source of a model's normals: the file, else estimated; always estimated from the points; the faces;
/// those of the file, with signs that agree among neighbours; or those of the file, negated.
enum class NormalSource { keep, estimate, face, orient, flip };
inline constexpr std::array<std::pair<std::string_view, NormalSource>, 5> kNormalSources{
    {{"keep", NormalSource::keep},
     {"estimate", NormalSource::estimate},
     {"face", NormalSource::face},
     {"orient", NormalSource::orient},
     {"flip", NormalSource::flip}}};

/// A depth camera, whose newest frame is the model: recorded in the folder that ModelConfig::file names, or live.
struct StreamConfig {
  bool live = false;  ///< ModelConfig::file is a camera's device, "-" (raw frames on standard input), or a topic of ROS
  double speed = 1;   ///< of a recording: its seconds per second of the session
  bool loop = false;  ///< of a recording: restarts after its last frame
  bool fuse = false;  ///< fuses its frames into one map; otherwise the newest one is the cloud
  double depthScale = 0;   ///< depth values per metre; 0: as the source says
  std::string intrinsics;  ///< a JSON file; empty: as the source says

  bool operator==(const StreamConfig&) const = default;
};

/// A session that another program serves over a network, under the name in ModelConfig::file: its points are the model.
struct JoinConfig {
  std::string network;             ///< interface, by name or address; empty: this machine alone
  std::vector<std::string> peers;  ///< addresses of machines to ask, if the network has no multicast
  std::uint32_t domain = 0;        ///< of DDS
  std::string security;            ///< a folder of keys; empty: nothing is encrypted
  bool partial = false;            ///< fetches only the points around the hands; always so for a moving model

  bool operator==(const JoinConfig&) const = default;
};

/// Which model a session has, and how it is read: a cloud in a file, unless one of the last three members is set.
struct ModelConfig {
  std::string file;        ///< of the cloud; otherwise the folder, device, topic, session or scene that is the model
  double mm_per_unit = 0;  ///< millimetres per model unit; 0: as the file says, or the longest side becomes 100 mm
  NormalSource normals = NormalSource::keep;
  bool keepUnreliable = false;  ///< reads also the points that a reconstruction's own measures mark as unreliable
  std::optional<Preparation> prepare;  ///< of a cloud in a file, before anything is measured
  std::optional<StreamConfig> stream;
  std::optional<JoinConfig> join;
  SceneRef matter;

  bool operator==(const ModelConfig&) const = default;
};

/// The surface that the points define, and how it feels.
struct SurfaceConfig {
  SurfaceKind kind = SurfaceKind::average;
  double friction = 0;  ///< coefficient for a sliding proxy, 0 to bounds::kMaxFriction
  /// Support radius, mm; empty: four spacings, more if points are noisy, local if spacings differ.
  std::optional<double> radius_mm;

  bool operator==(const SurfaceConfig&) const = default;
};

/// Layout and update of the index.
struct IndexConfig {
  IndexFollow follow = IndexFollow::incremental;
  BucketKey bucketKey = BucketKey::teschner;
  double cell_mm = 0;  ///< edge of a cell; 0: the support radius

  bool operator==(const IndexConfig&) const = default;
};

/// The machine that answers the poses, and its method.
struct BackendConfig {
  std::string name = "auto";   ///< of a back end (Backends); auto: the best of this machine
  std::string method;          ///< of that back end; empty: its default
  bool deterministic = false;  ///< bit-identical results in each run in real time; virtual time always has them
  std::optional<bool> ahead;   ///< ask before the hand has moved; empty: on drivers known to allow it
  bool timesPasses = false;    ///< measures the time of each pass

  bool operator==(const BackendConfig&) const = default;
};

/// The tool: a single point, or many that share the stiffness.
struct ToolConfig {
  ToolKind kind = ToolKind::point;
  std::size_t points = 16;  ///< of a pad, ball or spatula
  double size_mm = 10;      ///< diameter of a pad or ball, length of a spatula
  DVec3 axis{0, 0, -1};     ///< direction of the face while the stylus is not rotated, in the model's axes

  bool operator==(const ToolConfig&) const = default;
};

/// The brush, which changes the touched points (BrushOptions), in mm.
struct BrushConfig {
  BrushKind kind = BrushKind::push;
  double yieldDepth_mm = 0.5, pushRate = 0.1, radius_mm = 6, strength = 0.5;
  std::uint32_t falloff = 1;
  std::array<std::uint8_t, 3> color{255, 0, 0};
  bool resample = true, accumulate = false;
  std::string symmetry;  ///< "x", "y", "z" or "PX,PY,PZ,NX,NY,NZ" (symmetryPlane()); empty: none

  bool operator==(const BrushConfig&) const = default;
};

/// How the device's workspace is mapped to the model: the path (or the model, for a held device) is centred in the
/// workspace and shrunk if it is too large; or the origins coincide, at true scale.
enum class WorkspaceFit { fit, identity };
inline constexpr std::array<std::pair<std::string_view, WorkspaceFit>, 2> kWorkspaceFits{
    {{"fit", WorkspaceFit::fit}, {"identity", WorkspaceFit::identity}}};

/// Moves a HIP: a haptic device in a person's hand, a script, a recording, or a simulated hand.
struct HandConfig {
  std::string device = "path";  ///< path, sim, replay:FILE, or a held device (heldDevicesHelp())
  std::string path;             ///< of path and sim: a CSV file, or builtin:NAME
  double penetration_mm = 2;    ///< depth of builtin:press
  WorkspaceFit fit = WorkspaceFit::fit;
  std::optional<PassivityMode> passivity;                 ///< empty: on for a held device, off for a script
  double stiffness_N_per_mm = 0, damping_N_s_per_mm = 0;  ///< of a simulated hand; 0: its default
  bool ownScheduler = false;  ///< palpate's servo thread runs the ticks, not the device's driver
  bool rumbles = false;       ///< a gamepad rumbles at each contact
  std::string axes;  ///< of a held device, that point right, up and towards the user: "x,z,-y"; empty: as remembered

  bool operator==(const HandConfig&) const = default;
};

/// Rigid motion of the model as a function of the session's time; at time 0 it is in its rest position.
struct MotionConfig {
  MotionKind kind = MotionKind::oscillate;
  DVec3 axis{0, 0, 1};         ///< of translation, or of rotation, through the middle; of any length
  double amplitude_mm = 5;     ///< of oscillate: half the distance between both ends
  double frequency_Hz = 0.5;   ///< of oscillate and turn: cycles, or rotations, per second
  double speed_mm_per_s = 10;  ///< of drift

  bool operator==(const MotionConfig&) const = default;
};

/// Strokes to undo and redo once the path of a session has ended.
struct UndoConfig {
  std::size_t undo = 0, redo = 0;  ///< strokes
  double memory_MiB = 1024;        ///< for strokes that can be undone; beyond it the oldest are dropped

  bool operator==(const UndoConfig&) const = default;
};

struct SessionConfig {
  /// Version of the text that configText() writes.
  static constexpr int kVersion = 1;

  ModelConfig model;
  BackendConfig backend;
  IndexConfig index;
  SurfaceConfig surface;
  ToolConfig tool;
  std::optional<BrushConfig> brush;  ///< empty: no edits
  ForceOptions force;
  UndoConfig undo;
  std::optional<MotionConfig> motion;           ///< empty: the model stands still, unless it is a stream
  std::vector<HandConfig> hands{HandConfig{}};  ///< the first one may sculpt, the others feel
  double rate_Hz = 1000;                        ///< ticks per second
  double duration_s = 0;                        ///< 0: as long as the paths
  bool realtime = false;  ///< against the wall clock; otherwise in virtual time, as fast as possible

  bool operator==(const SessionConfig&) const = default;
  /// Whether the points move without a hand.
  bool moves() const { return motion || model.stream || bool(model.matter); }
};

/// Throws ConfigError that names the first field out of bounds, and the bounds.
void validate(const SessionConfig& config);
void validate(const Preparation& preparation);

/// A plane of symmetry as text: an axis means the plane across it through `middle`; otherwise a position and a normal
/// of any length, six numbers in file coordinates. Both results are in file coordinates. Throws ConfigError.
struct SymmetryPlane {
  DVec3 place{0}, normal{1, 0, 0};
};
SymmetryPlane symmetryPlane(std::string_view text, const DVec3& middle);
/// The brush, without its symmetry, and the tool in model units.
BrushOptions brushOptions(const BrushConfig& brush, const ModelScale& scale);
/// Without points for a tool of one point. Throws UsageError for an invalid tool.
ToolShape toolShape(const ToolConfig& tool, const ModelScale& scale);

/// Memory for strokes that can be undone, bytes; 0 if none are.
std::uint64_t undoBytes(const UndoConfig& undo);

/// The configuration as JSON text, with its version. Defaults are written, too, so that a changed default changes no
/// recorded session.
std::string configText(const SessionConfig& config);
/// Reads it. Throws Error for another version, an unknown field or name, and as validate().
SessionConfig parseConfig(std::string_view text);
/// The section `prepare` alone, of which any settings may be left out. Throws as parseConfig().
Preparation parsePreparation(std::string_view text);

}  // namespace palpate
