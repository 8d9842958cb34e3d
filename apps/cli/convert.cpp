#include <fmt/ranges.h>

#include <algorithm>

#include "apps/cli/context.hpp"
#include "apps/cli/fused_folder.hpp"
#include "apps/cli/model.hpp"
#include "apps/cli/output.hpp"
#include "apps/cli/setting_options.hpp"
#include "apps/cli/sharing_options.hpp"
#include "engine/cloud/length_unit.hpp"
#include "engine/cloud/normals.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/named_values.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/foreign_file.hpp"
#include "engine/io/mesh_format.hpp"
#include "engine/io/saving.hpp"
#include "haptics/session/bounds.hpp"

namespace palpate {

namespace {

struct ConvertOptions {
  std::string input, output, normals = "keep", columns;
  bool ascii = false, dropsUnreliable = false;
  ScaleOptions scale;
  StreamConfig stream;  ///< intrinsics and depth scale
  std::int64_t samples = 0;
  std::string unit;
  NetworkOptions network;
};

bool ontoItself(const ConvertOptions& options) {
  std::error_code ignored;
  return std::filesystem::equivalent(options.input, options.output, ignored);
}

// Existing files are replaced only on request; a device or a pipe can be written to.
void checkTarget(const Context& context, const ConvertOptions& options) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(options.output, ignored) || context.isForced()) return;
  throw Error("{}: {}; name another file, or add --force to replace it", options.output,
              ontoItself(options) ? "is the file that is read" : "exists");
}

void refuseMissing(const std::string& input) {
  std::error_code ignored;
  if (!std::filesystem::exists(input, ignored)) throw FileError(input, "does not exist");
}

// The input, its format, and further counts for the machine-readable result.
struct ConvertInput {
  StoredCloud stored;
  std::string format;
  std::vector<std::pair<std::string_view, std::uint64_t>> counts = {};
};

std::size_t samplesOf(const ConvertOptions& options, const CloudFormat& from) {
  if (options.samples > 0 && !from.ofTriangles)
    throw UsageError("--samples applies to meshes only; {} contains points", from.name);
  return static_cast<std::size_t>(options.samples);
}

ConvertInput readInput(Context& context, const ConvertOptions& options, const CloudFormat& to) {
  if (isRosModel(options.input))
    return {.stored = {.cloud = rosFetcher(options.network)(options.input, context.log())}, .format = "ROS"};
  if (!isRgbdFolder(options.input)) {
    const CloudFormat& from = cloudFormats().toRead(options.input);
    return {.stored = readCloud(options.input, &context.log(),
                                {.normalsFromFaces = options.normals == "face",
                                 .keepUnreliable = !options.dropsUnreliable,
                                 .samples = samplesOf(options, from),
                                 .asTriangles = from.ofTriangles && to.ofTriangles && options.samples == 0,
                                 .columns = columnsFor(options.columns, from),
                                 .memory = {context.exceedsMemory()}}),
            .format = std::string(from.name)};
  }
  FusedFolder fused = readFused(context, options.input,
                                {.intrinsics = options.stream.intrinsics, .depthScale = options.stream.depthScale});
  return {
      .stored = std::move(fused.stored),
      .format = fused.kind,
      .counts = {
          {"frames", fused.frames}, {"fused", fused.fused}, {"unplaced", fused.unplaced}, {"lost_frames", fused.lost}}};
}

// The unit that --unit gives to the file; the coordinates stay as they are.
void stateUnit(Log& log, const ConvertOptions& options, const CloudFormat& to, std::vector<std::string>& comments) {
  const auto unit = valueNamed(kLengthUnits, options.unit);
  if (!unit) return;
  if (!to.hasComments)
    return log.say("{}: {} cannot hold a unit of length; {} is not kept", options.output, to.name, options.unit);
  if (const LengthUnit before = unitSaidIn(comments); before != LengthUnit::unknown && before != *unit)
    log.warn("{}: its unit is {}; {} says {}, with the same coordinates: no length is converted", options.input,
             nameOf(before), options.output, options.unit);
  setUnit(comments, *unit);
}

