// Water and sand under a hand, through the program.
#include <cmath>

#include "engine/io/ply_reader.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::matter_test {

namespace {

// As deep as wide, with a ball of the water's density.
constexpr const char* kTank =
    R"({"matter": "water", "box_mm": [80, 130, 80], "fill_mm": [80, 80, 80], "spacing_mm": 10,
        "tool": {"radius_mm": 20, "mass_kg": 0.0335}})";

}  // namespace

TEST_CASE("a ball that dives into water is lifted by the displaced water, the same each time, and replayed") {
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  std::ofstream(in("tank.json")) << kTank;
  std::ofstream(in("dive.csv")) << "t_s,x,y,z\n0,40,125,40\n0.4,40,40,40\n0.9,40,40,40\n";
  const auto touched = [&](const std::string& options) {
    works("touch " + in("tank.json") + " --path " + in("dive.csv") + " --backend cpu --trace " + in("t.csv") +
          " --json " + in("r.json") + " --save " + in("s.ply") + " " + options);
    return contentOf(in("t.csv")) + contentOf(in("s.ply"));
  };
  const std::string first = touched("--log " + in("log"));
  double lift_N = 0, across_N = 0;
  int ticks = 0;
  for (const Row& row : readTrace(in("t.csv"))) {
    if (row.t_s < 0.02) CHECK(row.force == DVec3(0));
    if (row.t_s < 0.7) continue;
    lift_N += row.force.y;
    across_N += row.force.x + row.force.z;
    ++ticks;
  }
  CHECK(lift_N / ticks == near(0.0335 * 9.81, 0.1));
  CHECK(std::abs(across_N / ticks) < 0.03);
  const auto report = jsonOf(in("r.json"));
  CHECK(report["points"] == 512);
  CHECK(report["moved_points"] > 500);
  CHECK(report["matter"]["kind"] == "water");
  CHECK(report["matter"]["dropped_s"] == 0);
  CHECK(report["matter"]["advances"] == report["ticks"]);  // one step per tick, in virtual time
  CHECK(report["peak_torque_mNm"] > 0);
  CHECK(report["matter"]["gain"] == 1);
  const double coupling_N_mm = 1e-3 * 0.0335 * std::pow(2 * 3.14159265 * 30, 2);  // of a ball on its spring at 30 Hz
  CHECK(report["matter"]["coupling_N_mm"].get<double>() == near(coupling_N_mm, 1e-6));
  CHECK(report["contact_error_mm"].is_null());
  CHECK(readPly(in("s.ply")).size() == 512);
  CHECK(touched("--threads 1") == first);
  works("replay " + in("log"));
  std::filesystem::remove(in("tank.json"));
  works("replay " + in("log"));  // the log contains the scene
}

TEST_CASE("both back ends give the same forces in the same water") {
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  std::ofstream(in("tank.json")) << kTank;
  std::ofstream(in("dive.csv")) << "t_s,x,y,z\n0,40,105,40\n0.1,40,85,40\n";
  const auto touched = [&](const std::string& backend) {
    works("touch " + in("tank.json") + " --path " + in("dive.csv") + " --backend " + backend + " --trace " +
          in("t.csv") + " --json " + in("r.json"));
    CHECK(jsonOf(in("r.json"))["backend"] == backend);
    return readTrace(in("t.csv"));
  };
  const auto gpu = touched("vulkan"), cpu = touched("cpu");
  REQUIRE(gpu.size() == cpu.size());
  double most_N = 0;
  for (std::size_t i = 0; i < cpu.size(); ++i) {
    CHECK(glm::distance(gpu[i].force, cpu[i].force) < 2e-3);
    most_N = std::max(most_N, glm::length(cpu[i].force));
  }
  CHECK(most_N > 0.05);
}

