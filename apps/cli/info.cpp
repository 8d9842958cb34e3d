#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "apps/cli/look.hpp"
#include "apps/cli/model.hpp"
#include "apps/cli/results.hpp"
#include "apps/cli/scene_info.hpp"
#include "apps/cli/stream_options.hpp"
#include "engine/cloud/file_coordinates.hpp"
#include "engine/cloud/length_text.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/cloud/voxel_sample.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/named_values.hpp"
#include "engine/core/shown_names.hpp"
#include "engine/core/units.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/rgbd_folder.hpp"
#include "engine/select/expression.hpp"
#include "engine/select/field_statistics.hpp"
#include "engine/select/prepared_cloud.hpp"
#include "engine/touch/memory.hpp"
#include "haptics/session/simulation.hpp"

namespace palpate {

namespace {

/// What is known of a file of points.
struct ModelInfo {
  std::string_view format;
  FileContents contents;
  std::vector<std::string> lost;
  std::string assumed, leftOut;
  Model model;
  Upright upright;
  HeightRange heights;
  LengthUnit unit;
  Bounds bounds, inFile;  ///< in file coordinates: inFile
  std::size_t outliers = 0;
  SpacingRange spacings;
  ModelScale scale;
  GpuMemory memory;
  std::vector<std::pair<std::string, FieldStatistics>> statistics;  ///< by field
};

struct InfoOptions {
  std::string file, columns;
  std::vector<std::string> statistics;
  LookOptions look;
  bool keepUnreliable = false;
  StreamOptions stream;
};

ModelInfo infoOf(const Context& context, const InfoOptions& options) {
  const std::string& file = options.file;
  const LookOptions& look = options.look;
  const CloudFormat& format = cloudFormats().toRead(file);
  const std::vector<std::string> columns = columnsFor(options.columns, format);
  // Before the contents, which are not read so thoroughly: every subcommand reports the same error of a file.
  StoredCloud stored =
      readCloud(file, nullptr,
                {.keepUnreliable = options.keepUnreliable, .columns = columns, .memory = {context.exceedsMemory()}});
  ModelInfo info{.format = format.name, .contents = {}};
  if (columns.empty()) {
    info.contents = contentsOf(file);
  } else {
    FileElement& element = info.contents.elements.emplace_back(FileElement{"vertex", stored.cloud.size(), {}});
    for (const std::string& name : columns) element.properties.push_back({name});
  }
  info.lost = std::move(stored.lost);
  info.assumed = std::move(stored.assumed);
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
  CloudFields fields(cloud, {.mm_per_unit = mmPerUnit(cloud, 0), .up = info.upright.up, .threads = context.threads()});
  for (const std::string& field : options.statistics)
    info.statistics.emplace_back(field, statisticsOf(valuesOf("--statistics", field, fields)));
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
  fmt::print(out, "  up: {} ({}, {}); heights from {} to {} {}\n", nameOf(info.upright.up), info.upright.why,
             nameOf(info.upright.sureness), coordinateText(info.heights.low, resolution),
             coordinateText(info.heights.high, resolution), nameOf(info.unit));
  fmt::print(out, "  mean spacing: {}\n", lengthText(info.spacings.mean, info.unit));
  fmt::print(out, "  touch scale: {}\n", touchScaleText(info.scale, shown.longestSide(), info.unit));
  fmt::print(out, "  noise of the positions: {:.3f} spacings\n", info.spacings.noise);
  printMemory(out, info.memory);
}

void printStatistics(std::FILE* out, const std::string& field, const FieldStatistics& found) {
  constexpr std::size_t kWidest = 50;  // characters of a bar
  fmt::print(out, "  {}: {}, {} missing\n", field, counted(found.count, "value"), found.missing);
  if (found.count == 0) return;
  fmt::print(out, "    min {:.9g}, max {:.9g}, mean {:.9g}, standard deviation {:.6g}\n", found.min, found.max,
             found.mean, found.deviation);
  fmt::print(out, "    percentiles:");
  for (std::size_t k = 0; k < found.percentiles.size(); ++k)
    fmt::print(out, " {:g} %: {:.9g}", FieldStatistics::kPercentiles[k], found.percentiles[k]);
  fmt::print(out, "\n");
  const std::uint64_t most = *std::ranges::max_element(found.histogram);
  for (std::size_t k = 0; k < found.histogram.size() && found.max > found.min; ++k) {
    const double from = std::lerp(found.min, found.max, static_cast<double>(k) / FieldStatistics::kBins);
    const std::string bar(found.histogram[k] * kWidest / most, '#');
    fmt::print(out, "    {:>14.6g} {:>10} {}\n", from, found.histogram[k], bar);
  }
}

Json statisticsJson(const FieldStatistics& found) {
  Json json{{"count", found.count}, {"missing", found.missing}};
  if (found.count == 0) return json;
  json["min"] = found.min, json["max"] = found.max;
  json["mean"] = found.mean, json["deviation"] = found.deviation;
  for (std::size_t k = 0; k < found.percentiles.size(); ++k)
    json["percentiles"][fmt::format("{:g}", FieldStatistics::kPercentiles[k])] = found.percentiles[k];
  json["histogram"] = Json::array();
  for (const std::uint64_t count : found.histogram) json["histogram"].push_back(count);
  return json;
}

void print(std::FILE* out, const std::string& file, const ModelInfo& info) {
  fmt::print(out, "{}: {}, {}\n", withShownNames(file), counted(info.model.cloud.size(), "point"), info.format);
  if (!info.contents.madeFrom.empty()) fmt::print(out, "  made from: {}\n", info.contents.madeFrom);
  for (const FileElement& element : info.contents.elements) {
    fmt::print(out, "  element {}: {}", element.name, element.count);
    for (const FileElement::Property& property : element.properties) fmt::print(out, " {}", property.name);
    fmt::print(out, "\n");
  }
  if (!info.assumed.empty())
    fmt::print(out, "  columns without names, taken as {}; --columns names them otherwise\n", info.assumed);
  if (!info.lost.empty()) fmt::print(out, "  not kept: {}\n", fmt::join(info.lost, ", "));
  if (!info.leftOut.empty()) fmt::print(out, "  left out: {}; --keep-unreliable keeps them\n", info.leftOut);
  if (!info.model.cloud.empty()) printPoints(out, info);
  for (const auto& [field, found] : info.statistics) printStatistics(out, field, found);
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
    {"assumed_columns", "", "names that were assumed for the columns of text without names; else null",
     [](const ModelInfo& i) -> Value { return orNull(i.assumed); }},
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
    {"up_sureness", "", "known, likely, or unsure",
     [](const ModelInfo& i) -> Value { return nameOf(i.upright.sureness); }},
    {"front", "", "axis towards a viewer in front of the model",
     [](const ModelInfo& i) -> Value { return nameOf(axisOf(i.upright.front)); }},
    {"front_sureness", "", "known, likely, or unsure",
     [](const ModelInfo& i) -> Value { return nameOf(i.upright.frontSureness); }},
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
    {"statistics", "",
     "by field of --statistics: count, missing (values that are not numbers), min, max, mean, deviation (standard "
     "deviation), percentiles (1, 5, 25, 50, 75, 95, 99), histogram (values in 20 equal parts of min to max)",
     [](const ModelInfo& i) -> Value {
       if (i.statistics.empty()) return std::nullopt;
       Json fields = Json::object();
       for (const auto& [field, found] : i.statistics) fields[field] = statisticsJson(found);
       return fields;
     }},
};

/// The first rows of a text file, and the names of their columns as understood.
void printColumns(std::FILE* out, const std::string& file, const CloudFormat& format) {
  constexpr std::size_t kRows = 5;
  std::vector<std::string> names;
  std::string why;
  try {
    for (const FileElement::Property& property : contentsOf(file).elements.at(0).properties)
      names.push_back(property.name);
  } catch (const FileError& error) {
    why = error.what();
  }
  const auto start = startOf(file);
  const auto rows = start ? start->lines(kRows) : std::vector<std::vector<std::string>>{};
  std::size_t columns = names.size();
  for (const auto& row : rows) columns = std::max(columns, row.size());
  fmt::print(out, "{}: {}, columns as understood\n", withShownNames(file), format.name);
  for (std::size_t k = 0; k < columns; ++k) {
    fmt::print(out, "  {:>2}  {:<16}", k + 1, k < names.size() ? names[k] : "?");
    for (const auto& row : rows) fmt::print(out, "  {:<14}", k < row.size() ? row[k] : "");
    fmt::print(out, "\n");
  }
  if (!why.empty()) fmt::print(out, "  not read yet: {}\n", why);
  fmt::print(out, "  --columns NAMES names them otherwise, as in --columns x,y,z,intensity\n");
}

void info(Context& context, const InfoOptions& options) {
  const std::string& file = options.file;
  std::error_code ignored;
  if (std::filesystem::is_fifo(file, ignored) || std::filesystem::is_character_file(file, ignored))
    throw Error("{}: a pipe can be read only once, and info reads twice; name standard input -, with its --format",
                file);
  if (options.columns == "?") {
    const CloudFormat& format = cloudFormats().toRead(file);
    columnsFor(options.columns, format);  // refuses what is not text
    return printColumns(context.tables(), file, format);
  }
  const ModelInfo info = infoOf(context, options);
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
  auto options = std::make_shared<InfoOptions>();
  sub.add("model", options->file, modelsAndStreams(RosModels::none))
      .required()
      .typeName("MODEL")
      .offers(builtInSceneNames());
  sub.add("--columns", options->columns,
          "names of the columns of a text file, e.g. x,y,z,intensity; ? shows its first rows as understood")
      .typeName("NAMES");
  sub.add("--statistics", options->statistics,
          "statistics of a field, or of an expression of fields, as z, \"intensity / 256\" or density; may be repeated")
      .repeatable()
      .typeName("FIELD");
  addLookOptions(sub, options->look);
  addAllPointsOption(sub, options->keepUnreliable);
  sub.heading("Depth camera");
  addDepthOptions(sub, options->stream);
  sub.heading("Options");
  sub.whenNamed([&, options] {
    command = [&context, options] {
      ModelConfig model{.file = options->file};
      setSource(model, options->stream);
      if (model.stream)
        infoOfFrames(context, options->file, options->stream);
      else if (model.matter)
        infoOfScene(context, options->file, model.matter);
      else
        info(context, *options);
    };
  });
}

}  // namespace palpate
