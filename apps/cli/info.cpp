#include <fmt/ranges.h>

#include "apps/cli/look.hpp"
#include "apps/cli/scene_info.hpp"
#include "apps/cli/stream_options.hpp"
#include "engine/cloud/file_coordinates.hpp"
#include "engine/cloud/length_text.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/cloud/voxel_sample.hpp"
#include "engine/core/named_values.hpp"
#include "engine/core/units.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/rgbd_folder.hpp"
#include "engine/touch/memory.hpp"
#include "haptics/session/simulation.hpp"

namespace palpate {

namespace {

double mib(std::uint64_t bytes) { return static_cast<double>(bytes) / (1 << 20); }

void info(Context& context, const std::string& file, const LookOptions& look, bool keepUnreliable) {
  std::error_code ignored;
  if (std::filesystem::is_fifo(file, ignored) || std::filesystem::is_character_file(file, ignored))
    throw Error("{}: is a pipe, which can be read only once; write it to a file first, or convert it", file);
  const FileContents contents = contentsOf(file);
  const std::string_view format = cloudFormats().toRead(file).name;
  StoredCloud stored = readCloud(file, nullptr, {.keepUnreliable = keepUnreliable});
  Model model{.cloud = std::move(stored.cloud), .cameras = std::move(stored.cameras)};
  const PointCloud& cloud = model.cloud;
  model.upright = findUp(cloud);
  model.shown = coreBoundsOf(cloud);
  const Upright upright = uprightOf(model, look);
  const HeightRange heights = heightsOf(model, upright.up);
  const LengthUnit unit = unitOf(cloud, look);
  const Bounds bounds = boundsOf(cloud);
  const SpacingRange spacings = spacingRange(cloud, context.threads());
  const double spacing = spacings.mean;
  const ModelScale scale = scaleOf(cloud, 0);
  const GpuMemory memory = predictGpuMemory(cloud.size(), cloud.hasColors());
  const Bounds inFile = fileBoundsOf(cloud);
  const double resolution = isExact(cloud) ? 0 : resolutionOf(bounds);
  const auto corner = [&](const DVec3& place) { return coordinateText(place, resolution, ", "); };

  std::FILE* out = context.tables();
  fmt::print(out, "{}: {} points, {}\n", file, cloud.size(), format);
  if (!contents.madeFrom.empty()) fmt::print(out, "  made from: {}\n", contents.madeFrom);
  Json elements = Json::object();
  for (const FileElement& element : contents.elements) {
    elements[element.name] = element.count;
    fmt::print(out, "  element {}: {}", element.name, element.count);
    for (const FileElement::Property& property : element.properties) fmt::print(out, " {}", property.name);
    fmt::print(out, "\n");
  }
  if (!stored.lost.empty()) fmt::print(out, "  not kept: {}\n", fmt::join(stored.lost, ", "));
  if (!stored.leftOut.empty()) fmt::print(out, "  left out: {}; --keep-unreliable keeps them\n", stored.leftOut);
  if (!cloud.empty()) {
    fmt::print(out, "  normals: {}   colours: {}   carried through: {} properties of points\n",
               cloud.hasNormals() ? "yes" : "no", cloud.hasColors() ? "yes" : "no", cloud.extra.size());
    fmt::print(out, "  bounding box: ({}) to ({})\n", corner(inFile.min), corner(inFile.max));
    const DVec3 size = bounds.max - bounds.min;
    fmt::print(out, "  size: {} x {} x {}\n", lengthText(size.x), lengthText(size.y), lengthText(size.z, unit));
    fmt::print(out, "  up: {} ({}); heights from {} to {} {}\n", nameOf(upright.up), upright.why,
               coordinateText(heights.low, resolutionOf(bounds)), coordinateText(heights.high, resolutionOf(bounds)),
               nameOf(unit));
    fmt::print(out, "  mean spacing: {}\n", lengthText(spacing, unit));
    fmt::print(out, "  touch scale: {}\n", touchScaleText(scale, bounds.longestSide(), unit));
    fmt::print(out, "  noise of the positions: {:.3f} spacings\n", spacings.noise);
    fmt::print(
        out,
        "  GPU memory: {:.1f} MiB = live cloud {:.1f} + index {:.1f} + contact {:.1f} + drawn cloud {:.1f} + editing "
        "{:.1f} + edit log {:.1f}\n",
        mib(memory.total()), mib(memory.liveCloud), mib(memory.index), mib(memory.contact), mib(memory.drawnCloud),
        mib(memory.editing), mib(memory.editLog));
  }
  Json attributes = Json::array();
  for (const Attribute& attribute : cloud.extra) attributes.push_back(attribute.name);
  context.writeJson({{"points", cloud.size()},
                     {"format", format},
                     {"made_from", contents.madeFrom.empty() ? Json(nullptr) : Json(contents.madeFrom)},
                     {"elements", elements},
                     {"lost", stored.lost},
                     {"left_out", stored.leftOut.empty() ? Json(nullptr) : Json(stored.leftOut)},
                     {"cameras", model.cameras.size()},
                     {"normals", cloud.hasNormals()},
                     {"colors", cloud.hasColors()},
                     {"attributes", attributes},
                     {"bounds", {{"min", vectorJson(inFile.min)}, {"max", vectorJson(inFile.max)}}},
                     {"unit", unit == LengthUnit::unknown ? Json(nullptr) : Json(nameOf(unit))},
                     {"up", nameOf(upright.up)},
                     {"up_reason", upright.why},
                     {"heights", {heights.low, heights.high}},
                     {"mean_spacing", spacing},
                     {"noise_spacings", spacings.noise},
                     {"mm_per_unit", scale.mm_per_unit},
                     {"gpu_bytes",
                      {{"live_cloud", memory.liveCloud},
                       {"index", memory.index},
                       {"contact", memory.contact},
                       {"drawn_cloud", memory.drawnCloud},
                       {"editing", memory.editing},
                       {"edit_log", memory.editLog},
                       {"total", memory.total()}}}});
}

/// For a recorded depth camera.
void infoOfFrames(Context& context, const std::string& file, const StreamOptions& options) {
  const RgbdFolder folder(file, {.intrinsics = options.stream.intrinsics, .depthScale = options.stream.depthScale},
                          &context.log());
  const DepthCamera& camera = folder.camera();
  const auto up = folder.up();
  std::FILE* out = context.tables();
  fmt::print(out, "{}: {} frames of a depth camera ({}), {:.6g} s\n", file, folder.frames(), folder.kind(),
             folder.duration_s());
  fmt::print(out, "  size: {} x {} pixels, focal lengths {:g} and {:g}, middle {:g}, {:g}\n", camera.width,
             camera.height, camera.fx, camera.fy, camera.cx, camera.cy);
  fmt::print(out, "  depth: {:g} values per metre\n", folder.depthScale());
  fmt::print(out, "  poses: {} of {}   colours: {} of {}   up: {}\n", folder.poses(), folder.frames(), folder.colors(),
             folder.frames(), up ? nameOf(*up) : "by the shape");
  context.writeJson({{"frames", folder.frames()},
                     {"kind", folder.kind()},
                     {"duration_s", folder.duration_s()},
                     {"poses", folder.poses()},
                     {"colors", folder.colors()},
                     {"depth_scale", folder.depthScale()},
                     {"up", up ? Json(nameOf(*up)) : Json(nullptr)},
                     {"camera",
                      {{"width", camera.width},
                       {"height", camera.height},
                       {"fx", camera.fx},
                       {"fy", camera.fy},
                       {"cx", camera.cx},
                       {"cy", camera.cy}}}});
}

}  // namespace

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
      if (streamConfig(*stream, *file))
        infoOfFrames(context, *file, *stream);
      else if (const SceneRef scene = sceneNamed(*file))
        infoOfScene(context, *file, scene);
      else
        info(context, *file, *look, *keepUnreliable);
    };
  });
}

}  // namespace palpate
