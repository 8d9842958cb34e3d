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
  CHECK(ways["build cpu"] == std::set<std::string>{"multimap", "sorted grid", "k-d tree", "dynamic k-d tree"});
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
  CHECK(ways["build cpu"] == std::set<std::string>{"multimap", "sorted grid", "k-d tree", "dynamic k-d tree"});
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
  checkEnds(0, "bench share --presses 6 --points 5000" + domain + " --json " + json, {"felt_ms", "beyond_ms"});
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
  checkEnds(1, "bench share --join nobody" + domain, {"no session named 'nobody' is served"});
}

TEST_CASE("bench refuses unknown methods and back ends, and measures only what is requested") {
  CHECK(palpate("bench step --sizes 2000 --backend quantum").code == 2);
  checkEnds(2, "bench step --sizes 2000 --method persistent", {"two-step"});
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
       {"build", "sort", "query", "step", "touch", "edit", "mesh", "splat", "coexist", "strokes", "share"})
    CHECK_MESSAGE(says(all.text, std::string("\n  ") + name), name);
  CHECK(says(edit.text, "--touched"));
  for (const char* other : {"--queues", "--resolution", "--raster", "--conditions", "--moved"})
    CHECK_MESSAGE(!says(edit.text, other), other);
  CHECK(says(build.text, "--moved"));
  CHECK_FALSE(says(build.text, "--tool"));
  CHECK(palpate("bench edit --sizes 2000 --resolution 16").code == 2);
  checkEnds(2, "bench sort --sizes 2000 --moved 0.5", {"bench sort has no option --moved"});
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
    CHECK(judgement["M12_repeatability"]["identical"] == true);
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
    if (study["damping_N_s_per_mm"] == 0.002) CHECK(study["min_energy_mJ"] > -0.1);
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

TEST_CASE("bench matter measures stirred matter and its passes on each back end") {
  if (!hasScenes()) return;
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
    checkEnds(0, fmt::format("bench read {} {} --threads {} --repeat 6 --limit 0 --json {}", las, laz, threads, json),
              {"points_per_s", "stages.waited_s"});
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
