#include "haptics/session/session_header.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "engine/core/characters.hpp"
#include "engine/core/error.hpp"

namespace palpate {

namespace {

using Json = nlohmann::ordered_json;

// A number that may be infinite, which JSON cannot represent: null.
Json limit(double value) { return std::isinf(value) ? Json(nullptr) : Json(value); }
double limit(const Json& json) { return json.is_null() ? std::numeric_limits<double>::infinity() : json.get<double>(); }

std::string hex(std::uint64_t value) { return fmt::format("{:016x}", value); }
std::uint64_t fromHex(const std::string& text) {
  std::uint64_t value = 0;
  const char* end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, value, 16);
  if (error != std::errc() || last != end) throw std::invalid_argument("'" + text + "' is not a checksum");
  return value;
}

// A file name that may not be UTF-8, which JSON cannot represent, also as its bytes.
void putBytes(Json& json, const char* key, const std::string& name) {
  if (std::ranges::count(charactersOf(name), U'\uFFFD') > 0)
    json[key] = std::vector<unsigned char>(name.begin(), name.end());
}
void readBytes(const Json& json, const char* key, std::string& name) {
  if (!json.contains(key)) return;
  const auto bytes = json.at(key).get<std::vector<unsigned char>>();
  name.assign(bytes.begin(), bytes.end());
}

Json deviceOf(const RecordedSession& session) {
  Json device{{"peak_force_N", limit(session.limits.peakForce_N)},
              {"continuous_force_N", limit(session.limits.continuousForce_N)},
              {"fastest_mm_per_s", limit(session.limits.fastest_mm_per_s)},
              {"max_damping_N_s_per_mm", limit(session.limits.mostDamping_N_s_per_mm)},
              {"max_stiffness_N_per_mm", limit(session.limits.mostStiffness_N_per_mm)},
              {"force_delay_ticks", session.limits.forceDelay_ticks},
              {"hand_held", session.limits.handHeld},
              {"buttons", session.limits.buttons},
              {"map_scale", session.map.scale},
              {"map_offset", {session.map.offset.x, session.map.offset.y, session.map.offset.z}},
              {"passivity", nullptr}};
  for (const auto& [name, mode] : kPassivityModes)
    if (session.passivity == mode) device["passivity"] = name;
  return device;
}

void readDevice(const Json& device, RecordedSession& session) {
  session.limits = {.peakForce_N = limit(device.at("peak_force_N")),
                    .continuousForce_N = limit(device.at("continuous_force_N")),
                    .fastest_mm_per_s = limit(device.at("fastest_mm_per_s")),
                    .mostDamping_N_s_per_mm = limit(device.at("max_damping_N_s_per_mm")),
                    .mostStiffness_N_per_mm = limit(device.value("max_stiffness_N_per_mm", Json(nullptr))),
                    .forceDelay_ticks = device.at("force_delay_ticks").get<int>(),
                    .handHeld = device.at("hand_held").get<bool>(),
                    .buttons = device.value("buttons", 0)};
  const Json& offset = device.at("map_offset");
  session.map = {.scale = device.at("map_scale").get<double>(),
                 .offset = {offset.at(0).get<double>(), offset.at(1).get<double>(), offset.at(2).get<double>()}};
  for (const auto& [name, mode] : kPassivityModes)
    if (device.at("passivity") == name) session.passivity = mode;
}

}  // namespace

std::string headerText(const RecordedSession& session) {
  SessionConfig config = session.config;
  config.model.file = std::filesystem::absolute(config.model.file).string();
  Json json{{"palpate", session.palpate},
            {"machine", session.machine},
            {"points", session.points},
            {"checksum", hex(session.checksum)},
            {"config", Json::parse(configText(config))},
            {"built", Json::parse(configText(session.built))},
            {"paintable", session.paintable},
            {"device", deviceOf(session)}};
  const std::string document =
      session.document.empty() ? std::string() : std::filesystem::absolute(session.document).string();
  if (!document.empty()) json["document"] = document;
  putBytes(json, "model_bytes", config.model.file);
  putBytes(json, "document_bytes", document);
  return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace);  // those names
}

RecordedSession parseHeader(const std::filesystem::path& log, const std::string& text) {
  try {
    const Json json = Json::parse(text);
    if (!json.contains("config"))
      throw Error("it was written by an older palpate, {}, without a configuration; replay it with that version",
                  json.value("palpate", "of unknown version"));
    RecordedSession session{.config = parseConfig(json.at("config").dump()),
                            .built = parseConfig(json.value("built", json.at("config")).dump()),
                            .paintable = json.value("paintable", false),
                            .points = json.at("points").get<std::uint64_t>(),
                            .checksum = fromHex(json.at("checksum").get<std::string>()),
                            .document = json.value("document", ""),
                            .machine = json.at("machine").get<std::string>(),
                            .palpate = json.at("palpate").get<std::string>()};
    readDevice(json.at("device"), session);
    readBytes(json, "model_bytes", session.config.model.file);
    readBytes(json, "document_bytes", session.document);
    return session;
  } catch (const std::exception& error) {  // from JSON or from the configuration
    throw FileError(log, fmt::format("does not say how to run the session again ({}); was it written by another "
                                     "palpate?",
                                     error.what()));
  }
}

void TickTap::ticked(const TraceRow& row, const DeviceState& device) noexcept {
  const EditProgress edits = edits_ && !isHeld_ ? edits_->progress() : progress_;
  const bool drops = std::exchange(progress_, edits).dropped != edits.dropped;
  sink_({.time_s = row.time_s,
         .device = device.position,
         .turn = device.turn,
         .proxy = row.proxy,
         .force_N = row.force_N,
         .edits = edits.states,
         .neighbours = row.neighbours,
         .flags = (row.contact ? LoggedTick::kContact : 0u) | (row.fresh ? LoggedTick::kFresh : 0u) |
                  (row.valid ? LoggedTick::kValid : 0u) | (row.putDown ? LoggedTick::kPutDown : 0u) |
                  (device.rendersForce ? 0u : LoggedTick::kForceless) | (drops ? LoggedTick::kEditLeftOut : 0u) |
                  (std::exchange(isCommanded_, false) ? LoggedTick::kCommand : 0u) |
                  (row.forcesOn ? 0u : LoggedTick::kForcesOff) | LoggedTick::flagsOf(device.buttons)});
}

}  // namespace palpate