TEST_CASE("built-in scenes are described, drawn and stirred by two hands") {
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  works("info dam --json " + in("i.json"));
  const auto info = jsonOf(in("i.json"));
  CHECK(info["particles"] == 1000);
  CHECK(info["matter"] == "water");
  CHECK(info["tool"]["radius_mm"] == 20);
  CHECK(info["bytes"] > 100'000);
  works("render sand --size 200x150 -o " + in("sand.png"));
  CHECK(Picture(in("sand.png")).rgb.size() == 200 * 150 * 3);
  works("touch dam --path builtin:stir --duration 0.3 --hand path=builtin:press,trace=" + in("second.csv") +
        " --backend cpu --trace " + in("t.csv"));
  CHECK(readTrace(in("t.csv")).size() == 301);
  CHECK(readTrace(in("second.csv")).size() == 301);
}

TEST_CASE("a soft body is described, felt on both back ends, saved with its dent, and replayed") {
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  std::ofstream(in("block.json")) << R"({"matter": "soft", "box_mm": [100, 80, 100], "fill_mm": [40, 30, 40],
                                         "spacing_mm": 10, "young_Pa": 30000})";
  works("info " + in("block.json") + " --json " + in("i.json"));
  const auto info = jsonOf(in("i.json"));
  CHECK(info["particles"] == 5 * 4 * 5);
  CHECK(info["young_Pa"] == 30000);
  CHECK(info["points"] > 500);
  std::ofstream(in("press.csv")) << "t_s,x,y,z\n0,50,31,50\n0.1,50,25,50\n0.15,50,25,50\n";
  const auto touched = [&](const std::string& backend) {
    works("touch " + in("block.json") + " --path " + in("press.csv") + " --rate 500 --backend " + backend +
          " --trace " + in("t.csv") + " --json " + in("r.json") + " --save " + in("s.ply") + " --log " + in("log"));
    const auto report = jsonOf(in("r.json"));
    CHECK(report["backend"] == backend);
    CHECK(report["matter"]["kind"] == "soft");
    CHECK(report["matter"]["coupling_N_mm"].is_null());
    CHECK(report["points"] == info["points"]);
    works("replay " + in("log"));
    return readTrace(in("t.csv"));
  };
  const auto gpu = touched("vulkan"), cpu = touched("cpu");
  REQUIRE(gpu.size() == cpu.size());
  for (std::size_t i = 0; i < cpu.size(); ++i) CHECK(glm::distance(gpu[i].force, cpu[i].force) < 0.05);
  CHECK(cpu.back().force.y > 0.3);
  const PointCloud dented = readPly(in("s.ply"));
  CHECK(dented.size() == info["points"]);
  CHECK(boundsOf(dented).max.y < 32);
}

TEST_CASE("a soft body is sculpted, undone and replayed, and its material is reported") {
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  std::ofstream(in("block.json")) << R"({"matter": "soft", "box_mm": [100, 80, 100], "fill_mm": [40, 30, 40],
                                         "spacing_mm": 5, "young_Pa": 8000})";
  const auto said = [](const std::string& arguments) {
    const Outcome outcome = palpate(arguments);
    CHECK_MESSAGE(outcome.code == 0, outcome.text);
    return outcome.text;
  };
  const std::string info = said("info " + in("block.json") + " --json " + in("i.json"));
  CHECK(info.find("Young's modulus 8000 Pa") != std::string::npos);
  CHECK(jsonOf(in("i.json"))["young_Pa"] == 8000);
  const std::string simulated = said("simulate " + in("block.json") + " --duration 0.05");
  CHECK(simulated.find("Young's modulus 8000 Pa") != std::string::npos);
  std::ofstream(in("press.csv")) << "t_s,x,y,z\n0,50,31,50\n0.1,50,25,50\n0.3,50,25,50\n0.35,50,40,50\n0.6,50,40,50\n";
  const auto top = [&](const std::string& more) {
    const std::string report = said("touch " + in("block.json") + " --path " + in("press.csv") +
                                    " --backend cpu --edit push --brush-radius 10 --yield-depth 0.1" + " --json " +
                                    in("r.json") + " --save " + in("s.ply") + " --log " + in("log") + more);
    CHECK(report.find("Young's modulus 8000 Pa") != std::string::npos);
    CHECK(jsonOf(in("r.json"))["shape_strokes"] == 1);
    works("replay " + in("log"));
    float lowest = 100;
    for (const Vec3& position : readPly(in("s.ply")).positions)
      if (position.y > 20 && std::abs(position.x - 50) < 4 && std::abs(position.z - 50) < 4)
        lowest = std::min(lowest, position.y);
    return lowest;
  };
  const float dented = top(""), undone = top(" --undo 1");
  CHECK(undone > 28);
  CHECK(dented < undone - 0.8f);
}

