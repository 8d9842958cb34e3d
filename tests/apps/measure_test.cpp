// Size of a model from two positions and the length between them: in the window, and on the command line.
#include <cmath>
#include <fstream>

#include "engine/io/cloud_formats.hpp"
#include "engine/render/camera.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::measure_test {

namespace {

bool isRefused(const std::string& arguments, const std::string& saying) {
  const Outcome outcome = palpate(arguments);
  CHECK_MESSAGE(outcome.code == 2, outcome.text);
  CHECK_MESSAGE(says(outcome.text, saying), outcome.text);
  return outcome.code == 2;
}

}  // namespace

TEST_CASE("two picked positions give a distance, a true length gives the scale, and saved files contain it") {
  if (!hasDisplay()) return;
  // A plane of 3 x 2 units faces the eye and fills much of the window.
  const auto played = playWell(
      "%/plane.ply --size 480x600 --rate 250 --backend cpu",
      [](const std::filesystem::path& folder) {
        works("--quiet make plane -n 8000 --size 3 -o " + (folder / "plane.ply").string());
      },
      R"(
0.1 key tab
0.2 key z
0.3 key d
0.4 mouse 180 300
0.6 button left down
0.6 button left up
0.7 state %/one.json
0.8 mouse 300 300
1.0 button left down
1.0 button left up
1.2 state %/two.json
1.25 screenshot %/two.png
1.3 key tab
1.5 click true length, mm
1.6 text 400
1.7 click Set
2.0 state %/scaled.json
2.1 save %/saved.ply
2.3 click true length, mm
2.4 text x
2.5 click Set
2.7 state %/refused.json
2.8 drop %/saved.ply
3.0 state %/reopened.json
3.1 quit
)");
  const auto one = played->state("one.json"), two = played->state("two.json"), scaled = played->state("scaled.json");
  CHECK(one["measured"].is_null());
  REQUIRE_FALSE(two["measured"].is_null());
  // The view is along z: 120 pixels at the depth of the plane, with the picture's camera of 45 degrees.
  const auto vec = [](const Result& v) { return DVec3(v[0].get<double>(), v[1].get<double>(), v[2].get<double>()); };
  const double depth = glm::distance(vec(two["camera"]["eye"]), vec(two["camera"]["target"]));
  const double units = 120 * depth / (0.5 * 600 / std::tan(22.5 / 57.29577951308232));
  CHECK(two["measured"].get<double>() == near(units, 0.02));
  CHECK(two["mm_per_unit"].get<double>() == near(100 / 3.0, 0.01));
  CHECK(scaled["mm_per_unit"].get<double>() == near(400 / two["measured"].get<double>(), 1e-6));
  CHECK(scaled["measured"] == two["measured"]);
  CHECK(says(scaled["last_message"].get<std::string>() + played->outcome.text, "is 400 mm long in the hand"));
  const auto refused = played->state("refused.json");
  CHECK(refused["mm_per_unit"] == scaled["mm_per_unit"]);
  CHECK(says(refused["last_message"].get<std::string>(), "is not a positive length in mm"));
  const auto reopened = played->state("reopened.json");
  CHECK(reopened["mm_per_unit"].get<double>() == near(scaled["mm_per_unit"].get<double>(), 1e-6));
  CHECK(reopened["measured"] == two["measured"]);  // the saved file is the model from then on
}