void convert(Context& context, const ConvertOptions& options) {
  // Errors of the input are reported before those of an existing output.
  checkRosHearing(options.network, options.input);
  if (!isRosModel(options.input)) refuseForeign(options.input);
  const CloudFormat& to = cloudFormats().toWrite(options.output);
  if (!isRosModel(options.input)) refuseMissing(options.input);
  const double mm_per_unit = options.scale.given();
  checkTarget(context, options);
  checkOutput(options.output, Output::copy);
  ConvertInput input = readInput(context, options, to);
  StoredCloud& stored = input.stored;
  if (stored.cloud.empty())
    throw Error("{}: contains no points{}{}; nothing is written", options.input, stored.lost.empty() ? "" : ", but ",
                fmt::join(stored.lost, ", "));
  if (options.normals == "estimate") estimateNormals(stored.cloud, 16, context.threads());
  std::vector<std::string> lost = lostOnTheWay(stored, to);
  if (!stored.leftOut.empty()) lost.push_back(stored.leftOut + " (--drop-unreliable)");
  const std::vector<std::string> kept = keptOnTheWay(stored, to);
  // Reports losses before the file is written.
  if (!lost.empty()) context.log().say("{}: not kept: {}", options.output, fmt::join(lost, ", "));
  markAsOurs(stored.cloud);
  stateUnit(context.log(), options, to, stored.cloud.storedAs.comments);
  if (mm_per_unit > 0) sayScale(stored.cloud.storedAs.comments, mm_per_unit);
  std::filesystem::path keptAs;
  std::error_code ignored;
  const bool replaces = std::filesystem::is_regular_file(options.output, ignored);
  to.write(options.output, stored.cloud,
           {.ascii = options.ascii,
            .triangles = stored.triangles.empty() ? nullptr : &stored.triangles,
            .keptAs = replaces ? &keptAs : nullptr});
  if (!keptAs.empty()) context.log().say("{}: the existing file is kept as {}", options.output, keptAs.string());
  context.log().say("{}: {} with {}", options.output, counted(stored.cloud.size(), "point"), fmt::join(kept, ", "));
  Json result{{"input", options.input},
              {"output", options.output},
              {"from", input.format},
              {"to", to.name},
              {"points", stored.cloud.size()},
              {"triangles", stored.triangles.size()},
              {"kept", kept},
              {"lost", lost}};
  for (const auto& [name, count] : input.counts) result[name] = count;
  context.writeJson(result);
}

}  // namespace

void addConvert(Options& app, Context& context, Command& command) {
  Options& sub = app.addSubcommand("convert", "convert a cloud to another format, and report what is lost");
  auto options = std::make_shared<ConvertOptions>();
  sub.add("input", options->input,
          fmt::format("input: {}; or {}, whose frames are fused; or ros:TOPIC, for its first PointCloud2",
                      cloudFormats().endingsRead(), rgbdFoldersRead()))
      .required()
      .typeName("IN");
  sub.add("output", options->output, "output: " + cloudFormats().endingsWritten())
      .required()
      .typeName("OUT")
      .writes(Writes::keeping);
  sub.add("--normals", options->normals,
          "keep: copy the normals of the file; estimate: estimate them from the points; face: from the "
          "faces")
      .check(oneOf({"keep", "estimate", "face"}))
      .showDefault();
  sub.add("--columns", options->columns,
          "names of the columns of a text file, e.g. x,y,z,intensity,red,green,blue (default: from its "
          "first line)")
      .typeName("NAMES");
  sub.add("--samples", options->samples,
          fmt::format(
              "points to sample evenly from a mesh (OBJ, STL, OFF, glTF); default: {}, or none if OUT is a mesh, which "
              "keeps the triangles",
              kUsualSamples))
      .check(wholeBetween(1, 2e9));
  addSetting(sub, options->stream, "intrinsics")
      .describe("intrinsics of the depth camera, JSON (default: those of the folder)")
      .typeName("FILE");
  addSetting(sub, options->stream, "depth_scale").describe("depth values per metre (default: that of the folder)");
  sub.addFlag("--drop-unreliable", options->dropsUnreliable,
              "COLMAP: drop unreliable points, as touch does without --keep-unreliable");
  addScaleOptions(sub, options->scale);
  sub.add("--unit", options->unit,
          "unit of length that OUT states: mm, cm, m, in or ft; coordinates are not scaled (default: the unit that IN "
          "states)")
      .check(oneOf(namesOf(kLengthUnits)));
  addNetworkOptions(sub, options->network);
  addRosFrameOption(sub, options->network);
  sub.addFlag("--ascii", options->ascii, "write ASCII in place of binary little-endian");
  sub.footer(
      "The order of points, the precision of coordinates and unknown properties are preserved. A "
      "folder of depth frames is fused into one cloud in metres. Faces are written as triangles. A "
      "scale is written as a comment that touch and view read; coordinates are not scaled. Losses "
      "in OUT are reported before it is written.\n");
  sub.whenNamed([&, options] { command = [&context, options] { convert(context, *options); }; });
}

}  // namespace palpate