TEST_CASE("a soft body on a GPU is sculpted, undone and replayed as on the CPU") {
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  std::ofstream(in("block.json")) << R"({"matter": "soft", "box_mm": [100, 80, 100], "fill_mm": [40, 30, 40],
                                         "spacing_mm": 10, "young_Pa": 30000})";
  std::ofstream(in("press.csv"))
      << "t_s,x,y,z\n0,50,32,50\n0.05,50,26,50\n0.12,50,26,50\n0.14,50,40,50\n0.18,50,40,50\n";
  const auto top = [&](const std::string& backend, const std::string& more) {
    const Outcome outcome =
        palpate("touch " + in("block.json") + " --path " + in("press.csv") + " --rate 500 --backend " + backend +
                " --edit push --brush-radius 10 --yield-depth 0.1 --json " + in("r.json") + " --save " + in("s.ply") +
                " --log " + in("log") + more);
    CHECK_MESSAGE(outcome.code == 0, outcome.text);
    CHECK(jsonOf(in("r.json"))["shape_strokes"] == 1);
    float lowest = 100;
    for (const Vec3& position : readPly(in("s.ply")).positions)
      if (position.y > 20 && std::abs(position.x - 50) < 4 && std::abs(position.z - 50) < 4)
        lowest = std::min(lowest, position.y);
    return lowest;
  };
  const float gpu = top("vulkan", "");
  works("replay " + in("log"));
  const float cpu = top("cpu", "");
  CHECK(gpu < 29);
  CHECK(std::abs(gpu - cpu) < 0.1f);
  CHECK(top("vulkan", " --undo 1") > gpu + 0.5f);
}

TEST_CASE("options that are incompatible with a scene are refused with the reason") {
  const ScratchFolder folder;
  const std::string bad = (folder / "bad.json").string();
  std::ofstream(bad) << R"({"matter": "water", "box_mm": [1, 1, 1], "fill_mm": [1, 1, 1], "spacing_mm": 1, "salt": 3})";
  const auto refused = [&](const std::string& arguments, int code, const std::string& text) {
    const Outcome outcome = palpate(arguments);
    CHECK_MESSAGE(outcome.code == code, outcome.text);
    CHECK_MESSAGE(outcome.text.find(text) != std::string::npos, outcome.text);
  };
  refused("touch dam --edit push", 2, "--edit: water and sand cannot be sculpted");
  refused("touch jelly --edit carve", 2, "--edit: a soft body cannot be carved, because it keeps its cells");
  refused("touch jelly --edit push --brush-radius 3", 2, "the cells of the body are 6 mm wide");
  refused("touch dam --tool ball", 2, "--tool: in matter a hand holds the scene's ball");
  refused("touch dam --motion turn", 2, "--motion: a simulated scene moves already");
  refused("touch dam --backend cuda", 2, "--backend: cuda requires a model at rest");
  refused("touch dam --fuse on", 2, "is not a recorded depth camera");
  refused("touch dam --path builtin:scan", 2, "choose press, stir");
  refused("touch " + bad, 1, bad + ": salt: unknown key 'salt'");
  refused("info " + bad, 1, bad + ": salt: unknown key 'salt'");
}