namespace {

// A kerb of 120 mm between road and pavement, on a grid of a millimetre, far from zero; the road is in front.
constexpr DVec3 kFar(637000, 849000, 90);
constexpr double kKerb = 0.12;
PointCloud kerb() {
  PointCloud cloud;
  cloud.origin = kFar;
  const auto add = [&](double x, double y, double z) {
    const DVec3 exact = glm::round(1000.0 * (kFar + DVec3(x, y, z))) / 1000.0;
    cloud.exactPositions.push_back(exact);
    cloud.positions.emplace_back(exact - cloud.origin);
  };
  for (int i = -40; i <= 40; ++i) {
    for (int j = 1; j <= 24; ++j) {
      add(0.02 * i, -0.02 * j, 0);
      add(0.02 * i, 0.02 * j, kKerb);
    }
    for (int k = 0; k <= 6; ++k) add(0.02 * i, 0, 0.02 * k);
  }
  cloud.storedAs.position = ScalarType::f64;
  cloud.storedAs.grid = CoordinateGrid{.step = DVec3(0.001), .offset = kFar};
  return cloud;
}

std::vector<std::string> linesOf(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

}  // namespace

TEST_CASE("journey 1: a kerb is measured in millimetres, with full coordinates, kept by name, and written as CSV") {
  if (!hasDisplay()) return;
  const auto prepare = [](const std::filesystem::path& folder) { writeCloud(folder / "kerb.las", kerb()); };
  const std::string options = "%/kerb.las --size 600x480 --rate 250 --backend cpu --up z --unit m";
  const auto seen = playWell(options, prepare, "0.1 key tab\n0.3 state %/seen.json\n0.4 quit\n");
  const auto vec = [](const Result& v) { return DVec3(v[0].get<double>(), v[1].get<double>(), v[2].get<double>()); };
  const Result camera = seen->state("seen.json")["camera"];
  const Camera eye{.eye = vec(camera["eye"]), .target = vec(camera["target"]), .up = vec(camera["up"])};
  std::string clicks;
  double time_s = 0.3;
  for (const DVec3& place : {DVec3(0, 0, 0), DVec3(0, 0, kKerb), DVec3(-0.3, 0, kKerb), DVec3(0.3, 0, kKerb)}) {
    const auto at = eye.project(place, DVec2(600, 480));
    REQUIRE(at);
    clicks += fmt::format("{0:.1f} mouse {1:.1f} {2:.1f}\n{3:.1f} button left down\n{3:.1f} button left up\n", time_s,
                          at->x, at->y, time_s + 0.2);
    time_s += 0.4;
  }
  const auto played = playWell(options, prepare, "0.1 key tab\n0.2 key d\n" + clicks + R"(
2.0 key p
2.3 key tab
2.5 click distance 1
2.6 state %/chosen.json
2.7 click name
2.8 text kerb, left "A"
2.9 click Rename
3.1 state %/named.json
3.2 click Save CSV
3.4 key escape
3.5 state %/ended.json
3.6 drop %/kerb.las
4.2 click Save CSV
4.4 click distance 2
4.6 click Forget
4.8 state %/reopened.json
4.9 quit
)");
  const std::filesystem::path folder = played->folder.path();
  const auto chosen = played->state("chosen.json"), named = played->state("named.json"),
             ended = played->state("ended.json"), reopened = played->state("reopened.json");
  CHECK(chosen["measured"].get<double>() == within(kKerb, 1e-6));
  CHECK(chosen["distances"]["distance 2"].get<double>() == within(0.6, 1e-6));
  CHECK(named["distances"].contains("kerb, left \"A\""));
  CHECK_FALSE(named["distances"].contains("distance 1"));
  CHECK(ended["measured"].is_null());
  CHECK(ended["distances"] == named["distances"]);  // they are not lost when measuring ends
  CHECK(reopened["distances"].size() == 1);
  const auto table = linesOf(folder / "kerb-distances-1.csv");
  REQUIRE(table.size() == 3);
  CHECK(table[0] == "name,from_x,from_y,from_z,to_x,to_y,to_z,length,height,across,unit,length_mm,height_mm,across_mm");
  CHECK(table[1] == "\"kerb, left \"\"A\"\"\",637000,849000,90,637000,849000,90.12,0.12,0.12,0,m,120,120,0");
  CHECK(table[2] == "distance 2,636999.7,849000,90.12,637000.3,849000,90.12,0.6,0,0.6,m,600,0,600");
  CHECK(linesOf(folder / "kerb-distances-2.csv") == table);  // of the model that was opened again
}

TEST_CASE("a picked position is a point of the cloud within 5 pixels, else it is rounded to the size of a pixel") {
  if (!hasDisplay()) return;
  // Points 2 units apart, which a window shows about 50 pixels apart.
  const auto grid = [](const std::filesystem::path& folder) {
    std::ofstream out(folder / "grid.xyz");
    out << "x y z\n";
    for (int i = 0; i < 13; ++i)
      for (int j = 0; j < 13; ++j) out << 2 * i + 0.03125 << ' ' << 2 * j << " 0\n";
  };
  std::string script = "0.1 key d\n0.2 key z\n";
  constexpr int kPicks = 14;
  for (int i = 0; i < kPicks; ++i)
    script += fmt::format(
        "{0:.1f} mouse {1} {2}\n{3:.1f} button left down\n{3:.1f} button left up\n"
        "{4:.1f} state %/{5}.json\n",
        0.4 + 0.6 * i, 319 + 4 * i, 300 + 4 * i, 0.6 + 0.6 * i, 0.8 + 0.6 * i, i);
  const auto played = playWell("%/grid.xyz --size 900x600 --up z --backend cpu", grid, script + "20 quit\n");
  int snapped = 0, rounded = 0;
  for (int i = 0; i < kPicks; ++i) {
    const auto picked = played->state(fmt::format("{}.json", i))["picked"];
    REQUIRE(!picked.is_null());
    const DVec3 place(picked["place"][0], picked["place"][1], picked["place"][2]),
        point(picked["position"][0], picked["position"][1], picked["position"][2]);
    const double apart = glm::distance(place, point);
    CAPTURE(apart);
    if (apart < 1e-5) {
      ++snapped;
      continue;
    }
    ++rounded;
    CHECK(apart > 0.1);  // a pixel is about 0.04 units
    for (int k = 0; k < 3; ++k) CHECK(std::abs(place[k] - std::round(place[k] * 100) / 100) < 1e-6);
  }
  CHECK(snapped > 0);
  CHECK(rounded > 0);
}

TEST_CASE("a new scale is set only after the user has decided what happens to unsaved changes") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 480x600 --rate 250 --edit push --backend cpu", sphereOf(3000), R"(
0.1 mouse 132 300
0.4 key space down
0.5 button left down
1.3 button left up
1.4 key space up
1.5 ask
1.6 key d
1.7 mouse 107 275
1.9 button left down
1.9 button left up
2.0 mouse 157 320
2.2 button left down
2.2 button left up
2.4 click true length, mm
2.5 text 500
2.6 click Set
2.8 state %/asked.json
2.9 click Cancel
3.1 state %/cancelled.json
3.2 click Set
3.4 click Do not save
3.7 state %/scaled.json
3.8 quit
)");
  const auto asked = played->state("asked.json"), cancelled = played->state("cancelled.json"),
             scaled = played->state("scaled.json");
  REQUIRE(asked["changed"] == true);
  CHECK(asked["asks_about_changes"] == true);
  CHECK(cancelled["asks_about_changes"] == false);
  CHECK(cancelled["changed"] == true);
  CHECK(cancelled["mm_per_unit"] == asked["mm_per_unit"]);
  CHECK(scaled["changed"] == false);
  CHECK(scaled["mm_per_unit"].get<double>() == near(500 / cancelled["measured"].get<double>(), 1e-6));
}

