#include "haptics/session/session_config.hpp"
#include "haptics/session/session_header.hpp"
#include "tests/session/config_fault.hpp"

#include <doctest/doctest.h>

#include <limits>

namespace palpate::session_config_test {

namespace {

// No value is the default.
SessionConfig unusual() {
  return {
      .model = {.file = "a \"model\".ply", .mm_per_unit = 0.25, .normals = NormalSource::face},
      .backend = {.name = "vulkan", .method = "indirect", .deterministic = true, .ahead = false, .timesPasses = true},
      .index = {.follow = IndexFollow::rebuild, .bucketKey = BucketKey::morton, .cell_mm = 3.5},
      .surface = {.kind = SurfaceKind::sharp, .friction = 0.1, .radius_mm = 1.0 / 3},
      .tool = {.kind = ToolKind::spatula, .points = 12, .size_mm = 7, .axis = {1, 0, 1e-9}},
      .brush = BrushConfig{.kind = BrushKind::paint,
                           .yieldDepth_mm = 0.1,
                           .pushRate = 0.9,
                           .radius_mm = 2,
                           .strength = 1,
                           .falloff = 3,
                           .color = {1, 2, 255},
                           .resample = false},
      .force = {.stiffness_N_per_mm = 0.4,
                .damping_N_s_per_mm = 0,
                .maxForce_N = 2,
                .maxRise_N_per_s = 100,
                .maxSurfacePower_W = 0.5},
      .undo = {.undo = 3, .redo = 2, .memory_MiB = 5},
      .hands = {{.device = "sim", .path = "p.csv", .penetration_mm = 1, .fit = WorkspaceFit::identity},
                {.device = "dhd:1", .passivity = PassivityMode::observe, .ownScheduler = true, .rumbles = true}},
      .rate_Hz = 999.5,
      .duration_s = 1.25,
      .realtime = true};
}

std::string textFault(const std::string& text) {
  try {
    parseConfig(text);
  } catch (const ConfigError& error) {
    return error.field();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  REQUIRE_MESSAGE(at != std::string::npos, what);
  return text.replace(at, what.size(), with);
}

}  // namespace

TEST_CASE("a configuration writes a file name that is not UTF-8 with replaced characters, without an error") {
  SessionConfig config;
  config.model.file = "scan\xff.ply";
  CHECK(configText(config).find("scan\xef\xbf\xbd.ply") != std::string::npos);
  const std::string header =
      headerText({.config = config, .document = "saved\xfe.ply", .machine = "one", .palpate = "1"});
  CHECK(header.find("scan\xef\xbf\xbd.ply") != std::string::npos);
  // A log finds such a file again.
  const RecordedSession recorded = parseHeader("a.log", header);
  CHECK(recorded.config.model.file == std::filesystem::absolute("scan\xff.ply").string());
  CHECK(recorded.document == std::filesystem::absolute("saved\xfe.ply").string());
}

TEST_CASE("every configuration is unchanged by conversion to text and back") {
  CHECK(parseConfig(configText(unusual())) == unusual());
  const SessionConfig usual;
  CHECK(parseConfig(configText(usual)) == usual);
  SessionConfig boundless;
  boundless.force.maxRise_N_per_s = std::numeric_limits<double>::infinity();
  CHECK(parseConfig(configText(boundless)) == boundless);
}

TEST_CASE("fields missing in a text have their defaults") {
  CHECK(parseConfig(R"({"version": 1})") == SessionConfig{});
  SessionConfig sculpting;
  sculpting.brush.emplace();
  CHECK(parseConfig(R"({"version": 1, "brush": {}})") == sculpting);
}

TEST_CASE("a log of an earlier version replays with its former settings, unless they would change the session") {
  const std::string text = configText(unusual());
  const auto with = [&](const std::string& section, const std::string& setting) {
    return replaced(text, "\"" + section + "\": {", "\"" + section + "\": {" + setting + ",");
  };
  for (const char* value : {"null", "\"spin\"", "\"block\""})
    CHECK(parseConfig(with("backend", fmt::format("\"wait\": {}", value))) == unusual());
  for (const char* value : {"\"counting\"", "\"radix\"", "\"radix-lookback\""})
    CHECK(parseConfig(with("index", fmt::format("\"sort\": {}", value))) == unusual());
  CHECK(parseConfig(with("index", R"("cells_along_side": 0.0, "spare_slots": null)")) == unusual());
  CHECK_THROWS_WITH_AS(parseConfig(with("index", R"("cells_along_side": 64.0)")),
                       "index.cells_along_side: is 64.0; this setting was removed, and only 0 is accepted",
                       ConfigError);
  CHECK(textFault(with("index", R"("spare_slots": 77)")) == "index.spare_slots");
  CHECK(textFault(with("index", R"("wait": null)")) == "index.wait");
}

TEST_CASE("an invalid text is refused with the name of the field") {
  const std::string text = configText(unusual());
  CHECK(textFault(replaced(text, "\"version\": 1", "\"version\": 2")) == "version");
  CHECK(textFault(replaced(text, "\"friction\"", "\"frictoin\"")) == "surface.frictoin");
  CHECK(textFault(replaced(text, "\"sharp\"", "\"blunt\"")) == "surface.kind");
  CHECK(textFault(replaced(text, "\"push_rate\": 0.9", "\"push_rate\": \"much\"")) == "brush.push_rate");
  CHECK(textFault(replaced(text, "255", "256")) == "brush.color");
  CHECK(textFault(replaced(text, "255", "-1")) == "brush.color");
  CHECK(textFault(replaced(text, "\"falloff\": 3", "\"falloff\": 4294967299")) == "brush.falloff");
  CHECK(textFault(replaced(text, "\"falloff\": 3", "\"falloff\": 2.5")) == "brush.falloff");
  CHECK(textFault(replaced(text, "\"device\": \"dhd:1\"", "\"device\": 1")) == "hands[1].device");
  CHECK(textFault(replaced(text, "\"brush\": {", "\"brush\": 5, \"unused\": {")) == "brush");
  CHECK(textFault(std::string("[]")) == "config");
  CHECK(textFault(std::string("{")).find("not valid JSON") != std::string::npos);
}

TEST_CASE("a value out of bounds is refused with the name of the field") {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  CHECK(faultOf(unusual()).empty());
  const auto with = [](auto&& change) {
    SessionConfig config = unusual();
    change(config);
    return faultOf(config);
  };
  CHECK(with([](auto& c) { c.rate_Hz = 0; }) == "rate_Hz");
  CHECK(with([](auto& c) { c.rate_Hz = kNaN; }) == "rate_Hz");
  CHECK(with([](auto& c) { c.model.mm_per_unit = -1; }) == "model.mm_per_unit");
  CHECK(with([](auto& c) { c.surface.radius_mm = 0; }) == "surface.radius_mm");
  CHECK(with([](auto& c) { c.surface.friction = kNaN; }) == "surface.friction");
  CHECK(with([](auto& c) { c.tool.points = 65; }) == "tool.points");
  CHECK(with([](auto& c) { c.tool.axis = {}; }) == "tool.axis");
  CHECK(with([](auto& c) { c.brush->radius_mm = kNaN; }) == "brush.radius_mm");
  CHECK(with([](auto& c) { c.brush->falloff = 17; }) == "brush.falloff");
  CHECK(with([](auto& c) { c.force.stiffness_N_per_mm = 1e30; }) == "force.stiffness_N_per_mm");
  CHECK(with([](auto& c) { c.force.maxRise_N_per_s = 0; }) == "force.max_rise_N_per_s");
  CHECK(with([](auto& c) { c.force.maxSurfacePower_W = 0; }) == "force.max_surface_power_W");
  CHECK(with([](auto& c) { c.force.maxSurfacePower_W = kNaN; }) == "force.max_surface_power_W");
  CHECK(with([](auto& c) { c.hands[1].device.clear(); }) == "hands[1].device");
  CHECK(with([](auto& c) { c.duration_s = -1; }) == "duration_s");
}

}  // namespace palpate::session_config_test