TEST_CASE("the window plays, pauses and restarts water, saves it beside the scene, and refuses a tool") {
  if (!hasDisplay()) return;
  const auto played =
      play("%/dam.json --size 480x360 --rate 500 --backend cpu", R"(
0.01 key tab
0.02 screenshot %/begin.png
0.30 screenshot %/later.png
0.32 key K
0.34 screenshot %/held.png
0.40 screenshot %/still.png
0.41 state %/held.json
0.42 key N
0.44 key K
0.48 screenshot %/again.png
0.50 key 2
0.52 state %/tool.json
0.54 key ctrl+s
0.80 state %/saved.json
0.82 quit
)",
           "", [](const std::filesystem::path& folder) {
             std::ofstream(folder / "dam.json")
                 << R"({"matter": "water", "box_mm": [200, 120, 40], "fill_mm": [60, 80, 40], "spacing_mm": 10})";
           });
  REQUIRE_MESSAGE(played->outcome.code == 0, played->outcome.text);
  const auto apart = [&](const char* one, const char* other) {
    const Picture a(played->folder / one), b(played->folder / other);
    REQUIRE(a.rgb.size() == b.rgb.size());
    // Between the texts at the top and bottom.
    std::size_t others = 0;
    for (std::size_t i = a.rgb.size() / 5; i < a.rgb.size() / 5 * 4; ++i) others += std::abs(a.rgb[i] - b.rgb[i]) > 10;
    return static_cast<double>(others) / static_cast<double>(a.rgb.size());
  };
  const double moved = apart("begin.png", "later.png");
  CHECK(moved > 0.005);
  CHECK(apart("held.png", "still.png") < 0.1 * moved);
  CHECK(apart("begin.png", "again.png") < 0.8 * apart("later.png", "again.png"));
  CHECK(played->state("held.json")["last_message"] == "the scene is paused");
  const std::string message = played->state("tool.json")["last_message"];
  CHECK_MESSAGE(message.find("cannot be sculpted") != std::string::npos, message);
  CHECK(played->state("saved.json")["save_file"] == "dam.ply");
  const PointCloud saved = readPly(played->folder / "dam.ply");
  CHECK(saved.size() == 6 * 8 * 4);
  CHECK(contentOf(played->folder / "dam.json").find("\"water\"") != std::string::npos);
}

TEST_CASE("the window changes gravity, viscosity and gain while water moves, and reports unknown parameters") {
  if (!hasDisplay()) return;
  const auto played =
      play("%/tank.json --size 320x240 --rate 500 --backend cpu", R"(
0.01 state %/begin.json
0.02 set gravity_x_m_s2 -15
0.03 set viscosity_Pa_s 2
0.10 state %/set.json
0.12 set salt 3
0.14 state %/refused.json
0.16 set gain -1
0.18 state %/bounds.json
0.60 screenshot %/tilted.png
0.62 key N
0.80 state %/reset.json
0.90 quit
)",
           "", [](const std::filesystem::path& folder) { std::ofstream(folder / "tank.json") << kTank; });
  REQUIRE_MESSAGE(played->outcome.code == 0, played->outcome.text);
  const auto begin = played->state("begin.json")["parameters"], set = played->state("set.json")["parameters"];
  CHECK(begin["gravity_x_m_s2"] == 0);
  CHECK(begin["viscosity_Pa_s"] == 1e-3);
  CHECK(begin["gain"] == 1);
  CHECK(set["gravity_x_m_s2"] == -15);
  CHECK(set["viscosity_Pa_s"] == 2);
  CHECK(set["gravity_y_m_s2"] == begin["gravity_y_m_s2"]);
  CHECK(says(played->state("refused.json")["last_message"], "salt: is not a parameter of water"));
  CHECK(says(played->state("bounds.json")["last_message"], "gain: is -1; it must be from 0 to 1000"));
  CHECK(played->state("bounds.json")["parameters"] == set);
  CHECK(says(played->state("reset.json")["last_message"], "the scene restarts"));
  CHECK(played->state("reset.json")["parameters"] == set);
}

