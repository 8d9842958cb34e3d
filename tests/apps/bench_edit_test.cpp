// palpate bench edit and bench splat: sculpting and pictures.
#include <fmt/format.h>

#include "tests/apps/program.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/own_domain.hpp"
#include "tests/says.hpp"

namespace palpate::bench_edit_test {

TEST_CASE("bench edit sculpts with tools that reach the requested number of points, and plots the cost" * kMoreInFull) {
  const ScratchFolder folder;
  const std::string json = (folder / "e.json").string(), plot = (folder / "e.png").string();
  const std::string few = (folder / "few.ply").string(), many = (folder / "many.ply").string();
  const int points = byTier(3000, 20000), repeat = byTier(5, 12);
  const std::size_t touches = byTier(1, 2);
  works(fmt::format("make sphere -n {} -o {}", points, few));
  works(fmt::format("make sphere -n {} -o {}", 3 * points, many));
  const Outcome outcome =
      palpate(fmt::format("bench edit --models {} {} --touched {} --repeat {} --limit 0 --json {} --plot {}", few, many,
                          byTier("60", "100 800"), repeat, json, plot));
  REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
  const auto edit = jsonOf(json)["edit"];
  REQUIRE(edit["costs"].size() == 2 * touches * 2);  // sizes, touched points, methods of following
  for (const auto& cost : edit["costs"]) {
    CAPTURE(cost.dump());
    CHECK(cost["edits"] == repeat);
    CHECK(cost["index_rebuilds"] == (cost["index"] == "rebuild" ? repeat : 0));
    const double asked = cost["asked"];
    CHECK(cost["touched"]["p50"].get<double>() == near(asked, 0.3));
    CHECK(cost["touched"]["min"] > 0.4 * asked);  // at every edit of the stroke
    CHECK(cost["query_us"]["p50"] > 0);
    CHECK(cost["edit_us"]["p50"] > 0);
    // In virtual time a step includes its query and its edit; resampling requests are computed after it.
    CHECK(cost["query_and_edit_us"]["p50"] > cost["edit_us"]["p50"]);
    CHECK(cost["step_us"]["p50"] > cost["query_and_edit_us"]["p50"]);
    CHECK(cost["requests_us"]["p50"] > 0);
    CHECK(cost["step_us"]["p999"] >= cost["step_us"]["p50"]);
    CHECK(cost["compactions"] == 0);
    CHECK(cost["compacting_step_us"].is_null());
    CHECK(cost["memory"]["over_plain"] > 1);
    CHECK(cost["memory"]["plain_bytes"] > 64 * cost["points"].get<double>());
  }
  // A larger brush for more points; a smaller one where they are denser.
  const auto radius = [&](std::size_t i) { return edit["costs"][i]["brush_radius_mm"].get<double>(); };
  if (inFullTier()) CHECK(radius(2) > 1.3 * radius(0));
  CHECK(radius(2 * touches) < 0.7 * radius(0));
  REQUIRE(edit["growths"].size() == 2 * touches);
  for (const auto& growth : edit["growths"]) {
    CHECK(growth["from_points"] == points);
    CHECK(growth["to_points"] == 3 * points);
    CHECK(growth["factor"] > 0);
  }
  REQUIRE(edit["crossovers"].size() == 2);
  for (const auto& crossover : edit["crossovers"]) {
    CHECK(crossover["share"] > 0);
    CHECK(crossover["share"] <= 0.06);
  }
  for (const std::string& text : {std::string("edit, costs"), std::to_string(points), std::to_string(3 * points),
                                  std::string("edit, crossovers")})
    CHECK(outcome.text.find(text) != std::string::npos);
  CHECK(std::filesystem::file_size(plot) > 20'000);
}

TEST_CASE("bench edit sculpts with every brush" * kMoreInFull) {
  const ScratchFolder folder;
  const std::vector<std::string> brushes =
      byTier<std::vector<std::string>>({"smooth", "grab"}, {"carve", "inflate", "smooth", "grab", "paint"});
  const int touched = byTier(60, 300);
  for (const std::string& brush : brushes) {
    CAPTURE(brush);
    const std::string json = (folder / (brush + ".json")).string();
    works(fmt::format("bench edit --sizes {} --touched {} --repeat {} --index incremental --edit {} --json {}",
                      byTier(3000, 10000), touched, byTier(5, 30), brush, json));
    const auto cost = jsonOf(json)["edit"]["costs"][0];
    CHECK(cost["brush"] == brush);
    CHECK(cost["touched"]["p50"].get<double>() == near(touched, 0.4));
  }
}

TEST_CASE("bench edit measures the CPU, whose index follows edits without a build") {
  const ScratchFolder folder;
  const std::string json = (folder / "cpu.json").string();
  const Outcome outcome =
      palpate("bench edit --sizes 3000 9000 --touched 60 --backend cpu --repeat 8 --limit 0 --json " + json);
  REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
  const auto edit = jsonOf(json)["edit"];
  REQUIRE(edit["costs"].size() == 2 * 2);  // sizes, methods of following
  for (const auto& cost : edit["costs"]) {
    CAPTURE(cost.dump());
    CHECK(cost["backend"] == "cpu");
    CHECK(cost["edits"] == 8);
    CHECK((cost["index_rebuilds"] > 0) == (cost["index"] == "rebuild"));
    CHECK(cost["touched"]["p50"].get<double>() == near(60, 0.5));
    CHECK(cost["edit_us"]["p50"] > 0);
    CHECK(cost["query_us"].is_null());  // part of the step
    CHECK(cost["memory"]["over_plain"] >= 1);
    CHECK(cost["memory"]["over_plain"] < 1.5);
  }
  REQUIRE(edit["growths"].size() == 2);
  CHECK(edit["growths"][0]["backend"] == "cpu");
  CHECK(outcome.text.find("edit, growths") != std::string::npos);
}

TEST_CASE("bench edit reports the cost of compactions if spare slots are few") {
  const ScratchFolder folder;
  const std::string json = (folder / "c.json").string();
  const Outcome outcome = palpate(
      "bench edit --sizes 5000 --touched 150 --index incremental --spare 50 --repeat 50 --limit 0 --json " + json);
  REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
  const auto cost = jsonOf(json)["edit"]["costs"][0];
  CHECK(cost["compactions"] > 0);
  CHECK(cost["compacting_step_us"]["n"] == cost["compactions"]);  // in virtual time
  CHECK(cost["longest_compaction_end_us"] > 0);
  CHECK(cost["compacting_step_us"]["max"] > cost["longest_compaction_end_us"].get<double>());
  CHECK(outcome.text.find("compactions") != std::string::npos);
  CHECK(outcome.text.find("compacting_step_us") != std::string::npos);
}

TEST_CASE("bench edit sculpts in real time, and refuses what it cannot measure" * kClock) {
  const ScratchFolder folder;
  const std::string json = (folder / "s.json").string(), model = (folder / "few.ply").string();
  works("make sphere -n 3000 -o " + model);
  // Few enough ticks per second that any machine keeps up with some.
  constexpr int kTicks = 50, kRate_Hz = 10;
  const std::string bench = "bench edit --models " + model + " --touched 40 --index incremental --spare 200 ";
  const Outcome outcome =
      palpate(fmt::format("{}--rate {} --duration {} --json {}", bench, kRate_Hz, kTicks / kRate_Hz, json));
  REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
  for (const char* title : {"compactions", "compacting_step_us", "longest_compaction_end_us", "stroke.held_up_edits"})
    CHECK(outcome.text.find(title) != std::string::npos);
  const auto cost = jsonOf(json)["edit"]["costs"][0];
  CAPTURE(cost.dump());
  // Edits are postponed after one that takes a busy machine long, so that there may be few.
  if (cost["compactions"] > 0) {
    CHECK(cost["compacting_step_us"]["n"] >= cost["compactions"].get<int>());
    CHECK(cost["compacting_step_us"]["p999"] <= cost["step_us"]["max"].get<double>());
    CHECK(cost["longest_compaction_end_us"] > 0);
  } else {
    MESSAGE("this machine is too busy to measure a compaction: in " << kTicks << " ticks it made "
                                                                    << cost["edits"].dump() << " edits");
    CHECK(cost["edits"] < kTicks / 2);  // too few to cause a compaction
  }
  CHECK(cost["stroke"]["held_up_edits"] <= kTicks);
  CHECK(cost["stroke"]["rate_Hz"] == kRate_Hz);
  CHECK(cost["edits"] > 0);
  CHECK(cost["edits"] <= kTicks);
  CHECK(cost["step_us"]["n"] > 0);
  CHECK(cost["step_us"]["p999"] >= cost["step_us"]["p99"]);
  CHECK(cost["stroke"]["fresh_fraction"] <= 1.0);
  CHECK(palpate("bench edit --sizes 2000 --backend cuda").code == 2);
  CHECK(palpate("bench edit build --sizes 2000").code == 2);
  CHECK(palpate("bench edit --sizes 2000 --edit hammer").code == 2);
  const Outcome fast = palpate(bench + "--rate 10000 --duration 0.05");
  if (fast.code != 0) CHECK(says(fast.text, "this machine is too slow for --rate 10000"));
  checkEnds(2, "bench edit --sizes 2000 --touched 1500", {"--touched"});
}

TEST_CASE("bench splat times every pass, and its pictures match the shapes" * kMoreInFull) {
  const ScratchFolder folder;
  const std::string json = (folder / "s.json").string();
  const int points = byTier(15000, 30000);
  const Outcome outcome =
      palpate("bench splat --raster compute,hardware --json " + json +
              byTier(" --sizes 15000 --size 256x144 --repeat 3 --shapes sphere,cube --conditions uneven",
                     " --sizes 30000 --size 320x180 --repeat 5"));
  REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
  const auto splat = jsonOf(json)["splat"];
  REQUIRE(splat["costs"].size() == 4);  // rasterisers, plain and in full light
  const std::vector<std::string> passes[] = {{"render_splat_pick", "render_splat_depth", "render_shade"},
                                             {"render_hardware_depth", "render_hardware_sums", "render_shade"}};
  for (const std::size_t raster : {0, 1}) {
    const auto cost = splat["costs"][2 * raster], lit = splat["costs"][2 * raster + 1];
    CHECK(cost["light"] == "plain");
    CHECK(lit["light"] == "full");
    for (const char* pass : {"render_occlusion", "render_cavity", "render_ground"}) {
      CHECK_FALSE(cost["passes_ms"].contains(pass));
      CHECK(lit["passes_ms"].contains(pass));
    }
    CHECK_FALSE(lit["passes_ms"].contains("render_ground_heights"));  // made once
    CHECK(cost["raster"] == (raster == 0 ? "compute" : "hardware"));
    CHECK(cost["points"] == points);
    CHECK(cost["gpu_ms"]["n"] == byTier(3, 5));
    CHECK(cost["gpu_ms"]["p50"] > 0);
    CHECK(cost["picture_ms"]["p999"] >= cost["picture_ms"]["p50"]);
    CHECK(cost["fps"] > 0);
    CHECK(cost["bytes"] > 36 * points);
    for (const std::string& pass : passes[raster]) CHECK(cost["passes_ms"].contains(pass));
  }
  for (const std::string& pass : passes[0]) {
    CAPTURE(pass);
    CHECK(splat["costs"][0]["longest_workgroup_us"][pass] > 0);
    CHECK(splat["costs"][0]["longest_workgroup_us"][pass] < 1e7);
  }
  REQUIRE(splat["qualities"].size() ==
          byTier<std::size_t>(2 * 1 * 2, 4 * 2 * 2));  // shapes, conditions and rasterisers
  for (const auto& quality : splat["qualities"]) {
    CAPTURE(quality.dump());
    const bool smooth = quality["shape"] != "cube";
    CHECK(quality["pixels"] > 500);
    CHECK(quality["hole_pixels"] == 0);
    CHECK(quality["overlap_percent"] > 97.5);
    // With few pixels per spacing, an edge error of half a pixel matters.
    CHECK(quality["depth_rms_spacings"] < (smooth ? 0.3 : 0.45));
    CHECK(quality["normal_deg"]["mean"] < 1);
    CHECK(quality["normal_deg"]["p95"] < 4);
  }
  for (const char* title : {"splat, qualities", "gpu_ms", "hole_pixels", "overlap_percent"})
    CHECK(outcome.text.find(title) != std::string::npos);
  CHECK(palpate("bench splat --size 320").code == 2);
  CHECK(palpate("bench splat --raster brush").code == 2);
  CHECK(palpate("bench splat build").code == 2);
}

TEST_CASE("bench splat compares discs and marching cubes with the same truth, in one table" * kMoreInFull) {
  const ScratchFolder folder;
  const std::string json = (folder / "w.json").string();
  const int repeat = byTier(2, 5);
  const Outcome outcome = palpate(fmt::format(
      "bench splat --light plain --sizes 20000 --shapes sphere --size 320x180 --repeat {} --samples 1 --json {} {}",
      repeat, json, byTier("--conditions uneven --mesh 24", "--mesh 24,48")));
  REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
  const auto splat = jsonOf(json)["splat"];
  std::vector<std::string> ways{"compute", "mesh 24"};
  if (inFullTier()) ways.push_back("mesh 48");
  CHECK(splat["costs"].size() == ways.size());
  REQUIRE(splat["qualities"].size() == byTier<std::size_t>(1, 2) * ways.size());  // conditions and methods
  for (std::size_t i = 0; i < splat["qualities"].size(); ++i) {
    const auto quality = splat["qualities"][i];
    CAPTURE(quality.dump());
    CHECK(quality["raster"] == ways[i % ways.size()]);
    CHECK(quality["hole_pixels"] == 0);
    CHECK(quality["overlap_percent"] > 98);
    CHECK(quality["normal_deg"]["mean"] < 1);
    const auto cost = quality["cost"];
    CHECK(cost["fps"] >= cost["fps_with_remesh"]);
    CHECK(cost["fps_with_remesh"] > 0);
    CHECK(cost["bytes"] > 0);
    CHECK(cost["made_ms"]["n"] == (quality["raster"] == "compute" ? 0 : repeat));
  }
  for (const char* title : {"splat, qualities", "cost.made_ms", "cost.fps_with_remesh", "hole_pixels"})
    CHECK(outcome.text.find(title) != std::string::npos);
  CHECK(palpate("bench splat --mesh 0").code == 2);
}

}  // namespace palpate::bench_edit_test
