// Tools of many points, through the program.
#include "tests/apps/program.hpp"
#include "tests/near.hpp"

namespace palpate::tool_test {

namespace {

struct ToolRow {
  DVec3 hip{0}, proxy{0}, normal{0}, force_N{0}, torque_mNm{0};
  bool contact = false;
};

std::vector<ToolRow> readToolTrace(const std::filesystem::path& file) {
  std::istringstream lines(contentOf(file));
  std::string line;
  std::getline(lines, line);
  CHECK(line.ends_with(",fresh,gpu_us,step_us,torque_x,torque_y,torque_z"));
  std::vector<ToolRow> rows;
  while (std::getline(lines, line)) {
    std::vector<double> cells;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');) cells.push_back(std::stod(cell));
    REQUIRE(cells.size() == 22);
    const auto at = [&](std::size_t i) { return DVec3(cells[i], cells[i + 1], cells[i + 2]); };
    rows.push_back({at(1), at(4), at(7), at(10), at(19), cells[14] != 0});
  }
  return rows;
}

// Straight down onto the centre of a plane, 2 mm deep, then at rest. No tick is exactly at its height.
std::string writePress(const ScratchFolder& folder) {
  std::ofstream(folder / "press.csv") << "t_s,x,y,z\n0,0,0,3.013\n0.2,0,0,-2\n0.25,0,0,-2\n";
  return (folder / "press.csv").string();
}

}  // namespace

TEST_CASE("a tool of one point leaves the trace of a point, byte for byte") {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string();
  works("make sphere -n 10000 -o " + model);
  for (const std::string backend : {"cpu", "vulkan"}) {
    std::vector<std::string> traces;
    for (const std::string tool : {"", "--tool point", "--tool pad --tool-points 1", "--tool ball --tool-points 1"}) {
      const std::string trace = (folder / "t.csv").string();
      works("touch " + model + " --path builtin:slide --rate 125 --friction 0.3 --backend " + backend + " " + tool +
            " --trace " + trace);
      traces.push_back(contentOf(trace));
    }
    for (const std::string& trace : traces) CHECK(trace == traces[0]);
  }
}

TEST_CASE("both back ends feel tools alike, the same each time, and report their torque") {
  const ScratchFolder folder;
  const std::string model = (folder / "p.ply").string(), path = writePress(folder);
  works("make plane -n 10000 -o " + model);
  for (const std::string tool : {"pad --tool-points 16", "spatula --tool-points 8 --tool-axis 0,0.3,-1"}) {
    CAPTURE(tool);
    std::vector<std::vector<ToolRow>> states;
    for (const std::string backend : {"cpu", "vulkan", "vulkan"}) {
      if (states.size() == 2 && tool.starts_with("spatula")) break;
      const std::string trace = (folder / ("t" + std::to_string(states.size()) + ".csv")).string();
      const std::string json = (folder / "t.json").string();
      works("touch " + model + " --path " + path + " --rate 500 --backend " + backend + " --tool " + tool +
            " --trace " + trace + " --json " + json);
      states.push_back(readToolTrace(trace));
      const auto report = jsonOf(json);
      CHECK(report["tool"] == tool.substr(0, tool.find(' ')));
      CHECK(report["tool_points"] == (tool.starts_with("pad") ? 16 : 8));
      double peak_mNm = 0;
      for (const ToolRow& row : states.back()) peak_mNm = std::max(peak_mNm, glm::length(row.torque_mNm));
      CHECK(report["peak_torque_mNm"] == peak_mNm);
      CHECK(report["contact_error_mm"].is_null());
    }
    if (states.size() == 3) CHECK(contentOf(folder / "t1.csv") == contentOf(folder / "t2.csv"));
    REQUIRE(states[0].size() == states[1].size());
    std::size_t touched = 0;
    for (std::size_t i = 0; i < states[0].size(); ++i) {
      const ToolRow &cpu = states[0][i], &gpu = states[1][i];
      CHECK(cpu.contact == gpu.contact);
      CHECK(glm::distance(cpu.force_N, gpu.force_N) < 1e-3);
      CHECK(glm::distance(cpu.torque_mNm, gpu.torque_mNm) < 1e-3);
      touched += gpu.contact;
      if (!gpu.contact) CHECK(glm::length(gpu.force_N) + glm::length(gpu.torque_mNm) == 0);
    }
    CHECK(touched > 50);
    // At rest the proxy represents all points: the force is 0.8 N/mm times its distance.
    const ToolRow& last = states[1].back();
    CHECK(glm::distance(0.8 * (last.proxy - last.hip), last.force_N) < 1e-3);
    CHECK(last.normal.z == near(1, 1e-4));
    const bool askew = tool.find("axis") != std::string::npos;
    CHECK((std::abs(last.torque_mNm.x) > 0.1) == askew);
  }
}

TEST_CASE("a session with a sculpting tool and friction is replayed from its log") {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string(), log = (folder / "log").string();
  works("make sphere -n 5000 -o " + model);
  for (const std::string backend : {"cpu", "vulkan"}) {
    works("touch " + model + " --tool pad --tool-points 8 --friction 0.3 --edit push --penetration 3 --rate 125" +
          " --backend " + backend + " --log " + log + " --trace " + (folder / "a.csv").string());
    works("replay " + log + " --trace " + (folder / "b.csv").string());
    CHECK(contentOf(folder / "a.csv") == contentOf(folder / "b.csv"));
  }
}

TEST_CASE("options that are incompatible with a tool are refused before a file is loaded") {
  const auto fails = [&](const std::string& arguments, const std::string& reason) {
    if (isLeftOut(arguments)) return;
    CAPTURE(arguments);
    checkEnds(2, "touch not-there.ply " + arguments, {reason});
  };
  fails("--tool hammer", "--tool");
  fails("--tool pad --tool-points 65", "--tool-points");
  fails("--tool pad --tool-points 0", "--tool-points");
  fails("--tool-points 8", "--tool pad, ball or spatula");
  fails("--tool ball --tool-size 0", "--tool-size");
  fails("--tool pad --tool-axis 0,0", "X,Y,Z");
  fails("--tool pad --tool-axis 0,0,0", "--tool-axis: is not a direction");
  fails("--tool pad --backend cuda", "--backend cuda supports only the tool point");
  fails("--tool pad --method brute", "--method brute supports only the tool point");
  fails("--tool pad --ahead on", "cannot be submitted ahead");
}

TEST_CASE("bench step measures the cost of a tool beside that of a point") {
  if (isLeftOut("bench")) {
    MESSAGE("skipped: this palpate was built without PALPATE_STUDY");
    return;
  }
  const ScratchFolder folder;
  const std::string json = (folder / "b.json").string();
  works("bench step --sizes 400 --repeat 1 --backend vulkan,cpu --method fused,direct --tool-points 1,4 --json " +
        json);
  const auto report = jsonOf(json);
  std::string ways;
  for (const auto& record : report["records"])
    if (record["input"] == "static") ways += record["way"].get<std::string>() + "; ";
  CHECK(ways == "fused; fused, pad of 1; fused, pad of 4; direct; direct, pad of 1; direct, pad of 4; ");
}

}  // namespace palpate::tool_test
