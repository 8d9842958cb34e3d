// palpate bench: its measurements, output and errors.
#include <fmt/format.h>

#include <map>
#include <set>

#include "tests/apps/program.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/own_domain.hpp"
#include "tests/says.hpp"

namespace palpate::bench_test {

TEST_CASE("bench measures every job with every method of the requested back ends, and plots them" * kFull) {
  const ScratchFolder folder;
  const std::string json = (folder / "b.json").string(), plot = (folder / "b.png").string();
  const Outcome outcome =
      palpate("bench build sort query step --sizes 1000 2000 --backend vulkan,cpu --repeat 5 --json " + json +
              " --plot " + plot);
  REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
  std::map<std::string, std::set<std::string>> ways;  // by bench and back end
  const auto result = jsonOf(json);
  for (const auto& record : result["records"]) {
    CAPTURE(record.dump());
    const auto& time = record["wall_us"].is_null() ? record["gpu_us"] : record["wall_us"];
    CHECK(time["n"] == 5);
    CHECK(time["p50"] > 0);
    CHECK(time["p999"] >= time["p50"]);
    CHECK((record["points"] == 1000 || record["points"] == 2000));
    ways[record["bench"].get<std::string>() + " " + record["backend"].get<std::string>()].insert(record["way"]);
  }
  CHECK(ways["build vulkan"].contains("radix"));
  CHECK(ways["build vulkan"].contains("counting"));
  CHECK(ways["build cpu"] == std::set<std::string>{"multimap", "sorted grid", "k-d tree"});
  CHECK(ways["sort vulkan"].contains("radix"));
  for (const char* bench : {"query vulkan", "step vulkan"})
    CHECK(ways[bench] == std::set<std::string>{"brute", "two-step", "naive", "indirect", "fused"});
  CHECK(ways["step cpu"] == std::set<std::string>{"direct"});
  for (const char* title : {"step, vulkan, static, in all", "step, vulkan, edited, in all", "build, cpu, last order"})
    CHECK(outcome.text.find(title) != std::string::npos);
  CHECK(std::filesystem::file_size(plot) > 20'000);
}

TEST_CASE("bench measures several jobs at once with the requested methods, and plots them") {
  const ScratchFolder folder;
  const std::string json = (folder / "b.json").string(), plot = (folder / "b.png").string();
  const Outcome outcome =
      palpate("bench build sort query step --sizes 1000 --backend vulkan,cpu --method fused,direct --repeat 1 --json " +
              json + " --plot " + plot);
  REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
  std::map<std::string, std::set<std::string>> ways;  // by bench and back end
  const auto result = jsonOf(json);
  for (const auto& record : result["records"]) {
    CAPTURE(record.dump());
    const auto& time = record["wall_us"].is_null() ? record["gpu_us"] : record["wall_us"];
    CHECK(time["n"] == 1);
    CHECK(time["p50"] > 0);
    CHECK(record["points"] == 1000);
    ways[record["bench"].get<std::string>() + " " + record["backend"].get<std::string>()].insert(record["way"]);
  }
  CHECK(ways["build vulkan"].contains("radix"));
  CHECK(ways["build vulkan"].contains("counting"));
  CHECK(ways["build cpu"] == std::set<std::string>{"multimap", "sorted grid", "k-d tree"});
  CHECK(ways["sort vulkan"].contains("radix"));
  for (const char* bench : {"query vulkan", "step vulkan"}) CHECK(ways[bench] == std::set<std::string>{"fused"});
  CHECK(ways["step cpu"] == std::set<std::string>{"direct"});
  for (const char* title : {"step, vulkan, static, in all", "step, vulkan, edited, in all", "build, cpu, last order"})
    CHECK(outcome.text.find(title) != std::string::npos);
  CHECK(std::filesystem::file_size(plot) > 20'000);
  works("bench build sort --sizes 1000 2000 --backend vulkan --repeat 1 --json " + json);
  std::multiset<std::string> sizes;  // by bench
  for (const auto& record : jsonOf(json)["records"])
    sizes.insert(record["bench"].get<std::string>() + " " + record["points"].dump());
  for (const char* bench : {"build", "sort"})
    for (const char* size : {" 1000", " 2000"}) CHECK(sizes.count(std::string(bench) + size) > 0);
}

TEST_CASE("bench share measures the time until another hand feels a press" * kClock) {
  const ScratchFolder folder;
  const std::string domain = " --domain " + std::to_string(ownDomain());
  if (palpate("doctor --network" + domain).code != 0) {
    MESSAGE("skipped: this palpate was built without PALPATE_NETWORK");
    return;
  }
  const std::string json = (folder / "s.json").string();
  const Outcome outcome = palpate("bench share --presses 6 --points 5000" + domain + " --json " + json);
  REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
  CHECK(says(outcome.text, "felt p50 / p99 ms"));
  const Result share = jsonOf(json)["share"][0];
  CAPTURE(share.dump());
  CHECK(share["felt_ms"]["n"].get<int>() + share["unsteady"].get<int>() + share["not_felt"].get<int>() +
            share["not_pressed"].get<int>() ==
        6);
  CHECK(share["felt_ms"]["n"] >= 3);
  CHECK(share["felt_ms"]["min"] > 0);
  CHECK(share["beyond_ms"]["p50"] < share["goal_ms"].get<double>());
  CHECK(share["round_trip_ms"] > 0);
  CHECK(share["ticks"] > 500);
  CHECK(share["aged_ticks"] == 0);
  CHECK(share["same"] == true);
  const Outcome none = palpate("bench share --join nobody" + domain);
  CHECK(none.code == 1);
  CHECK(says(none.text, "no session named 'nobody' is served"));
}

TEST_CASE("bench refuses unknown methods and back ends, and measures only what is requested") {
  CHECK(palpate("bench step --sizes 2000 --backend quantum").code == 2);
  const Outcome wrong = palpate("bench step --sizes 2000 --method persistent");
  CHECK(wrong.code == 2);
  CHECK(wrong.text.find("two-step") != std::string::npos);
  const Outcome brute = palpate("bench query --sizes 2000 --method brute --repeat 5");
  CHECK(brute.code == 0);
  CHECK(brute.text.find("brute") != std::string::npos);
  CHECK(brute.text.find("fused") == std::string::npos);
}

TEST_CASE("each bench shows and accepts its own options, and benches run together accept each other's") {
  const Outcome all = palpate("bench --help"), edit = palpate("bench edit --help"),
                build = palpate("bench build --help");
  CHECK(all.code == 0);
  for (const char* name :
       {"build", "sort", "query", "step", "touch", "edit", "mesh", "splat", "coexist", "locality", "share"})
    CHECK_MESSAGE(says(all.text, std::string("\n  ") + name), name);
  CHECK(says(edit.text, "--touched"));
  for (const char* other : {"--queues", "--lattice", "--raster", "--conditions", "--moved"})
    CHECK_MESSAGE(!says(edit.text, other), other);
  CHECK(says(build.text, "--moved"));
  CHECK_FALSE(says(build.text, "--tool"));
  CHECK(palpate("bench edit --sizes 2000 --lattice 16").code == 2);
  const Outcome alone = palpate("bench sort --sizes 2000 --moved 0.5");
  CHECK(alone.code == 2);
  CHECK(says(alone.text, "bench sort has no option --moved"));
  works("bench build sort --sizes 2000 --backend cpu --repeat 5 --moved 0.5");  // an option of build, after sort
  works("bench sort --sizes 2000 build --backend cpu --repeat 5 --moved 0.5");
}

TEST_CASE("bench touch judges the force: none in the air, equal in two runs, along the true normal") {
  const ScratchFolder folder;
  works("bench touch --backend cpu --sizes 5000 --shapes sphere,cube --conditions clean,uneven --json " +
        (folder / "t.json").string());
  const auto touch = jsonOf(folder / "t.json")["touch"];
  REQUIRE(touch["judgements"].size() == 4 * 3);  // shapes and conditions, for every surface
  for (const auto& judgement : touch["judgements"]) {
    for (const char* key : {"surface", "subject", "condition", "M7_step_us", "M10_friction", "M11_edit", "slide_N"})
      CHECK_MESSAGE(judgement.contains(key), key);
    CHECK(judgement["M8_free_force_N"] == 0.0);
    CHECK(judgement["M12_sameness"]["identical"] == true);
    REQUIRE(judgement["slides"].size() == 3);
    for (const auto& slide : judgement["slides"])
      for (const char* key : {"M1_angle_deg", "M2_height", "M3_force_relative_rms", "M4_continuity", "M6_lag"})
        CHECK_MESSAGE(slide.contains(key), key);
  }
  const auto sphere = touch["judgements"][0];
  const double radius = sphere["radius_mm"];
  CHECK(sphere["slides"][1]["held_share"] == 1.0);
  CHECK(sphere["slides"][1]["M1_angle_deg"]["max"] < 1);
  CHECK(sphere["slides"][1]["M2_height"]["bias_mm"].get<double>() == near(-0.0694 * radius * radius / 50, 0.1));
  CHECK(sphere["M11_edit"]["ticks_until_equal"] == 0);
  CHECK(touch["M5_plates"].size() == 3 * 15);
  CHECK(touch["M5_plates"].back()["through_share"] == 0.0);
  CHECK(touch["M9_stability"].size() == 24);
  for (const auto& study : touch["M9_stability"]) {
    CHECK(study["largest_stiffness_N_per_mm"] > 0.4);
    // Without damping, or with much damping and old data, a late loop generates energy; with the usual damping it does
    // not.
    if (study["damping_N_s_per_mm"] == 0.002) CHECK(study["least_energy_mJ"] > -0.1);
  }
}

TEST_CASE("bench touch judges normals estimated from noisy points") {
  const ScratchFolder folder;
  const std::string result = (folder / "t.json").string();
  works(
      "bench touch --backend cpu --quick --sizes 20000 --shapes torus --surface average --conditions "
      "noise-0.25,noise-0.25-estimated --json " +
      result);
  const auto judgements = jsonOf(result)["touch"]["judgements"];
  REQUIRE(judgements.size() == 2);
  const auto p95 = [&](std::size_t i) { return judgements[i]["slides"][0]["M1_angle_deg"]["p95"].get<double>(); };
  CHECK(judgements[1]["condition"] == "noise-0.25-estimated");
  CHECK(p95(1) > p95(0));
  CHECK(p95(1) < 6);
}

TEST_CASE("bench touch compares a scan with its mesh, and refuses one without the other") {
  const ScratchFolder folder;
  const std::string scan = (folder / "scan.ply").string(), mesh = (folder / "mesh.ply").string();
  works("make plane -n 20000 -o " + scan);
  std::ofstream(mesh)
      << "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
         "-50 -50 0\n50 -50 0\n50 50 0\n-50 50 0\n4 0 1 2 3\n";
  works("bench touch --backend cpu --quick --models " + scan + " --truth " + mesh + " --json " +
        (folder / "t.json").string());
  const auto judgement = jsonOf(folder / "t.json")["touch"]["judgements"][0];
  CHECK(judgement["subject"] == "scan");
  CHECK(judgement["slides"][0]["M3_force_relative_rms"] < 1e-3);
  CHECK(palpate("bench touch --backend cpu --models " + scan).code == 2);
  CHECK(palpate("bench touch build --backend cpu").code == 2);
  CHECK(palpate("bench touch --shapes ball").code == 2);
}

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
    CHECK(cost["builds"] == (cost["index"] == "rebuild" ? repeat : 0));
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
  const auto radius = [&](std::size_t i) { return edit["costs"][i]["tool_radius_mm"].get<double>(); };
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
  for (const std::string& text : {std::string("edited step, push"), std::to_string(points), std::to_string(3 * points),
                                  std::string("a full build is cheaper")})
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
  CHECK(outcome.text.find("step that compacts") != std::string::npos);
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
  for (const char* title : {"compactions", "step meanwhile", "longest end", "held up"})
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
  CHECK(cost["stroke"]["fresh_share"] <= 1.0);
  CHECK(palpate("bench edit --sizes 2000 --backend cpu").code == 2);
  CHECK(palpate("bench edit build --sizes 2000").code == 2);
  CHECK(palpate("bench edit --sizes 2000 --edit hammer").code == 2);
  const Outcome fast = palpate(bench + "--rate 10000 --duration 0.05");
  if (fast.code != 0) CHECK(says(fast.text, "this machine is too slow for --rate 10000"));
  const Outcome tooMany = palpate("bench edit --sizes 2000 --touched 1500");
  CHECK(tooMany.code == 2);
  CHECK(tooMany.text.find("--touched") != std::string::npos);
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
  REQUIRE(splat["costs"].size() == 2);
  const std::vector<std::string> passes[] = {{"render_splat_pick", "render_splat_depth", "render_shade"},
                                             {"render_hardware_depth", "render_hardware_sums", "render_shade"}};
  for (const std::size_t raster : {0, 1}) {
    const auto cost = splat["costs"][raster];
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
  for (const char* title : {"against truth", "all passes, ms", "holes", "overlap"})
    CHECK(outcome.text.find(title) != std::string::npos);
  CHECK(palpate("bench splat --size 320").code == 2);
  CHECK(palpate("bench splat --raster brush").code == 2);
  CHECK(palpate("bench splat build").code == 2);
}

TEST_CASE("bench splat compares discs and marching cubes with the same truth, in one table" * kMoreInFull) {
  const ScratchFolder folder;
  const std::string json = (folder / "w.json").string();
  const int repeat = byTier(2, 5);
  const Outcome outcome = palpate(
      fmt::format("bench splat --sizes 20000 --shapes sphere --size 320x180 --repeat {} --samples 1 --json {} {}",
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
    CHECK(cost["fps"] >= cost["fps_made_anew"]);
    CHECK(cost["fps_made_anew"] > 0);
    CHECK(cost["bytes"] > 0);
    CHECK(cost["made_ms"]["n"] == (quality["raster"] == "compute" ? 0 : repeat));
  }
  for (const char* title : {"splat and mesh", "mesh made, ms", "fps, remeshed", "holes"})
    CHECK(outcome.text.find(title) != std::string::npos);
  CHECK(palpate("bench splat --mesh 0").code == 2);
}

TEST_CASE("bench matter measures stirred matter and its passes on each back end") {
  const ScratchFolder folder;
  const std::string json = (folder / "matter.json").string();
  works("bench matter --sizes 200 --backend vulkan,cpu --repeat 2 --passes --json " + json);
  const auto records = jsonOf(json)["matter"];
  REQUIRE(records.size() == 4);
  for (const auto& record : records) {
    CHECK(record["particles"] > 150);
    CHECK(record["step"]["wall_us"]["p999"] >= record["step"]["wall_us"]["p50"]);
    const double steps = record["step"]["wall_us"]["p50"], substeps = record["substep"]["wall_us"]["p50"];
    CHECK(substeps * record["substeps"].get<double>() == near(steps, 1e-6));
    const bool onGpu = record["backend"] == "vulkan";
    CHECK(record["step"]["gpu_us"].is_null() == !onGpu);
    CHECK(record["passes_us"].contains("matter_list") == onGpu);
    CHECK(record["passes_bytes"].contains("matter_list") == onGpu);
    if (!onGpu) continue;
    const char* const pass = record["matter"] == "water" ? "matter_compress" : "matter_rub";
    const double particles = record["particles"], moved = record["passes_bytes"][pass]["moved"];
    // A list of 32 words and a length, a position and the result; or a list of 8, and 6 contacts that are read and
    // written.
    CHECK(moved / particles == near(record["matter"] == "water" ? 164 : 304, 1e-6));
    CHECK(record["passes_bytes"][pass]["asked"] > moved);
    for (const char* name :
         {"matter_predict", "matter_count", "matter_scan", "matter_place", "matter_sort", "matter_list", pass}) {
      CHECK(record["passes_us"].contains(name));
      CHECK(record["passes_bytes"][name]["moved"] > 0);
    }
  }
  works("bench matter --matter soft --sizes 300 --points 500 --backend vulkan,cpu --repeat 2 --passes --json " + json);
  const auto soft = jsonOf(json)["matter"];
  REQUIRE(soft.size() == 2);
  for (const auto& record : soft) {
    const bool onGpu = record["backend"] == "vulkan";
    CHECK(record["particles"] > 200);
    CHECK(record["particles"] < 450);
    CHECK(record["frame"]["points"] >= 500);
    CHECK(record["frame"]["points"] < 700);
    CHECK(record["frame"]["gpu_us"].is_null() == !onGpu);
    CHECK(record["frame"]["fetched_us"]["n"] == 2);
    CHECK(record["passes_us"].contains("matter_soft_cells") == onGpu);
    CHECK(record["passes_us"].contains("matter_soft_carry") == onGpu);
  }
  works("bench matter --matter soft --sizes 120 --presses 2 --backend vulkan,cpu --repeat 1 --passes --json " + json);
  for (const auto& record : jsonOf(json)["matter"]) {
    CHECK(record["presses"] == 2);
    CHECK(record["compliance"]["wall_us"]["p50"] > 0);
    CHECK(record["passes_us"].contains("matter_soft_press") == (record["backend"] == "vulkan"));
  }
  CHECK(palpate("bench matter --matter water --presses 1").code == 2);
  CHECK(palpate("bench matter --matter lava").code == 2);
  CHECK(palpate("bench matter --points -1").code == 2);
}

TEST_CASE("bench read reads the given files on the requested number of threads") {
  const ScratchFolder folder;
  const std::string las = (folder / "a.las").string(), laz = (folder / "a.laz").string(),
                    json = (folder / "r.json").string();
  works("make sphere -n 60000 -o " + las);
  works("convert " + las + " " + laz);
  for (const int threads : {1, 3}) {
    const Outcome outcome = palpate(
        fmt::format("bench read {} {} --threads {} --repeat 6 --limit 0 --stages --json {}", las, laz, threads, json));
    REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
    CHECK(says(outcome.text, "M points/s"));
    CHECK(says(outcome.text, "waited for memory"));
    const auto records = jsonOf(json)["read"];
    REQUIRE(records.size() == 2);
    CHECK(records[0]["format"] == "LAS");
    CHECK(records[1]["format"] == "LAZ");
    for (const auto& record : records) {
      CHECK(record["points"] == 60'000);
      CHECK(record["threads"] == threads);
      CHECK(record["bytes"] == std::filesystem::file_size(record["file"].get<std::string>()));
      CHECK(record["time_s"]["n"] == 6);
      const auto& stages = record["stages"];
      double all_s = 0;
      for (const char* stage : {"open_s", "points_s", "finish_s", "free_s"}) {
        CHECK(stages[stage].get<double>() > 0);
        all_s += stages[stage].get<double>();
      }
      CHECK(all_s < 2 * record["time_s"]["max"].get<double>());
      CHECK(stages["waited_s"].get<double>() <= threads * record["time_s"]["max"].get<double>());
      if (threads == 1) CHECK(stages["waited_s"] == 0);
      const double once_s = record["time_s"]["p50"];
      CHECK(record["points_per_s"].get<double>() == near(60'000 / once_s, 1e-6));
      CHECK(record["bytes_per_s"].get<double>() == near(record["bytes"].get<double>() / once_s, 1e-6));
    }
  }
  CHECK(palpate("bench read").code == 2);
  const Outcome none = palpate("bench read " + (folder / "none.las").string());
  CHECK(none.code == 1);
  CHECK(says(none.text, "none.las"));
}

}  // namespace palpate::bench_test