TEST_CASE("a body in water stops the hand's ball, and is drawn and saved with the water") {
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  works("make torus -n 6000 -o " + in("ring.ply"));
  std::ofstream(in("ring.json")) << R"({"matter": "water", "box_mm": [80, 130, 80], "fill_mm": [80, 30, 80],
    "spacing_mm": 10, "model": "ring.ply", "model_mm": [60, 60, 60], "tool": {"radius_mm": 12, "mass_kg": 0.01}})";
  std::ofstream(in("down.csv")) << "t_s,x,y,z\n0,62,110,40\n0.2,62,40,40\n0.5,62,40,40\n";
  works("touch " + in("ring.json") + " --path " + in("down.csv") + " --backend cpu --trace " + in("t.csv") +
        " --json " + in("r.json") + " --save " + in("s.ply") + " --log " + in("log"));
  const std::vector<Row> rows = readTrace(in("t.csv"));
  CHECK(rows.front().force == DVec3(0));
  CHECK(rows.back().force.y > 0.5);
  CHECK(rows.back().proxy.y > rows.back().hip.y + 2);
  const auto report = jsonOf(in("r.json"));
  CHECK(report["points"].get<std::size_t>() > 6000);
  REQUIRE(report["matter"]["ports"].size() == 1);
  CHECK(report["matter"]["ports"][0]["energy_mJ"].get<double>() > 1);
  CHECK(report["matter"]["ports"][0]["min_energy_mJ"].get<double>() >= -1);
  // The particles come first; the points of the model have not moved.
  const PointCloud saved = readPly(in("s.ply"));
  CHECK(saved.size() == report["points"]);
  CHECK(report["moved_points"].get<std::size_t>() <= saved.size() - 6000);
  works("replay " + in("log"));
  // The same without a scene file.
  works("info \"" + in("ring.ply") + " in water\"");
  works("render \"" + in("ring.ply") + " in sand\" -o " + in("p.png") + " --size 320x240");
  works("info \"soft " + in("ring.ply") + "\"");
  const Outcome none = palpate("touch \"" + in("none.ply") + " in water\" --path builtin:press");
  CHECK(none.code == 1);
  CHECK(says(none.text, "none.ply in water: there is no file"));
  // A name without its extension gets a suggestion.
  for (const std::string command : {"touch", "simulate", "info"}) {
    const Outcome inWater = palpate(command + " \"" + in("rin") + " in water\"");
    CHECK(inWater.code == 1);
    CHECK(says(inWater.text, "with its ending, here \"" + in("ring.ply") + " in water\""));
    const Outcome soft = palpate(command + " \"soft scan\"");
    CHECK(soft.code == 1);
    CHECK(says(soft.text, "there is no file 'scan'; type the name of a closed cloud's file with its ending"));
  }
  for (const std::string command : {"simulate", "touch"}) CHECK(says(palpate(command + " --help").text, "bunny.ply"));
}

TEST_CASE("the window sculpts a soft body, undoes the stroke, and names a brush that the body cannot take") {
  if (!hasDisplay()) return;
  const auto played =
      play("%/block.json --size 480x360 --rate 250 --backend cpu --edit push", R"(
0.01 key tab
0.06 mouse 239 205
0.16 key space down
0.21 button left down
0.41 wheel 6
0.81 state %/touch.json
0.86 button left up
0.91 key space up
0.96 state %/dent.json
1.01 key ctrl+z
1.16 state %/undone.json
1.21 key 3
1.26 state %/carve.json
1.31 quit
)",
           "", [](const std::filesystem::path& folder) {
             std::ofstream(folder / "block.json")
                 << R"({"matter": "soft", "box_mm": [160, 120, 160], "fill_mm": [60, 48, 60], "spacing_mm": 6,
               "young_Pa": 100000, "pinned_mm": [[0, 0, 0], [160, 0.1, 160]]})";
           });
  REQUIRE_MESSAGE(played->outcome.code == 0, played->outcome.text);
  CHECK(played->state("touch.json")["contact"] == true);
  CHECK(played->state("dent.json")["strokes"] == 1);
  CHECK(played->state("dent.json")["undo_count"] == 1);
  CHECK(played->state("dent.json")["changed"] == true);
  CHECK(played->state("undone.json")["undo_count"] == 0);
  const std::string message = played->state("carve.json")["last_message"];
  CHECK_MESSAGE(message.find("a soft body cannot be carved") != std::string::npos, message);
}

TEST_CASE("water lies entirely within the box drawn around it") {
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  std::ofstream(in("tank.json"))
      << R"({"matter": "water", "box_mm": [200, 120, 40], "fill_mm": [200, 80, 40], "spacing_mm": 10})";
  works("--quiet render " + in("tank.json") + " -o " + in("p.png") + " --size 480x300 --background 0,0,0" +
        " --camera \"eye=100,60,12000 target=100,60,20 fov=1\"");
  const Picture picture(folder / "p.png");
  std::array<int, 4> water{picture.width, 0, picture.height, 0}, box = water;
  const auto grow = [](std::array<int, 4>& around, int x, int y) {
    around = {std::min(around[0], x), std::max(around[1], x), std::min(around[2], y), std::max(around[3], y)};
  };
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const auto p = picture.at(x, y);
      if (5 * p[2] > 7 * p[0] + 25) grow(water, x, y);
      if (p[0] > 110 && std::abs(p[2] - p[0]) < 40) grow(box, x, y);
    }
  CHECK(water[1] - water[0] > 200);
  CHECK(water[0] >= box[0]);
  CHECK(water[1] <= box[1]);
  CHECK(water[3] <= box[3]);
}

}  // namespace palpate::matter_test
