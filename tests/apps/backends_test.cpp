// palpate touch with every back end, method and device that gives the same answers.
#include <algorithm>

#include "engine/io/ply_reader.hpp"
#include "tests/apps/program.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::backends_test {

TEST_CASE(
    "every query method gives the same trace, byte for byte; brute, with another summation order, the same force") {
  if (isLeftOut("two-step")) {
    MESSAGE("skipped: this palpate was built without PALPATE_STUDY");
    return;
  }
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string();
  works("make sphere -n 5000 -o " + model);
  const auto traceOf = [&](const std::string& method) {
    const std::string trace = (folder / (method + ".csv")).string(), json = (folder / (method + ".json")).string();
    works("touch " + model + " --path builtin:slide --rate 125 --method " + method + " --trace " + trace + " --json " +
          json);
    CHECK(jsonOf(json).at("method") == method);
    return trace;
  };
  const std::string fused = traceOf("fused");
  CHECK(!contentOf(fused).empty());
  for (const char* method : {"indirect", "naive", "two-step"}) {
    CAPTURE(method);
    CHECK(contentOf(traceOf(method)) == contentOf(fused));
  }
  const auto rows = readTrace(fused), brute = readTrace(traceOf("brute"));
  REQUIRE(brute.size() == rows.size());
  double worst_N = 0;
  for (std::size_t i = 0; i < rows.size(); ++i)
    worst_N = std::max(worst_N, glm::distance(rows[i].force, brute[i].force));
  CHECK(worst_N < 1e-3);
  CHECK(std::ranges::any_of(rows, &Row::contact));
}

TEST_CASE("the report says that a part is too thin for its brush, on the CPU and on the GPU") {
  const ScratchFolder folder;
  writePlate(folder / "leaf.ply", 0.8);
  std::ofstream(folder / "press.csv") << "t_s,x,y,z\n0,0,0,2\n0.05,0,0,-2\n0.2,0,0,-2\n";
  for (const std::string backend : {"cpu", "vulkan"}) {
    CAPTURE(backend);
    const Outcome outcome = palpate("touch " + (folder / "leaf.ply").string() + " --mm-per-unit 1 --edit push --path " +
                                    (folder / "press.csv").string() + " --backend " + backend + " --json " +
                                    (folder / "touch.json").string());
    REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
    CHECK(says(outcome.text, "too thin  "));
    const auto report = jsonOf(folder / "touch.json");
    CAPTURE(report.dump());
    CHECK(report["blocked_edits"] > 100);
    CHECK(report["blocked_moves"] > 20 * report["blocked_edits"].get<int>());
  }
  const std::string ball = (folder / "ball.ply").string();
  works("make sphere -n 20000 -o " + ball);
  works("touch " + ball + " --backend cpu --edit push --json " + (folder / "touch.json").string());
  CHECK(jsonOf(folder / "touch.json")["blocked_moves"] == 0);
}

TEST_CASE("CPU and GPU give the same forces for the same press, on a static and on a sculpted cloud") {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string();
  works("make sphere -n 15000 -o " + model);
  for (const std::string edit : {"", " --edit push --no-resample --penetration 3"}) {
    CAPTURE(edit);
    std::vector<Row> traces[2];
    std::size_t moved[2] = {0, 0};
    for (const int k : {0, 1}) {
      const std::string backend = k == 0 ? "vulkan" : "cpu";
      const auto trace = folder / (backend + ".csv"), json = folder / (backend + ".json");
      works("touch " + model + edit + " --rate 500 --backend " + backend + " --trace " + trace.string() + " --json " +
            json.string());
      traces[k] = readTrace(trace);
      moved[k] = jsonOf(json)["moved_points"];
      CHECK(jsonOf(json)["backend"] == backend);
      CHECK(jsonOf(json)["contact_error_mm"] < 0.001);
    }
    REQUIRE(traces[0].size() == traces[1].size());
    double worst_N = 0;
    std::size_t touched = 0;
    for (std::size_t i = 0; i < traces[0].size(); ++i) {
      worst_N = std::max(worst_N, glm::distance(traces[0][i].force, traces[1][i].force));
      touched += traces[1][i].contact;
      CHECK(traces[0][i].contact == traces[1][i].contact);
    }
    CHECK(touched > 100);
    CHECK(worst_N < 1e-3);
    CHECK((moved[1] > 0) == !edit.empty());
    CHECK(std::abs(static_cast<double>(moved[0]) - static_cast<double>(moved[1])) < 5);
  }
}

