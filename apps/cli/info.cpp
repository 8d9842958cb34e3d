#include <fmt/ranges.h>

#include "apps/cli/look.hpp"
#include "apps/cli/results.hpp"
#include "apps/cli/scene_info.hpp"
#include "apps/cli/stream_options.hpp"
#include "engine/cloud/file_coordinates.hpp"
#include "engine/cloud/length_text.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/cloud/voxel_sample.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/named_values.hpp"
#include "engine/core/units.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/rgbd_folder.hpp"
#include "engine/touch/memory.hpp"
#include "haptics/session/simulation.hpp"

namespace palpate {

namespace {

/// What is known of a file of points.
struct ModelInfo {
  std::string_view format;
  FileContents contents;
  std::vector<std::string> lost;
  std::string leftOut;
  Model model;
  Upright upright;
  HeightRange heights;
  LengthUnit unit;
  Bounds bounds, inFile;  ///< in file coordinates: inFile
  std::size_t outliers = 0;
  SpacingRange spacings;
  ModelScale scale;
  GpuMemory memory;
};

ModelInfo infoOf(const Context& context, const std::string& file, const LookOptions& look, bool keepUnreliable) {
  // Before the contents, which are not read so thoroughly: every subcommand reports the same error of a file.
  StoredCloud stored = readCloud(file, nullptr, {.keepUnreliable = keepUnreliable});
  ModelInfo info{.format = cloudFormats().toRead(file).name, .contents = contentsOf(file)};
  info.lost = std::move(stored.lost);
  info.leftOut = std::move(stored.leftOut);
  info.model = {.cloud = std::move(stored.cloud), .cameras = std::move(stored.cameras)};
  const PointCloud& cloud = info.model.cloud;
  info.model.upright = findUp(cloud);
  info.model.shown = coreBoundsOf(cloud);
  info.upright = uprightOf(info.model, look);
  info.heights = heightsOf(info.model, info.upright.up);
  info.unit = unitOf(cloud, look);
  info.bounds = boundsOf(cloud);
  info.inFile = fileBoundsOf(cloud);
  info.spacings = spacingRange(cloud, context.threads());
  info.outliers = countOutside(cloud, info.model.shownBounds());
  info.scale = scaleOf(info.model, 0);
  info.memory = predictGpuMemory(cloud.size(), cloud.hasColors());
  return info;
}

void printMemory(std::FILE* out, const GpuMemory& memory) {
  const auto mib = [](std::uint64_t bytes) { return static_cast<double>(bytes) / (1 << 20); };
  fmt::print(out,
             "  GPU memory: {:.1f} MiB = live cloud {:.1f} + index {:.1f} + contact {:.1f} + drawn cloud {:.1f} + "
             "editing {:.1f} + edit log {:.1f}\n",
             mib(memory.total()), mib(memory.liveCloud), mib(memory.index), mib(memory.contact), mib(memory.drawnCloud),
             mib(memory.editing), mib(memory.editLog));
}

void printPoints(std::FILE* out, const ModelInfo& info) {
  const PointCloud& cloud = info.model.cloud;
  const double resolution = resolutionOf(info.bounds);
  const auto corner = [&](const DVec3& place) { return coordinateText(place, isExact(cloud) ? 0 : resolution, ", "); };
  fmt::print(out, "  normals: {}   colours: {}   carried through: {} of points\n", cloud.hasNormals() ? "yes" : "no",
             cloud.hasColors() ? "yes" : "no", counted(cloud.extra.size(), "property", "properties"));
  fmt::print(out, "  bounding box: ({}) to ({})\n", corner(info.inFile.min), corner(info.inFile.max));
  const DVec3 size = info.bounds.max - info.bounds.min;
  fmt::print(out, "  size: {} x {} x {}\n", lengthText(size.x), lengthText(size.y), lengthText(size.z, info.unit));
  const Bounds shown = info.model.shownBounds();
  const auto inShown = [&](const DVec3& place) {
    return coordinateText(cloud.origin + place, resolutionOf(shown), ", ");
  };
  if (info.outliers > 0)
    fmt::print(out, "  outliers: {}, far from all others; touch scale, paths and pictures fit the rest, ({}) to ({})\n",
               counted(info.outliers, "point"), inShown(shown.min), inShown(shown.max));
  fmt::print(out, "  up: {} ({}); heights from {} to {} {}\n", nameOf(info.upright.up), info.upright.why,
             coordinateText(info.heights.low, resolution), coordinateText(info.heights.high, resolution),
             nameOf(info.unit));
  fmt::print(out, "  mean spacing: {}\n", lengthText(info.spacings.mean, info.unit));
  fmt::print(out, "  touch scale: {}\n", touchScaleText(info.scale, shown.longestSide(), info.unit));
  fmt::print(out, "  noise of the positions: {:.3f} spacings\n", info.spacings.noise);
  printMemory(out, info.memory);
}

void print(std::FILE* out, const std::string& file, const ModelInfo& info) {
  fmt::print(out, "{}: {}, {}\n", file, counted(info.model.cloud.size(), "point"), info.format);
  if (!info.contents.madeFrom.empty()) fmt::print(out, "  made from: {}\n", info.contents.madeFrom);
  for (const FileElement& element : info.contents.elements) {
    fmt::print(out, "  element {}: {}", element.name, element.count);
    for (const FileElement::Property& property : element.properties) fmt::print(out, " {}", property.name);
    fmt::print(out, "\n");
  }
  if (!info.lost.empty()) fmt::print(out, "  not kept: {}\n", fmt::join(info.lost, ", "));
  if (!info.leftOut.empty()) fmt::print(out, "  left out: {}; --keep-unreliable keeps them\n", info.leftOut);
  if (!info.model.cloud.empty()) printPoints(out, info);
}

using Value = std::optional<Json>;

Json orNull(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

constexpr Reported<ModelInfo> kModelInfo[]{
    {"points", "", "points", [](const ModelInfo& i) -> Value { return i.model.cloud.size(); }},
    {"format", "", "format of the file", [](const ModelInfo& i) -> Value { return i.format; }},
    {"made_from", "", "what the points were made from, as a mesh; else null",
     [](const ModelInfo& i) -> Value { return orNull(i.contents.madeFrom); }},
    {"elements", "", "number of each element of the file",
     [](const ModelInfo& i) -> Value {
       Json elements = Json::object();
       for (const FileElement& element : i.contents.elements) elements[element.name] = element.count;
       return elements;
     }},
    {"lost", "", "what palpate does not read", [](const ModelInfo& i) -> Value { return i.lost; }},
    {"left_out", "", "points that were left out, in words; else null",
     [](const ModelInfo& i) -> Value { return orNull(i.leftOut); }},
    {"cameras", "", "cameras that took pictures", [](const ModelInfo& i) -> Value { return i.model.cameras.size(); }},
    {"normals", "", "whether there are normals",
     [](const ModelInfo& i) -> Value { return i.model.cloud.hasNormals(); }},
    {"colors", "", "whether there are colours", [](const ModelInfo& i) -> Value { return i.model.cloud.hasColors(); }},
    {"attributes", "", "further attributes of points",
     [](const ModelInfo& i) -> Value {
       Json attributes = Json::array();
       for (const Attribute& attribute : i.model.cloud.extra) attributes.push_back(attribute.name);
       return attributes;
     }},
    {"bounds.min", "file units", "lowest corner", [](const ModelInfo& i) -> Value { return vectorJson(i.inFile.min); }},
    {"bounds.max", "file units", "highest corner",
     [](const ModelInfo& i) -> Value { return vectorJson(i.inFile.max); }},
    {"outliers", "", "points far from all others, to which touch scale, paths and pictures are not fitted",
     [](const ModelInfo& i) -> Value { return i.outliers; }},
    {"unit", "", "unit of the file; null: unknown",
     [](const ModelInfo& i) -> Value { return i.unit == LengthUnit::unknown ? Json(nullptr) : Json(nameOf(i.unit)); }},
    {"up", "", "up axis", [](const ModelInfo& i) -> Value { return nameOf(i.upright.up); }},
    {"up_reason", "", "reason for it", [](const ModelInfo& i) -> Value { return i.upright.why; }},
    {"heights", "file units", "lowest and highest point along up",
     [](const ModelInfo& i) -> Value {
       return Json{i.heights.low, i.heights.high};
     }},
    {"mean_spacing", "file units", "mean distance of neighbouring points",
     [](const ModelInfo& i) -> Value { return i.spacings.mean; }},
    {"noise_spacings", "spacings", "noise of the points", [](const ModelInfo& i) -> Value { return i.spacings.noise; }},
    {"mm_per_unit", "mm", "touch scale: millimetres in the hand per unit",
     [](const ModelInfo& i) -> Value { return i.scale.mm_per_unit; }},
    {"gpu_bytes.live_cloud", "B", "memory on the GPU: the points that are felt",
     [](const ModelInfo& i) -> Value { return i.memory.liveCloud; }},
    {"gpu_bytes.index", "B", "their index", [](const ModelInfo& i) -> Value { return i.memory.index; }},
    {"gpu_bytes.contact", "B", "contact queries", [](const ModelInfo& i) -> Value { return i.memory.contact; }},
    {"gpu_bytes.drawn_cloud", "B", "the points that are drawn",
     [](const ModelInfo& i) -> Value { return i.memory.drawnCloud; }},
    {"gpu_bytes.editing", "B", "editing", [](const ModelInfo& i) -> Value { return i.memory.editing; }},
    {"gpu_bytes.edit_log", "B", "the edit log", [](const ModelInfo& i) -> Value { return i.memory.editLog; }},
    {"gpu_bytes.total", "B", "in total", [](const ModelInfo& i) -> Value { return i.memory.total(); }},
};

void info(Context& context, const std::string& file, const LookOptions& look, bool keepUnreliable) {
  std::error_code ignored;
  if (file == "-" || std::filesystem::is_fifo(file, ignored) || std::filesystem::is_character_file(file, ignored))
    throw Error(
        "{}: a pipe can be read only once, and info reads twice; palpate convert /dev/stdin FILE.ply writes PLY "
        "from a pipe to a file",
        file);
  const ModelInfo info = infoOf(context, file, look, keepUnreliable);
  print(context.tables(), file, info);
  context.writeJson(jsonBy(kModelInfo, info));
}

constexpr Reported<RgbdFolder> kRecordingInfo[]{
    {"frames", "", "recorded frames", [](const RgbdFolder& f) -> Value { return f.frames(); }},
    {"kind", "", "kind of the recording", [](const RgbdFolder& f) -> Value { return f.kind(); }},
    {"duration_s", "s", "its duration", [](const RgbdFolder& f) -> Value { return f.duration_s(); }},
    {"poses", "", "frames with a pose", [](const RgbdFolder& f) -> Value { return f.poses(); }},
    {"colors", "", "frames with colours", [](const RgbdFolder& f) -> Value { return f.colors(); }},
    {"depth_scale", "1/m", "depth values per metre", [](const RgbdFolder& f) -> Value { return f.depthScale(); }},
    {"up", "", "up axis; null: by the shape",
     [](const RgbdFolder& f) -> Value {
       const auto up = f.up();
       return up ? Json(nameOf(*up)) : Json(nullptr);
     }},
    {"camera.width", "px", "width of a frame", [](const RgbdFolder& f) -> Value { return f.camera().width; }},
    {"camera.height", "px", "height of a frame", [](const RgbdFolder& f) -> Value { return f.camera().height; }},
    {"camera.fx", "px", "focal length along x", [](const RgbdFolder& f) -> Value { return f.camera().fx; }},
    {"camera.fy", "px", "focal length along y", [](const RgbdFolder& f) -> Value { return f.camera().fy; }},
    {"camera.cx", "px", "principal point along x", [](const RgbdFolder& f) -> Value { return f.camera().cx; }},
    {"camera.cy", "px", "principal point along y", [](const RgbdFolder& f) -> Value { return f.camera().cy; }},
};

/// For a recorded depth camera.
void infoOfFrames(Context& context, const std::string& file, const StreamOptions& options) {
  const RgbdFolder folder(file, {.intrinsics = options.stream.intrinsics, .depthScale = options.stream.depthScale},
                          &context.log());
  const DepthCamera& camera = folder.camera();
  const auto up = folder.up();
  std::FILE* out = context.tables();
  fmt::print(out, "{}: {} of a depth camera ({}), {:.6g} s\n", file, counted(folder.frames(), "frame"), folder.kind(),
             folder.duration_s());
  fmt::print(out, "  size: {} x {} pixels, focal lengths {:g} and {:g}, principal point {:g}, {:g}\n", camera.width,
             camera.height, camera.fx, camera.fy, camera.cx, camera.cy);
  fmt::print(out, "  depth: {:g} values per metre\n", folder.depthScale());
  fmt::print(out, "  poses: {} of {}   colours: {} of {}   up: {}\n", folder.poses(), folder.frames(), folder.colors(),
             folder.frames(), up ? nameOf(*up) : "by the shape");
  context.writeJson(jsonBy(kRecordingInfo, folder));
}

}  // namespace

void listInfoResults(std::vector<ResultFacts>& all) {
  listResults(all, "info", "", kModelInfo);
  listResults(all, "info FOLDER", "", kRecordingInfo);
}

void addInfo(Options& app, Context& context, Command& command) {
  Options& sub = app.addSubcommand("info", "describe a model and the GPU memory it needs; nothing is uploaded");
  auto file = std::make_shared<std::string>();
  sub.add("model", *file, modelsAndStreams(RosModels::none)).required().typeName("MODEL");
  auto look = std::make_shared<LookOptions>();
  addLookOptions(sub, *look);
  auto keepUnreliable = std::make_shared<bool>(false);
  addAllPointsOption(sub, *keepUnreliable);
  sub.heading("Depth camera");
  auto stream = std::make_shared<StreamOptions>();
  addDepthOptions(sub, *stream);
  sub.heading("Options");
  sub.whenNamed([&, file, look, keepUnreliable, stream] {
    command = [&context, file, look, keepUnreliable, stream] {
      ModelConfig model{.file = *file};
      setSource(model, *stream);
      if (model.stream)
        infoOfFrames(context, *file, *stream);
      else if (model.matter)
        infoOfScene(context, *file, model.matter);
      else
        info(context, *file, *look, *keepUnreliable);
    };
  });
}

}  // namespace palpate
