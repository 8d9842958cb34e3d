#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "apps/cli/config_flags.hpp"
#include "apps/cli/context.hpp"
#include "apps/cli/model.hpp"
#include "apps/cli/output.hpp"
#include "apps/cli/prepare_options.hpp"
#include "apps/cli/progress.hpp"
#include "apps/cli/setting_options.hpp"
#include "apps/cli/sharing_options.hpp"
#include "engine/cloud/gaussian_records.hpp"
#include "engine/cloud/length_unit.hpp"
#include "engine/cloud/normals.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/core/named_values.hpp"
#include "engine/io/cloud_format.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/foreign_file.hpp"
#include "engine/io/known_formats.hpp"
#include "engine/io/rgbd_folder.hpp"
#include "engine/io/saving.hpp"
#include "engine/motion/frame_fusion.hpp"
#include "engine/select/chosen_points.hpp"
#include "engine/select/normal_signs.hpp"
#include "engine/select/prepared_cloud.hpp"
#include "haptics/session/bounds.hpp"
#include "haptics/session/vulkan_backend.hpp"

namespace palpate {

namespace {

// A recorded depth camera as one cloud, for commands that take a cloud from a file.
struct FusedFolder {
  StoredCloud stored;        ///< in metres
  std::string kind;          ///< as RgbdFolder::kind()
  std::uint64_t frames = 0;  ///< in the folder
  std::uint64_t fused = 0;
  std::uint64_t unplaced = 0;  ///< without a pose, and tracking failed
  std::uint64_t lost = 0;      ///< unreadable ones
};

// Returns false at the end.
bool readNext(RgbdFolder& stream, FrameFusion& fusion, DepthFrame& frame) {
  for (;;) {
    try {
      return stream.next(frame);
    } catch (const Error& error) {
      fusion.countLost(error.what());
    }
  }
}

/// Fuses all frames of a folder with isRgbdFolder(), at their own poses, or at tracked ones if they have none. Logs the
/// frames left out. Throws FileError if no points remain.
FusedFolder readFused(Context& context, const std::filesystem::path& folder, const RgbdOptions& options) {
  Log& log = context.log();
  RgbdFolder stream(folder, options, &log);
  FusionOptions fusionOptions;
  fusionOptions.threads = context.threads();
  FrameFusion fusion(fusionOptions, {}, &log);
  DepthFrame frame;
  for (double done = 1; readNext(stream, fusion, frame); ++done) {
    fusion.fuse(stream.camera(), frame);
    log.progress("fusing", done / static_cast<double>(stream.frames()));
  }
  log.endProgress();
  FusedFolder fused{.stored = {.cloud = fusion.map().cloud()},
                    .kind = std::string(stream.kind()),
                    .frames = stream.frames(),
                    .fused = fusion.fused(),
                    .unplaced = fusion.unplaced(),
                    .lost = fusion.lost()};
  if (fused.stored.cloud.empty())
    throw FileError(folder, fmt::format("its {} frames show no surface: {} were fused, {} could not be placed, {} not "
                                        "read; check the depth scale ({} values a metre) and the intrinsics",
                                        fused.frames, fused.fused, fused.unplaced, fused.lost, stream.depthScale()));
  log.say("{}: {} of {} frames fused into {}, in metres", folder.string(), fused.fused, fused.frames,
          counted(fused.stored.cloud.size(), "point"));
  return fused;
}

struct ConvertOptions {
  std::string input, output, normals = "keep", columns;
  std::vector<std::string> more;  ///< further inputs, with a folder
  std::string folder, ending;     ///< of the outputs of many inputs; empty: one input; as the input has it
  PrepareOptions prepare;
  std::string up;
  bool ascii = false, dropsUnreliable = false, surface = false;
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

// The up axis that --up gives to the file; where the model was rotated, z is up.
void stateUp(Log& log, const ConvertOptions& options, const CloudFormat& to, std::vector<std::string>& comments) {
  if (options.up.empty() || options.prepare.preparation.upright || options.prepare.preparation.level) return;
  if (!to.hasComments)
    return log.say("{}: {} cannot hold an up axis; {} is not kept", options.output, to.name, options.up);
  setUp(comments, *valueNamed(kUpAxes, options.up));
}

// The Gaussians that the output will have; null: none.
const GaussianRecords* keptGaussians(const ConvertOptions& options, const CloudFormat& to, const PointCloud& cloud) {
  return !options.surface && keepsBaggage(to, cloud) ? gaussiansOf(cloud) : nullptr;
}

// Selects and cleans, as the options say, and sets the normals; returns the steps.
Json prepare(Context& context, const ConvertOptions& options, const CloudFormat& to, StoredCloud& stored) {
  Json steps = Json::array();
  PointCloud& cloud = stored.cloud;
  const std::optional<UpAxis> up = valueNamed(kUpAxes, options.up);
  const bool onGpu = cloud.size() >= Cleaners::kFewestOnGpu && context.hasRealGpu();
  const Cleaners cleaners = onGpu ? cleanersOn([&]() -> Device& { return context.device(); }) : Cleaners();
  if (const std::optional<Preparation> preparation = options.prepare.given()) {
    Progress progress(context.log(), "select and clean");
    const auto report = [&](const PreparedStep& step) {
      const std::string flag = flagOf(step.name);
      context.log().say("{}: {} {}", options.input, flag, step.what);
      steps.push_back({{"step", flag}, {"points_before", step.before}, {"points", step.after}});
      if (step.after == 0)
        throw Error("{}: {} {}; nothing is left, and nothing is written", options.input, flag, step.what);
    };
    const double given = options.scale.given();
    const double ofUnit = mmIn(valueNamed(kLengthUnits, options.unit).value_or(LengthUnit::unknown)).value_or(0);
    const FieldOptions fields{.mm_per_unit = mmPerUnit(cloud, given > 0 ? given : ofUnit),
                              .up = up,
                              .threads = context.threads(),
                              .progress = [&](double share) { progress.set(share); }};
    const std::size_t before = cloud.size();
    const std::vector<std::string> said = cloud.storedAs.comments;
    if (preparation->fillHoles_mm > 0 && !stored.triangles.empty())
      throw ConfigError("prepare.fill_holes_mm",
                        "{} is written as triangles, whose holes are not closed; --samples N makes points of them",
                        options.output);
    const bool splatsAlone = keptGaussians(options, to, cloud) && options.normals == "keep";
    PreparedCloud prepared = palpate::prepared(std::move(cloud), *preparation, fields, report, cleaners.distances,
                                               splatsAlone ? SplatSurface::none : SplatSurface::made);
    cloud = std::move(prepared.cloud);
    if (prepared.upright && !to.hasComments && cloud.storedAs.comments != said)
      context.log().say("{}: {} cannot hold the up axis and the touch scale of the whole model", options.output,
                        to.name);
    if (prepared.numbers.size() < before) stored.triangles = chosenTriangles(stored.triangles, prepared.numbers);
  }
  if (options.normals == "estimate")
    context.log().say("{}: normals estimated: {}", options.input, cleaners.estimate(cloud, context.threads(), up));
  const bool flips = options.normals == "flip";
  if ((flips || options.normals == "orient") && !cloud.hasNormals())
    throw Error("{}: has no normals to {}; use --normals estimate", options.input, options.normals);
  if (flips) flipNormals(cloud);
  if (options.normals == "orient") orientNormals(cloud, context.threads(), up);
  return steps;
}

void requireContents(const ConvertOptions& options, const CloudFormat& to, const StoredCloud& stored) {
  const GaussianRecords* const gaussians = keptGaussians(options, to, stored.cloud);
  if (!stored.cloud.empty() || (gaussians && gaussians->size() > 0)) return;
  throw Error("{}: contains no points{}{}; nothing is written", options.input, stored.lost.empty() ? "" : ", but ",
              fmt::join(stored.lost, ", "));
}

Json convertOne(Context& context, const ConvertOptions& options) {
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
  requireContents(options, to, stored);
  const Json steps = prepare(context, options, to, stored);
  requireContents(options, to, stored);
  if (options.surface && gaussiansOf(stored.cloud)) {
    stored.lost.push_back(stored.cloud.storedAs.baggage->sentence);
    forgetGaussians(stored.cloud);
  }
  std::vector<std::string> lost = lostOnTheWay(stored, to);
  if (!stored.leftOut.empty()) lost.push_back(stored.leftOut + " (--drop-unreliable)");
  const std::vector<std::string> kept = keptOnTheWay(stored, to);
  // Reports losses before the file is written.
  if (!lost.empty()) context.log().say("{}: not kept: {}", options.output, fmt::join(lost, ", "));
  markAsOurs(stored.cloud);
  stateUnit(context.log(), options, to, stored.cloud.storedAs.comments);
  stateUp(context.log(), options, to, stored.cloud.storedAs.comments);
  if (mm_per_unit > 0) sayScale(stored.cloud.storedAs.comments, mm_per_unit);
  std::filesystem::path keptAs;
  std::error_code ignored;
  const bool replaces = std::filesystem::is_regular_file(options.output, ignored);
  to.write(options.output, stored.cloud,
           {.ascii = options.ascii,
            .triangles = stored.triangles.empty() ? nullptr : &stored.triangles,
            .keptAs = replaces ? &keptAs : nullptr});
  if (!keptAs.empty()) context.log().say("{}: the existing file is kept as {}", options.output, keptAs.string());
  const GaussianRecords* const gaussians = keptGaussians(options, to, stored.cloud);
  context.log().say("{}: {} with {}", options.output,
                    gaussians ? gaussiansInWords(*gaussians) : counted(stored.cloud.size(), "point"),
                    fmt::join(kept, ", "));
  Json result{{"input", options.input},
              {"output", options.output},
              {"from", input.format},
              {"to", to.name},
              {"points", gaussians ? gaussians->size() : stored.cloud.size()},
              {"triangles", stored.triangles.size()},
              {"kept", kept},
              {"lost", lost}};
  for (const auto& [name, count] : input.counts) result[name] = count;
  if (gaussians) result["gaussians"] = gaussians->size();
  if (steps.size() > 0) result["steps"] = steps;
  return result;
}

// The name of an input in the folder.
std::string outputIn(const ConvertOptions& options, const std::string& input) {
  std::filesystem::path name = std::filesystem::path(input).lexically_normal();
  if (!name.has_filename()) name = name.parent_path();  // a folder
  const std::string ending = options.ending.empty() ? cloudFormats().endingToSave(input) : "." + options.ending;
  return (std::filesystem::path(options.folder) / (name.stem().string() + ending)).string();
}

// Each file is converted, or reported; the others are converted in any case.
void convertMany(Context& context, const ConvertOptions& options, const Options& command) {
  std::vector<std::string> inputs{options.input};
  if (!options.output.empty()) inputs.push_back(options.output);
  inputs.insert(inputs.end(), options.more.begin(), options.more.end());
  std::filesystem::create_directories(options.folder);
  Json files = Json::array();
  std::map<std::string, std::string> writtenFrom;
  std::size_t failed = 0;
  const auto fail = [&](const std::string& input, const std::string& what) {
    context.log().warn("{}", what);
    files.push_back({{"input", input}, {"error", what}});
    ++failed;
  };
  for (const std::string& input : inputs) {
    ConvertOptions one = options;
    one.input = input;
    try {
      one.output = outputIn(options, input);
      if (const auto [first, isNew] = writtenFrom.emplace(one.output, input); !isNew)
        throw Error("{}: {} was already written from {}; convert it by itself", input, one.output, first->second);
      files.push_back(convertOne(context, one));
    } catch (const ConfigError& error) {
      fail(input, fmt::format("{}: {}", input, inFlags(error, command)));
    } catch (const Error& error) {
      fail(input, error.what());
    }
  }
  context.writeJson({{"files", files}, {"failed", failed}});
  if (failed > 0) throw Error("{} of {} were not converted; see above", failed, counted(inputs.size(), "file"));
}

void convert(Context& context, const ConvertOptions& options, const Options& command) {
  if (!options.folder.empty()) return convertMany(context, options, command);
  if (options.output.empty()) throw UsageError("output: is required; name a file, or a folder with --to");
  if (!options.more.empty() && options.more.front().starts_with('-'))
    throw UsageError("{} follows --, and what follows that are names, not options; put -- behind the options",
                     options.more.front());
  if (!options.more.empty())
    throw UsageError("{} is a third file; several files are converted into a folder, which --to names",
                     options.more.front());
  context.writeJson(convertOne(context, options));
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
      .typeName("OUT")
      .writes(Writes::keeping);
  sub.add("more", options->more, "further inputs: with --to, all files are").typeName("IN");
  sub.add("--to", options->folder,
          "convert all named files into this folder, in their own formats or that of --format; one that fails is "
          "reported, and the others are converted")
      .typeName("FOLDER");
  sub.add("--normals", options->normals,
          "keep: copy the normals of the file; estimate: estimate them from the points, of a "
          "million and more on a GPU; face: from the faces; orient: flip those of the file so that neighbours agree; "
          "flip: flip all")
      .check(oneOf(namesOf(kNormalSources)))
      .showDefault();
  sub.heading("Select and clean, in this order");
  addPrepareOptions(sub, options->prepare);
  sub.heading("Options");
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
  sub.addFlag("--surface", options->surface,
              "splats: write the points of their surface, also to PLY, which otherwise keeps the Gaussians");
  addScaleOptions(sub, options->scale);
  sub.add("--unit", options->unit,
          "unit of length that OUT states: mm, cm, m, in or ft; coordinates are not scaled (default: the unit that IN "
          "states)")
      .check(oneOf(namesOf(kLengthUnits)));
  sub.add("--up", options->up, "up axis that OUT states: x, y, z, -x, -y or -z; the points stay as they are")
      .check(oneOf(namesOf(kUpAxes)));
  addNetworkOptions(sub, options->network);
  addRosFrameOption(sub, options->network);
  sub.addFlag("--ascii", options->ascii, "write ASCII in place of binary little-endian");
  sub.footer(
      "The order of points, the precision of coordinates and unknown properties are preserved. A "
      "folder of depth frames is fused into one cloud in metres. A splat scene stays one in PLY: what is selected, "
      "cleaned, set or levelled are its Gaussians, by their own columns (opacity > 0), and all others keep every "
      "property bit by bit. Faces are written as triangles. A "
      "scale is written as a comment that touch and view read; coordinates are not scaled. Losses "
      "in OUT are reported before it is written.\n");
  sub.whenNamed([&, options] {
    for (const Option& option : app.all())
      if (option.name() == "--format" && option.given()) options->ending = option.text();
    command = [&context, &sub, options] { convert(context, *options, sub); };
  });
}

}  // namespace palpate