TEST_CASE("the CPU back end needs no GPU except for pictures, sculpts and saves, and repeats byte for byte") {
  const ScratchFolder folder;
  const std::string model = (folder / "torus.ply").string();
  works("make torus -n 5000 -o " + model);
  for (const std::string run : {"a", "b"})
    works("touch " + model +
          " --gpu 'no such card' --backend cpu --path builtin:slide --rate 500 --edit push --yield-depth 0.3 --trace " +
          (folder / (run + ".csv")).string() + " --save " + (folder / (run + ".ply")).string() +
          (run == "a" ? " --threads 1" : " --threads 3"));
  CHECK(contentOf(folder / "a.csv") == contentOf(folder / "b.csv"));
  CHECK(contentOf(folder / "a.ply") == contentOf(folder / "b.ply"));
  CHECK(readPly(folder / "a.ply").positions != readPly(model).positions);
  works("touch " + model + " --backend cpu --bucket-key morton --cell 1.6 --edit push --realtime --picture " +
        (folder / "p.png").string() + " --size 320x200 --validate=core");
  CHECK(contentOf(folder / "p.png").starts_with("\x89PNG"));
}

TEST_CASE("a simulated Touch presses, slides and rests, the same each time, without energy gain") {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string(), json = (folder / "t.json").string();
  works("make sphere -n 20000 -o " + model);
  for (const std::string backend : {"cpu", "vulkan"}) {
    CAPTURE(backend);
    for (const std::string run : {"a.csv", "b.csv"})
      works("touch " + model + " --device sim --backend " + backend + " --trace " + (folder / run).string() +
            " --json " + json);
    CHECK(contentOf(folder / "a.csv") == contentOf(folder / "b.csv"));
    const auto rows = readTrace(folder / "a.csv");
    CHECK(rows.front().force == DVec3(0));
    // The simulated hand aims 2 mm deep and yields: its own 0.4 N/mm against the surface's 0.8.
    CHECK(rows.back().penetration_mm > 0.3);
    CHECK(rows.back().penetration_mm < 1);
    CHECK(glm::length(rows.back().force) == near(0.8 * rows.back().penetration_mm, 0.01));
    const auto result = jsonOf(json);
    CHECK(result["passivity_energy_mJ"] > -0.1);
    std::size_t counted = 0;
    for (const std::size_t ticks : result["tick_histogram_us"]["ticks"]) counted += ticks;
    CHECK(counted == rows.size());
    CHECK(result["safety"]["errors"] == 0);
  }
  works("touch " + model +
        " --device sim --path builtin:scan --hand-stiffness 0.8 --hand-damping 0.004 --map identity "
        "--passivity observe --backend cpu --duration 0.3 --realtime --rate 4000 --json " +
        json);
  CHECK(jsonOf(json)["ticks"].get<int>() + jsonOf(json)["missed_ticks"].get<int>() == 1201);
  works("touch " + model + " --backend cpu --json " + json);
  CHECK(jsonOf(json)["passivity_energy_mJ"].is_null());
}

TEST_CASE("a bench or a method that this palpate was built without is refused with the option that it needs") {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string();
  works("make sphere -n 1000 -o " + model);
  for (const std::string& command : {std::string("bench sort --sizes 1000 --repeat 1 --backend vulkan"),
                                     "touch " + model + " --duration 0.1 --method two-step"}) {
    CAPTURE(command);
    const Outcome outcome = palpate(command);
    CHECK(outcome.code == (isLeftOut(command) ? 2 : 0));
    CHECK((outcome.text.find("needs PALPATE_STUDY") != std::string::npos) == isLeftOut(command));
  }
}

TEST_CASE("a missing back end and an unknown method are reported differently") {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string();
  works("make sphere -n 5000 -o " + model);
  const Outcome cuda = palpate("touch " + model + " --backend cuda --method graph");
  if (cuda.code != 0) {
    CHECK(cuda.code == 1);
    CHECK(cuda.text.find("CUDA") != std::string::npos);
  }
  const Outcome wrong = palpate("touch " + model + " --backend cuda --method nothing");
  CHECK(wrong.code == 2);
  CHECK(wrong.text.find("array-dp") != std::string::npos);
  CHECK(palpate("touch " + model + " --method naive-dp").code == 2);
}

}  // namespace palpate::backends_test
