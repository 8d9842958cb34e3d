#include "haptics/session/settings.hpp"

#include "haptics/session/bounds.hpp"
#include "haptics/session/setting_facts.hpp"
#include "haptics/session/simulation.hpp"

namespace palpate {

namespace {

constexpr std::array<std::pair<std::string_view, bool>, 2> kOnOff{{{"on", true}, {"off", false}}};
constexpr Range kLength{bounds::kShortest_mm, bounds::kLongest_mm};
constexpr Range kLengthOrZero{.min = bounds::kShortest_mm, .max = bounds::kLongest_mm, .orZero = true};

// Columns: JSON key, member, option of the command line, help, unit, bounds.

constexpr Setting<ModelConfig> kModel[]{
    {"file", &ModelConfig::file, "", "file, folder, scene, topic or session that is the model"},
    {"mm_per_unit",
     &ModelConfig::mm_per_unit,
     "--mm-per-unit",
     "touch scale: millimetres in the hand per model unit (default: the comment mm_per_unit of the "
     "file, or the longest side becomes 100 mm)",
     "mm",
     {.min = bounds::kMinScale, .max = bounds::kMaxScale, .orZero = true}},
    {"normals", words<&ModelConfig::normals, kNormalSources>(), "--normals",
     "keep: use the normals of the file, estimate missing ones; estimate: always estimate from the "
     "points; face: from the faces; orient: those of the file, flipped so that neighbours agree; flip: those of the "
     "file, all flipped"},
    {"keep_unreliable", &ModelConfig::keepUnreliable, "--keep-unreliable",
     "COLMAP: also keep unreliable points (rays at less than 1.5 degrees, errors above 4 pixels, "
     "fewer than three images)"},
};

constexpr Setting<Preparation> kPreparation[]{
    {"crop", &Preparation::crop, "--crop",
     "keep the points in a box, given by two corners in file coordinates: 0,0,0:1.5,2,1"},
    {"crop_outside", &Preparation::cropOutside, "--crop-outside", "keep the points outside a box"},
    {"where", &Preparation::where, "--where",
     "keep the points for which an expression of their fields holds, as in \"classification == 2 && z > 3\""},
    {"drop_duplicates", &Preparation::dropDuplicates, "--drop-duplicates",
     "keep one point of those with exactly the same coordinates: the first"},
    {"outlier_neighbours",
     &Preparation::outlierNeighbours,
     "--outliers",
     "drop statistical outliers: points whose mean distance to their K nearest neighbours is more than SIGMA standard "
     "deviations above the mean of all points (default: 8,1)",
     "",
     {.min = 1, .max = bounds::kMaxNeighbours, .orZero = true}},
    {"outlier_sigma", &Preparation::outlierSigma, "", "standard deviations of --outliers", "", {0, 100}},
    {"radius_neighbours",
     &Preparation::radiusNeighbours,
     "--radius-outliers",
     "drop the points with fewer than N other points nearer than a length; mm",
     "",
     {.min = 1, .max = bounds::kMaxNeighbours, .orZero = true}},
    {"radius_mm", &Preparation::radius_mm, "", "length of --radius-outliers, mm", "mm", kLength},
    {"fill_holes_mm", &Preparation::fillHoles_mm, "--fill-holes",
     "close the holes of the surface up to a width, such as round ones of this diameter, with new points at the "
     "spacing of those around; mm",
     "mm", kLengthOrZero},
    {"subsample_mm", &Preparation::subsample_mm, "--subsample",
     "keep one point in each cell of a grid: the one nearest to its middle; side of a cell, mm", "mm", kLengthOrZero},
    {"random",
     &Preparation::random,
     "--random",
     "keep this many points, drawn at random; 0: all",
     "",
     {0, bounds::kMaxCount}},
    {"seed", &Preparation::seed, "--seed", "seed of --random", "", {0, bounds::kMaxCount}},
    {"set", &Preparation::set, "--set",
     "set a field: [TYPE] NAME = NUMBER [if CONDITION], as in \"classification = 6 if z > 3\"; may be repeated"},
    {"upright", words<&Preparation::upright, kUpAxes>(), "--upright",
     "rotate the model by a quarter or half turn so that this axis becomes z, which is up"},
    {"level", &Preparation::level, "--level",
     "rotate the model so that its ground, found by shape, is level and z is up"},
};

constexpr Setting<BackendConfig> kBackend[]{
    {"name", &BackendConfig::name, "--backend",
     "back end: vulkan (a GPU), cpu (double precision), cuda (for comparison, where built in), or "
     "auto (vulkan where there is a GPU other than a software driver, else cpu; with --realtime the one of both that "
     "answers sooner, which is measured for up to two seconds and remembered)"},
    {"method", &BackendConfig::method, "--method",
     "neighbour search on the GPU: fused (default; search, surface and proxy in one dispatch), "
     "indirect (one indirect dispatch for the occupied buckets), naive (one per bucket), two-step "
     "(counts first, dispatched by the host), or brute (every point)"},
    {"deterministic", &BackendConfig::deterministic, "--deterministic",
     "bit-identical results in every run (always so in virtual time)"},
    {"ahead", words<&BackendConfig::ahead, kOnOff>(), "--ahead",
     "submit each query before its pose is known, so that the GPU only waits for the pose; in real time while a hand "
     "moves or is near a surface: auto "
     "(on for drivers known to allow it), on or off"},
    {"times_passes", &BackendConfig::timesPasses, "--print-tick",
     "list the GPU passes of a tick with threads, bytes and GPU time, us"},
};

constexpr Setting<IndexConfig> kIndex[]{
    {"follow", words<&IndexConfig::follow, kIndexFollows>(), "--index",
     "how the index follows an edit: incremental (cost of the touched points; rebuilt when a "
     "sixteenth of all is touched), or rebuild (always so on cuda)"},
    {"bucket_key", words<&IndexConfig::bucketKey, kBucketKeys>(), "--bucket-key",
     "hash key: teschner scatters the cells, morton keeps neighbouring cells together in memory"},
    {"cell_mm", &IndexConfig::cell_mm, "--cell", "edge of a hash cell, mm (default: the support radius)", "mm",
     kLengthOrZero},
};

constexpr Setting<SurfaceConfig> kSurface[]{
    {"kind", words<&SurfaceConfig::kind, kSurfaceKinds>(), "--surface",
     "implicit surface: average (default; weighted position and normal), sphere (algebraic sphere "
     "through positions and normals), or sharp (keeps edges, three times the cost); cuda has "
     "average only"},
    {"friction",
     &SurfaceConfig::friction,
     "--friction",
     "Coulomb friction coefficient of the proxy; 0: frictionless",
     "",
     {0, bounds::kMaxFriction},
     {0, 2}},
    {"radius_mm", &SurfaceConfig::radius_mm, "--radius",
     "support radius of the surface, mm, or auto (4 local spacings; up to 8 on flat parts of "
     "noisy clouds)",
     "mm", kLength},
};

constexpr Setting<ToolConfig> kTool[]{
    {"kind", words<&ToolConfig::kind, kToolKinds>(), "--tool",
     "tool: point, or many contact points that share the stiffness: pad (a fingertip), ball, or "
     "spatula; vulkan with the method fused, or cpu"},
    {"points",
     &ToolConfig::points,
     "--tool-points",
     "contact points of a pad, ball or spatula",
     "",
     {1, static_cast<double>(kMaxToolPoints)}},
    {"size_mm", &ToolConfig::size_mm, "--tool-size", "diameter of a pad or ball, length of a spatula, mm", "mm",
     kLength},
    {"axis", &ToolConfig::axis, "--tool-axis",
     "direction of the face of a pad or spatula while the stylus is not rotated, model "
     "axes (default 0,0,-1)"},
};

constexpr Setting<BrushConfig> kBrush[]{
    {"kind", words<&BrushConfig::kind, kBrushKinds>(), "--edit",
     "the brush; cuda has push only, a soft body neither carve nor paint"},
    {"yield_depth_mm",
     &BrushConfig::yieldDepth_mm,
     "--yield-depth",
     "depth of the HIP behind the proxy from which the surface yields, mm",
     "mm",
     {0, bounds::kLongest_mm},
     {0, 5}},
    {"push_rate",
     &BrushConfig::pushRate,
     "--push-rate",
     "push: fraction of the distance to the tool that a point moves per tick",
     "",
     {0, 1},
     {0, 1}},
    {"radius_mm", &BrushConfig::radius_mm, "--brush-radius", "radius of the brush, mm", "mm", kLength, {0.5, 30}},
    {"strength",
     &BrushConfig::strength,
     "--strength",
     "all brushes but push: fraction of their effect per tick",
     "",
     {0, 1},
     {0, 1}},
    {"falloff",
     &BrushConfig::falloff,
     "--falloff",
     "all brushes but push and carve: exponent F of the falloff (1 - r^2)^F, where r is 1 at the rim",
     "",
     {0, kMaxFalloff}},
    {"color", &BrushConfig::color, "--paint-color", "paint: R,G,B, 0 to 255 each"},
    {"resample",
     &BrushConfig::resample,
     "--no-resample",
     "do not insert points where the surface is stretched, nor merge them where it is crowded "
     "(always so with --join)",
     "",
     {},
     {},
     true},
    {"accumulate", &BrushConfig::accumulate, "--accumulate",
     "inflate: raise points on where a stroke passes over them again, or rests; else a stroke raises them once, by as "
     "much as the hand presses"},
    {"symmetry", &BrushConfig::symmetry, "--symmetry",
     "also make each edit mirrored: x, y or z, at the plane across that axis through the middle of the model, or a "
     "position on the plane and its normal, PX,PY,PZ,NX,NY,NZ in file coordinates (default: not mirrored)"},
};

constexpr Setting<ForceOptions> kForce[]{
    {"stiffness_N_per_mm",
     &ForceOptions::stiffness_N_per_mm,
     "--stiffness",
     "stiffness of the contact spring, N/mm",
     "N/mm",
     {0, bounds::kMaxStiffness_N_per_mm},
     {0, 5}},
    {"damping_N_s_per_mm",
     &ForceOptions::damping_N_s_per_mm,
     "--damping",
     "damping of the contact spring, N s/mm",
     "N s/mm",
     {0, bounds::kMaxDamping_N_s_per_mm},
     {0, 0.02}},
    {"max_N",
     &ForceOptions::maxForce_N,
     "--max-force",
     "largest force, N; changes of force are limited to 600 N/s in any case",
     "N",
     {0, bounds::kMaxForce_N},
     {0, kTouchPeakForce_N}},
    {"hand_gain",
     &ForceOptions::handGain,
     "--hand-gain",
     "motion of the stylus for a motion of the hand, of a held or simulated device: 0.25 for fine work",
     "",
     {kMinHandGain, kMaxHandGain},
     {0.1, 1}},
    {"max_rise_N_per_s",
     &ForceOptions::maxRise_N_per_s,
     "",
     "fastest change of force, N/s; null: unlimited",
     "N/s",
     {.min = 0, .excludesMin = true}},
    {"max_surface_power_W",
     &ForceOptions::maxSurfacePower_W,
     "--max-surface-power",
     "largest power that a moving surface may put into the hand, W",
     "W",
     {.min = 0, .max = bounds::kMaxSurfacePower_W, .excludesMin = true}},
};

constexpr Setting<UndoConfig> kUndo[]{
    {"undo",
     &UndoConfig::undo,
     "--undo",
     "undo the last N strokes after the path; a stroke is one contact, gaps up to 0.3 s included",
     "",
     {0, bounds::kMaxCount}},
    {"redo", &UndoConfig::redo, "--redo", "then redo M of them", "", {0, bounds::kMaxCount}},
    {"memory_MiB",
     &UndoConfig::memory_MiB,
     "--undo-memory",
     "memory for strokes that can be undone, MiB; the oldest are dropped first",
     "MiB",
     {bounds::kMinMemory_MiB, bounds::kMaxMemory_MiB}},
};

constexpr Setting<MotionConfig> kMotion[]{
    {"kind", words<&MotionConfig::kind, kMotionKinds>(), "--motion",
     "rigid motion of the model: none, oscillate or drift along --motion-axis, or turn about it; a "
     "moving model cannot be sculpted (vulkan, cpu)"},
    {"axis", &MotionConfig::axis, "--motion-axis", "axis X,Y,Z in the axes of the model, of any length"},
    {"amplitude_mm",
     &MotionConfig::amplitude_mm,
     "--motion-amplitude",
     "oscillate: amplitude, mm",
     "mm",
     {0, bounds::kLongest_mm}},
    {"frequency_Hz",
     &MotionConfig::frequency_Hz,
     "--motion-frequency",
     "oscillate, turn: frequency, Hz",
     "Hz",
     {0, bounds::kMaxRate_Hz}},
    {"speed_mm_per_s",
     &MotionConfig::speed_mm_per_s,
     "--motion-speed",
     "drift: speed, mm/s",
     "mm/s",
     {0, bounds::kLongest_mm}},
};

constexpr Setting<StreamConfig> kStream[]{
    {"live", &StreamConfig::live, "--live",
     "live depth camera in place of MODEL: a V4L2 device with the format Z16, ros:TOPIC "
     "(PointCloud2, or depth Image with camera_info), or - for raw frames on standard input: a line of JSON with "
     "width, height, fx, fy, cx, cy, depth_scale and format (z16), then for each frame the line 'frame TIME_S' and its "
     "depths, little-endian"},
    {"speed",
     &StreamConfig::speed,
     "--speed",
     "playback speed of a recording; 1: as recorded",
     "",
     {bounds::kMinSpeed, bounds::kMaxSpeed}},
    {"loop", &StreamConfig::loop, "--loop", "restart a recording after its last frame"},
    {"fuse", &StreamConfig::fuse, "--fuse",
     "on: fuse the frames into one map that is felt while it grows; off: feel the newest frame "
     "only"},
    {"depth_scale",
     &StreamConfig::depthScale,
     "--depth-scale",
     "depth values per metre (default: from the intrinsics, else 5000 for TUM, 6553.5 for Replica and "
     "1000 for others)",
     "1/m",
     {.min = bounds::kMinDepthScale, .max = bounds::kMaxDepthScale, .orZero = true}},
    {"intrinsics", &StreamConfig::intrinsics, "--intrinsics",
     "intrinsics of the depth camera as JSON: width, height, fx, fy, cx, cy (pixels) or Open3D's "
     "intrinsic_matrix, and optionally depth_scale (default: those of the folder, or 640 x 480, "
     "525, 525, 319.5, 239.5)"},
};

constexpr Setting<JoinConfig> kJoin[]{
    {"network", &JoinConfig::network, "--interface",
     "network interface, by name or address (default: this machine only)"},
    {"peers", &JoinConfig::peers, "--peer",
     "address of another machine, for networks without multicast; may be repeated"},
    {"domain", &JoinConfig::domain, "--domain", "DDS domain, as in ROS 2", "", {0, bounds::kLastDomain}},
    {"security", &JoinConfig::security, "--security",
     "folder of keys (see palpate keys): encrypts everything; only holders of keys of the same "
     "authority can join"},
    {"partial", &JoinConfig::partial, "--partial",
     "stream only the points around the hand, for models too large to download; they can be "
     "sculpted, and a file saved here has only the known ones. Moving models are always joined "
     "so, and cannot be sculpted"},
};

constexpr Setting<HandConfig> kHand[]{
    {"device", &HandConfig::device, "--device",
     "source of the poses: path (a script, not moved by forces), sim (a simulated Geomagic Touch in a compliant "
     "hand), replay:FILE (a session log, trace or trajectory), or a device, with --realtime and --duration"},
    {"path", &HandConfig::path, "--path",
     "CSV with the header t_s,x,y,z (s, model units), or builtin:press, builtin:slide, "
     "builtin:scan, builtin:orbit; in water or sand builtin:press and builtin:stir"},
    {"penetration_mm", &HandConfig::penetration_mm, "--penetration", "depth of builtin:press, mm", "mm", kLength},
    {"fit", words<&HandConfig::fit, kWorkspaceFits>(), "--map",
     "fit: scale and centre the path (or the model, for a held device) into the workspace; "
     "identity: one to one, origins together"},
    {"passivity", words<&HandConfig::passivity, kPassivityModes>(), "--passivity",
     "if the surface returns more energy than it received: on (brake), observe (only count) or off "
     "(default: on for a device or sim, off for a path)"},
    {"stiffness_N_per_mm",
     &HandConfig::stiffness_N_per_mm,
     "--hand-stiffness",
     "sim: stiffness of the hand, N/mm (default 0.4)",
     "N/mm",
     {.min = bounds::kMinStiffness_N_per_mm, .max = bounds::kMaxStiffness_N_per_mm, .orZero = true}},
    {"damping_N_s_per_mm",
     &HandConfig::damping_N_s_per_mm,
     "--hand-damping",
     "sim: damping of the hand, N s/mm (default 0.002)",
     "N s/mm",
     {.min = bounds::kMinDamping_N_s_per_mm, .max = bounds::kMaxDamping_N_s_per_mm, .orZero = true}},
    {"own_scheduler", &HandConfig::ownScheduler, "--scheduler",
     "thread that runs the ticks of an OpenHaptics device: device (the driver) or own (palpate)"},
    {"rumbles", &HandConfig::rumbles, "--rumble",
     "a DualSense that is connected by cable rumbles at each contact, with any --device"},
    {"axes", &HandConfig::axes, "--axes",
     "axes of the device that point right, up and towards the user, as in x,z,-y (default: as remembered for it, "
     "else x,y,z)"},
};

constexpr Setting<SessionConfig> kSession[]{
    {"rate_Hz", &SessionConfig::rate_Hz, "--rate", "ticks per second", "Hz", {1, bounds::kMaxRate_Hz}},
    {"duration_s",
     &SessionConfig::duration_s,
     "--duration",
     "duration of the session, s (default: that of the path)",
     "s",
     {.min = bounds::kShortest_s, .max = bounds::kLongest_s, .orZero = true}},
    {"realtime", &SessionConfig::realtime, "--realtime",
     "run against the wall clock (default: virtual time, as fast as possible)"},
};

// The option that adds a hand after the first, with its device and path. It has its other settings from the first.
constexpr std::string_view kFurtherHand = "--hand";

}  // namespace

std::span<const Setting<ModelConfig>> settingsOf(const ModelConfig*) { return kModel; }
std::span<const Setting<Preparation>> settingsOf(const Preparation*) { return kPreparation; }
std::span<const Setting<BackendConfig>> settingsOf(const BackendConfig*) { return kBackend; }
std::span<const Setting<IndexConfig>> settingsOf(const IndexConfig*) { return kIndex; }
std::span<const Setting<SurfaceConfig>> settingsOf(const SurfaceConfig*) { return kSurface; }
std::span<const Setting<ToolConfig>> settingsOf(const ToolConfig*) { return kTool; }
std::span<const Setting<BrushConfig>> settingsOf(const BrushConfig*) { return kBrush; }
std::span<const Setting<ForceOptions>> settingsOf(const ForceOptions*) { return kForce; }
std::span<const Setting<UndoConfig>> settingsOf(const UndoConfig*) { return kUndo; }
std::span<const Setting<MotionConfig>> settingsOf(const MotionConfig*) { return kMotion; }
std::span<const Setting<StreamConfig>> settingsOf(const StreamConfig*) { return kStream; }
std::span<const Setting<JoinConfig>> settingsOf(const JoinConfig*) { return kJoin; }
std::span<const Setting<HandConfig>> settingsOf(const HandConfig*) { return kHand; }
std::span<const Setting<SessionConfig>> settingsOf(const SessionConfig*) { return kSession; }

namespace {

struct Listing {
  std::vector<SettingFacts> all;

  template <class Section>
  void operator()(std::string_view path, const Section& usual, Presence = Presence::always) {
    for (const Setting<Section>& setting : settingsOf<Section>()) all.push_back(factsOf(path, setting, usual));
  }
  template <class Section>
  void operator()(std::string_view path, const std::optional<Section>&, Presence) {
    (*this)(path, Section{});
  }
};

}  // namespace

std::vector<SettingFacts> allSettings() {
  const SessionConfig usual;
  Listing listing;
  visitSections(usual, listing);
  for (const SceneSettingFacts& each : sceneSettingFacts()) listing.all.push_back(each);
  listing("hands", HandConfig{});
  listing("", usual);
  return std::move(listing.all);
}

std::string flagOf(std::string_view path) {
  std::string name(path);
  const bool isFurther = name.starts_with("hands[") && !name.starts_with("hands[0]");
  if (const std::size_t open = name.find('['), close = name.find(']'); close != name.npos && open < close)
    name.erase(open, close + 1 - open);
  if (name == "hands" || (isFurther && (name == "hands.device" || name == "hands.path")))
    return std::string(kFurtherHand);
  for (const SettingFacts& setting : allSettings())
    if (setting.path == name) return setting.flag;
  return {};
}

}  // namespace palpate