TEST_CASE("the command line takes a scale from two positions, and convert writes it to the file") {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string(), out = (folder / "o.ply").string(),
                    json = (folder / "j.json").string();
  works("--quiet make sphere -n 2000 -o " + model);
  works("--quiet touch " + model +
        " --backend cpu --path builtin:press --duration 0.05 --scale-from=0,0,0:3,4,0=10 --json " + json);
  CHECK(jsonOf(json)["mm_per_unit"].get<double>() == near(2, 1e-6));
  works("convert " + model + " " + out + " --scale-from=-1,0,0:0.5,0,2=340 --json " + json);
  works("info " + out + " --json " + json);
  CHECK(jsonOf(json)["mm_per_unit"].get<double>() == near(340 / 2.5, 1e-6));
  works("--quiet touch " + out + " --backend cpu --path builtin:press --duration 0.05 --json " + json);
  CHECK(jsonOf(json)["mm_per_unit"].get<double>() == near(340 / 2.5, 1e-6));
  works("--quiet touch " + out + " --backend cpu --path builtin:press --duration 0.05 --mm-per-unit 7 --json " + json);
  CHECK(jsonOf(json)["mm_per_unit"] == 7);
  works("info " + model + " --json " + json);
  const double usual = jsonOf(json)["mm_per_unit"].get<double>();
  works("--quiet touch " + model + " --backend cpu --path builtin:press --duration 0.05 --json " + json);
  CHECK(jsonOf(json)["mm_per_unit"].get<double>() == near(usual, 1e-6));

  const std::vector<std::string> commands{"touch " + model, "convert " + model + " " + (folder / "n.ply").string(),
                                          "render " + model + " -o " + (folder / "n.png").string()};
  for (const std::string& command : commands) {
    isRefused(command + " --scale-from 1,2:3,4,5=6", "--scale-from: ");
    isRefused(command + " --scale-from 1,2,3:3,4,5", "is not two positions and a length in mm");
    isRefused(command + " --scale-from 1,2,3:1,2,3=5", "--scale-from: both positions are the same");
    isRefused(command + " --scale-from 1,2,3:1,2,4=-5", "mm per unit, which is not between");
    isRefused(command + " --scale-from 1,2,3:1,2,4=nan", "mm per unit, which is not between");
    isRefused(command + " --scale-from 1,2,3:1,2,4=5 --mm-per-unit 3", "--scale-from: conflicts with --mm-per-unit");
  }
  CHECK_FALSE(std::filesystem::exists(folder / "n.ply"));
}

TEST_CASE("convert writes the given unit to formats that can hold one, and reports those that cannot") {
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  works("--quiet make sphere -n 500 -o " + in("s.ply"));
  for (const char* name : {"a.ply", "a.las", "a.pcd"}) {
    CAPTURE(std::string(name));
    const Outcome outcome = palpate("convert " + in("s.ply") + " " + in(name) + " --unit ft");
    CHECK(outcome.code == 0);
    CHECK_FALSE(says(outcome.text, "cannot hold a unit"));
    CHECK(says(palpate("info " + in(name)).text, " ft\n"));
  }
  checkEnds(0, "convert " + in("s.ply") + " " + in("a.xyz") + " --unit ft",
            {"a.xyz: XYZ cannot hold a unit of length; ft is not kept"});
  CHECK(palpate("convert " + in("s.ply") + " " + in("b.ply") + " --unit yard").code == 2);
}

}  // namespace palpate::measure_test
