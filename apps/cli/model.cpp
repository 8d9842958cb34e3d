#include "apps/cli/model.hpp"

#include <charconv>
#include <cmath>

#include "apps/cli/parse_list.hpp"
#include "apps/cli/setting_options.hpp"
#include "apps/cli/sharing_options.hpp"
#include "engine/io/cloud_formats.hpp"
#include "haptics/session/simulation.hpp"
#include "haptics/session/vulkan_backend.hpp"

namespace palpate {

void addModelOptions(Options& command, ModelOptions& options) {
  addModelOptions(command, options,
                  fmt::format("{} file: points, normals, colours; everything else is carried or skipped",
                              cloudFormats().namesRead()),
                  true);
}

void addModelOptions(Options& command, ModelOptions& options, const std::string& what, bool isRequired) {
  Option model = command.add("model", options.file, what).typeName("MODEL");
  if (isRequired)
    model.required();
  else
    model.offers(builtInSceneNames());
  addScaleOptions(command, options.scale);
  addSettingFor<ModelConfig>(command, options.normals, "normals")
      .check(oneOf(choicesOf<ModelConfig>("normals")))
      .showDefault();
  addAllPointsOption(command, options.keepUnreliable);
  addPrepareOptions(command, options.prepare);
}

void addScaleOptions(Options& command, ScaleOptions& options) {
  addSettingFor<ModelConfig>(command, options.mm_per_unit, "mm_per_unit");
  command
      .add("--scale-from", options.from,
           "touch scale from two positions in model units and their true distance in mm: "
           "\"0,0,0:1.5,0,2=340\"")
      .typeName("X,Y,Z:X,Y,Z=MM");
}

std::vector<std::string> columnsFor(const std::string& text, const CloudFormat& from) {
  if (text.empty()) return {};
  if (!from.isText) throw UsageError("--columns applies to text files only; {} names its own columns", from.name);
  std::vector<std::string> names(1);
  for (const char c : text) {
    if (c != ',' && c != ' ')
      names.back() += c;
    else if (!names.back().empty())
      names.emplace_back();
  }
  if (names.back().empty()) names.pop_back();
  return names;
}

void addAllPointsOption(Options& command, bool& keepUnreliable) {
  addSettingFor<ModelConfig>(command, keepUnreliable, "keep_unreliable");
}

double ScaleOptions::given() const {
  if (from.empty()) return mm_per_unit;
  if (mm_per_unit > 0) throw UsageError("--scale-from: conflicts with --mm-per-unit; leave one of them out");
  constexpr const char* kWanted = "two positions and a length in mm, as in 0,0,0:1.5,0,2=340";
  const std::size_t colon = from.find(':'), equals = from.find('=');
  if (colon == from.npos || equals == from.npos || equals < colon)
    throw UsageError("--scale-from: '{}' is not {}", from, kWanted);
  const auto place = [&](std::size_t begin, std::size_t end) {
    const auto [x, y, z] = parseList<double, 3>(from.substr(begin, end - begin), ',', "--scale-from", kWanted);
    return DVec3(x, y, z);
  };
  const double apart = glm::distance(place(0, colon), place(colon + 1, equals));
  const double apart_mm = parseList<double, 1>(from.substr(equals + 1), ',', "--scale-from", kWanted)[0];
  const double scale = apart_mm / apart;
  if (!(apart > 0)) throw UsageError("--scale-from: both positions are the same");
  if (!(scale >= bounds::kMinScale && scale <= bounds::kMaxScale))
    throw UsageError("--scale-from: {} mm for {} units are {} mm per unit, which is not between {} and {}", apart_mm,
                     apart, scale, bounds::kMinScale, bounds::kMaxScale);
  return scale;
}

ModelConfig ModelOptions::config() const {
  ModelConfig config{.file = file, .mm_per_unit = scale.given(), .keepUnreliable = keepUnreliable};
  for (const auto& [name, source] : kNormalSources)
    if (name == normals) config.normals = source;
  config.prepare = prepare.given();
  return config;
}

std::optional<double> radius_mm(const std::string& text) {
  if (text == "auto") return std::nullopt;
  double radius_mm = 0;
  const char* end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, radius_mm);
  if (error != std::errc() || last != end || !(radius_mm > 0) || !std::isfinite(radius_mm))
    throw UsageError("--radius: '{}' is neither a positive length in mm nor 'auto'", text);
  return radius_mm;
}

double supportRadius(const std::string& text, const Model& model) {
  const std::optional<double> given_mm = radius_mm(text);
  return given_mm ? model.scale.toUnits(*given_mm) : usualSupportRadius(model);
}

Model loadModel(Context& context, const ModelConfig& config, EstimateOn where, const NetworkOptions* network) {
  ModelLoading loading{.log = context.log(),
                       .threads = context.threads(),
                       .join = joiningOnlooker(),
                       .exceeds = context.exceedsMemory()};
  if (network) {
    loading.fetch = rosFetcher(*network);
    loading.watch = rosWatcher(*network, context.threads());
  }
  if (where == EstimateOn::gpu) loading.estimate = estimateNormalsOn([&]() -> Device& { return context.device(); });
  return loadModel(config, loading);
}

}  // namespace palpate
