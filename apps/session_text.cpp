#include "apps/session_text.hpp"

#include <charconv>
#include <limits>
#include <set>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/error.hpp"

namespace palpate {

namespace {

// What a session wrote, and where its poses came from, is not needed to run it again.
std::set<std::string> namesLeftOut() {
  std::set<std::string> names{"model",          "--help",      "--path",          "--penetration", "--trace",
                              "--save",         "--log",       "--picture",       "--print-tick",  "--duration",
                              "--trajectory",   "--device",    "--scheduler",     "--map",         "--hand-stiffness",
                              "--hand-damping", "--passivity", "--second-device", "--second-path", "--second-trace"};
  CLI::App scratch;
  PictureOptions picture;
  addPictureOptions(scratch, picture);
  for (const CLI::Option* option : scratch.get_options()) names.insert(option->get_name());
  return names;
}

Json optionsOf(const CLI::App& command) {
  const std::set<std::string> leftOut = namesLeftOut();
  Json options = Json::object();
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_name();
    if (leftOut.contains(name)) continue;
    if (option->count() > 0)
      options[name] = option->results().front();
    else if (!option->get_default_str().empty() && option->get_expected_min() > 0)
      options[name] = option->get_default_str();
  }
  return options;
}

TouchCommandOptions parseOptions(const Json& json, const std::string& model) {
  CLI::App app;
  TouchCommandOptions options;
  addTouchOptions(app, options);
  std::vector<std::string> arguments;
  for (const auto& [name, value] : json.items()) arguments.push_back(name + "=" + value.get<std::string>());
  arguments.push_back(model);
  std::ranges::reverse(arguments);  // as CLI11 wants them
  app.parse(std::move(arguments));
  return options;
}

// A number that may be infinite, which JSON cannot say: null.
Json limit(double value) { return std::isinf(value) ? Json(nullptr) : Json(value); }
double limit(const Json& json) { return json.is_null() ? std::numeric_limits<double>::infinity() : json.get<double>(); }

std::string hex(std::uint64_t value) { return fmt::format("{:016x}", value); }
std::uint64_t fromHex(const std::string& text) {
  std::uint64_t value = 0;
  const char* end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, value, 16);
  if (error != std::errc() || last != end) throw std::invalid_argument("'" + text + "' is no checksum");
  return value;
}

constexpr std::array<std::pair<std::string_view, PassivityMode>, 3> kPassivities{
    {{"on", PassivityMode::on}, {"observe", PassivityMode::observe}, {"off", PassivityMode::off}}};

Json deviceOf(const RecordedSession& session) {
  Json device{{"peak_force_N", limit(session.limits.peakForce_N)},
              {"continuous_force_N", limit(session.limits.continuousForce_N)},
              {"fastest_mm_per_s", limit(session.limits.fastest_mm_per_s)},
              {"most_damping_N_s_per_mm", limit(session.limits.mostDamping_N_s_per_mm)},
              {"most_stiffness_N_per_mm", limit(session.limits.mostStiffness_N_per_mm)},
              {"force_delay_ticks", session.limits.forceDelay_ticks},
              {"hand_held", session.limits.handHeld},
              {"buttons", session.limits.buttons},
              {"map_scale", session.map.scale},
              {"map_offset", {session.map.offset.x, session.map.offset.y, session.map.offset.z}},
              {"passivity", nullptr}};
  for (const auto& [name, mode] : kPassivities)
    if (session.passivity == mode) device["passivity"] = name;
  return device;
}

void readDevice(const Json& device, RecordedSession& session) {
  session.limits = {.peakForce_N = limit(device.at("peak_force_N")),
                    .continuousForce_N = limit(device.at("continuous_force_N")),
                    .fastest_mm_per_s = limit(device.at("fastest_mm_per_s")),
                    .mostDamping_N_s_per_mm = limit(device.at("most_damping_N_s_per_mm")),
                    .mostStiffness_N_per_mm = limit(device.value("most_stiffness_N_per_mm", Json(nullptr))),
                    .forceDelay_ticks = device.at("force_delay_ticks").get<int>(),
                    .handHeld = device.at("hand_held").get<bool>(),
                    .buttons = device.value("buttons", 0)};
  const Json& offset = device.at("map_offset");
  session.map = {.scale = device.at("map_scale").get<double>(),
                 .offset = {offset.at(0).get<double>(), offset.at(1).get<double>(), offset.at(2).get<double>()}};
  for (const auto& [name, mode] : kPassivities)
    if (device.at("passivity") == name) session.passivity = mode;
}

}  // namespace

std::uint64_t checksumOf(const Model& model) { return checksumOf(model.cloud.origin, statesOf(model.cloud)); }

std::string sessionText(const CLI::App& command, const RecordedSession& session) {
  return Json{{"palpate", session.palpate},
              {"machine", session.machine},
              {"model",
               {{"file", std::filesystem::absolute(session.modelFile).string()},
                {"points", session.points},
                {"checksum", hex(session.checksum)}}},
              {"options", optionsOf(command)},
              {"device", deviceOf(session)}}
      .dump(1);
}

RecordedSession parseSessionText(const std::filesystem::path& log, const std::string& text) {
  try {
    const Json json = Json::parse(text);
    const Json& model = json.at("model");
    RecordedSession session{.modelFile = model.at("file").get<std::string>(),
                            .points = model.at("points").get<std::uint64_t>(),
                            .checksum = fromHex(model.at("checksum").get<std::string>()),
                            .machine = json.at("machine").get<std::string>(),
                            .palpate = json.at("palpate").get<std::string>()};
    session.options = parseOptions(json.at("options"), session.modelFile);
    readDevice(json.at("device"), session);
    return session;
  } catch (const std::exception& error) {  // of JSON, of an option
    throw FileError(log, fmt::format("does not say how to run the session again ({}); was it written by another "
                                     "palpate?",
                                     error.what()));
  }
}

void TickTap::ticked(const TraceRow& row, const DeviceState& device) noexcept {
  const TouchShortfalls& shortfalls = backend_.shortfalls();
  const std::uint64_t leftOut = shortfalls.editsLogFull + shortfalls.editsTooSlow + shortfalls.editsHeldUp;
  const bool leavesOut = std::exchange(leftOut_, leftOut) != leftOut;
  sink_({.time_s = row.time_s,
         .device = device.position,
         .turn = device.turn,
         .proxy = row.proxy,
         .force_N = row.force_N,
         .edits = backend_.editsAnswered(),
         .neighbours = row.neighbours,
         .flags = (row.contact ? LoggedTick::kContact : 0u) | (row.fresh ? LoggedTick::kFresh : 0u) |
                  (row.valid ? LoggedTick::kValid : 0u) | (row.putDown ? LoggedTick::kPutDown : 0u) |
                  (device.rendersForce ? 0u : LoggedTick::kForceless) | (leavesOut ? LoggedTick::kEditLeftOut : 0u) |
                  LoggedTick::flagsOf(device.buttons)});
}

}  // namespace palpate
