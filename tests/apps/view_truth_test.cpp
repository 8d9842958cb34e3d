// The window's texts and pictures are true of the model: positions, lengths, messages, names.
#include <cstdlib>

#include "tests/apps/window_play.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::view_truth_test {

namespace {

constexpr double kEast = 637177.98, kNorth = 4877754.178, kHeight = 421.33, kStep = 0.25;
constexpr int kSide = 40;

// Points of a survey, in national grid coordinates.
void writeField(const std::filesystem::path& file) {
  std::ofstream out(file);
  out << "ply\nformat ascii 1.0\ncomment units: m\nelement vertex " << kSide * kSide
      << "\nproperty double x\nproperty double y\nproperty double z\nend_header\n";
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j)
      out << fmt::format("{:.3f} {:.3f} {:.3f}\n", kEast + kStep * i, kNorth + kStep * j, kHeight);
}

bool isDecimal(double value, double first) {
  const double steps = std::round((value - first) / kStep);
  return value == std::strtod(fmt::format("{:.3f}", first + kStep * steps).c_str(), nullptr);
}

// First and last column that contain a part of a brown model.
std::pair<int, int> brownColumns(const Picture& picture) {
  std::pair<int, int> columns{picture.width, 0};
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      if (const auto p = picture.at(x, y); p[0] > p[1] + 15 && p[1] > p[2] + 8)
        columns = {std::min(columns.first, x), std::max(columns.second, x)};
  return columns;
}

int middleOf(const Picture& picture) {
  const auto [first, last] = brownColumns(picture);
  CHECK(last - first > 60);
  return (first + last) / 2;
}

int reds(const Picture& picture) {
  int found = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      if (const auto p = picture.at(x, y); p[0] > 120 && p[1] < 70 && p[2] < 70) ++found;
  return found;
}

}  // namespace

TEST_CASE("a picked position has the digits of the file, also when copied; beside the model none is picked") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/field.ply --size 480x360 --rate 250 --backend cpu --up z",
      [](const auto& folder) { writeField(folder / "field.ply"); }, R"(
0.1 key tab
0.2 key z
0.3 key d
0.4 mouse 240 180
0.6 button left down
0.6 button left up
0.8 state %/picked.json
0.9 key ctrl+c
1.0 state %/copied.json
1.1 mouse 4 4
1.3 button left down
1.3 button left up
1.5 state %/missed.json
1.6 key tab
1.7 click Models
1.9 click file.ply
2.1 key ctrl+v
2.2 key enter
2.4 state %/pasted.json
2.5 quit
)");
  const auto picked = played->state("picked.json")["picked"];
  REQUIRE_FALSE(picked.is_null());
  const double east = picked["position"][0], north = picked["position"][1], height = picked["position"][2];
  CHECK(isDecimal(east, kEast));
  CHECK(isDecimal(north, kNorth));
  CHECK(height == kHeight);
  const std::string copied = played->state("copied.json")["last_message"];
  double x = 0, y = 0, z = 0;
  REQUIRE_MESSAGE(std::sscanf(copied.c_str(), "copied: %lf,%lf,%lf", &x, &y, &z) == 3, copied);
  CHECK(glm::distance(DVec3(x, y, z), DVec3(east, north, height)) < kStep);
  CHECK(copied.find("e+") == std::string::npos);
  CHECK(says(std::string(played->state("missed.json")["last_message"]), "the model is not under the cursor"));
  CHECK(says(std::string(played->state("pasted.json")["last_message"]), copied.substr(copied.find(' ') + 1)));
}

TEST_CASE("an error is shown until it is closed, and messages about a model disappear with it") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/sphere.ply --size 480x360 --rate 250 --backend cpu",
      [](const auto& folder) {
        makeSphere(folder, 2000);
        works("--quiet make torus -n 2000 -o " + (folder / "torus.ply").string());
        std::ofstream(folder / "broken.ply") << "no cloud";
      },
      R"(
0.1 state %/sphere.json
0.2 drop %/broken.ply
0.4 screenshot %/broken.png
0.4 state %/broken.json
0.5 key escape
0.6 screenshot %/closed.png
0.6 state %/closed.json
0.7 drop %/broken.ply
0.9 click Close
1.1 state %/clicked.json
1.2 drop %/torus.ply
1.4 state %/torus.json
1.5 quit
)");
  const auto saidIn = [&](const char* state) { return played->state(state)["messages"].dump(); };
  CHECK_FALSE(says(saidIn("sphere.json"), "up is"));  // the panel shows it
  REQUIRE(played->state("broken.json")["errors"].size() == 1);
  CHECK(says(std::string(played->state("broken.json")["errors"][0]), "broken.ply"));
  const auto& folder = played->folder.path();
  CHECK(reds(Picture(folder / "broken.png")) > reds(Picture(folder / "closed.png")) + 500);
  CHECK(played->state("closed.json")["errors"].empty());
  CHECK(played->state("clicked.json")["errors"].empty());
  CHECK(played->state("torus.json")["errors"].empty());
}

TEST_CASE("the brush size is shown and typed in the model's own unit") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/ball.ply --size 480x360 --rate 250 --backend cpu --unit m",
      [](const auto& folder) { works("--quiet make sphere -n 2000 --size 2 -o " + (folder / "ball.ply").string()); },
      R"(
0.1 key 2
0.3 key ctrl down
0.4 click size
0.6 key ctrl up
0.7 text 0.2
0.8 key enter
1.0 state %/typed.json
1.1 quit
)");
  const auto typed = played->state("typed.json");
  CHECK(typed["mm_per_unit"].get<double>() == near(50, 0.01));
  CHECK(typed["brush_radius_mm"].get<double>() == near(0.2 * typed["mm_per_unit"].get<double>(), 1e-6));
}

TEST_CASE("Escape closes a list first, and only then the measurement or dialogue behind it") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 480x600 --rate 250 --backend cpu", sphereOf(2000), R"(
0.1 click Tool
0.2 key d
0.3 click Colours
0.5 click colour by
0.7 key escape
0.9 click height
1.1 state %/closed.json
1.2 mouse 132 300
1.2 button left down
1.2 button left up
1.2 mouse 152 320
1.2 button left down
1.2 button left up
1.3 state %/measured.json
1.3 key p
1.3 key escape
1.3 key p
1.4 state %/ended.json
1.5 key ctrl+o
1.6 click format
1.8 key escape
2.0 click Up
2.2 state %/browsing.json
2.3 key escape
2.5 click Up
2.7 state %/gone.json
2.8 quit
)");
  const auto closed = played->state("closed.json");
  CHECK(says(std::string(closed["last_message"]), "'height' cannot be clicked"));
  CHECK(closed["color"] == "rgb");
  CHECK(closed["measuring"] == true);
  CHECK(played->state("measured.json")["measured"] > 1);
  CHECK(played->state("ended.json")["measuring"] == false);
  CHECK(played->state("ended.json")["measured"].is_null());
  // A measurement is drawn in pictures of the model as a darker line.
  const Picture with(played->folder.path() / "sphere-1.png"), without(played->folder.path() / "sphere-2.png");
  CHECK(differing(with, without, 240, 300, 200) > 100);
  CHECK(played->state("browsing.json")["last_message"] ==
        played->state("ended.json")["last_message"]);  // 'Up' is still shown
  CHECK(says(std::string(played->state("gone.json")["last_message"]), "'Up' cannot be clicked"));
}

TEST_CASE("the axis views of the window are relative to the model's up direction") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 480x600 --rate 250 --backend cpu --up z", sphereOf(2000), R"(
0.1 click Tool
0.2 click Look
0.4 click front
0.6 state %/front.json
0.7 click right
0.9 state %/right.json
1.0 click top
1.2 state %/top.json
1.3 key ctrl+1
1.4 state %/front_key.json
1.5 key ctrl+4
1.6 state %/right_key.json
1.7 key ctrl+5
1.8 state %/top_key.json
1.9 quit
)");
  const auto from = [&](const char* state) {
    const auto camera = played->state(state)["camera"];
    const auto vec = [](const Result& v) { return DVec3(v[0].get<double>(), v[1].get<double>(), v[2].get<double>()); };
    return glm::normalize(vec(camera["eye"]) - vec(camera["target"]));
  };
  for (const std::string side : {"front", "right", "top"}) {
    CAPTURE(side);
    CHECK(glm::distance(from((side + ".json").c_str()), from((side + "_key.json").c_str())) < 1e-6);
  }
  CHECK(from("front.json").y == near(-1, 1e-6));
  CHECK(from("right.json").x == near(1, 1e-6));
  CHECK(from("top.json").z > 0.98);
}

TEST_CASE("a narrow window hides the panels, and the model stays centred when panels appear or disappear") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 320x240 --rate 250 --backend cpu", sphereOf(2000), R"(
0.3 screenshot %/narrow.png
0.3 state %/narrow.json
0.4 key tab
0.6 state %/asked.json
0.7 key tab
0.8 resize 480 240
1.2 screenshot %/wide.png
1.2 state %/wide.json
1.3 key tab
1.6 screenshot %/bare.png
1.7 key tab
1.9 resize 320 240
2.3 state %/again.json
2.4 quit
)");
  const auto picture = [&](const char* name) { return Picture(played->folder.path() / name); };
  CHECK(played->state("narrow.json")["panels"] == false);
  CHECK(std::abs(middleOf(picture("narrow.png")) - 160) < 15);
  CHECK(played->state("asked.json")["panels"] == true);
  CHECK(played->state("wide.json")["panels"] == true);
  CHECK(std::abs(middleOf(picture("wide.png")) - (42 + 232) / 2) < 15);
  CHECK(std::abs(middleOf(picture("bare.png")) - 240) < 15);
  CHECK(played->state("again.json")["panels"] == false);
}

TEST_CASE("file names are shown in their own script") {
  if (!hasDisplay()) return;
  const bool hasChinese = std::filesystem::exists("/usr/share/fonts/truetype/droid/DroidSansFallbackFull.ttf");
  if (!hasChinese) MESSAGE("skipped in part: no font for Chinese (package fonts-droid-fallback)");
  const std::string script = R"(
0.1 drop %/жжжж.ply
0.4 screenshot %/cyrillic.png
0.5 drop %/λλλλ.ply
0.8 screenshot %/greek.png
0.9 drop %/模模模模.ply
1.2 screenshot %/chinese.png
1.3 drop %/????.ply
1.6 screenshot %/none.png
1.7 quit
)";
  const auto played = playWell(
      "--size 480x240 --rate 250 --backend cpu",
      [](const auto& folder) {
        makeSphere(folder, 500);
        for (const char* name : {"жжжж.ply", "λλλλ.ply", "模模模模.ply", "????.ply"})
          std::filesystem::copy_file(folder / "sphere.ply", folder / name);
      },
      script);
  const auto picture = [&](const char* name) { return Picture(played->folder.path() / name); };
  const Picture none = picture("none.png");
  // The name is the first line of the panel.
  const auto differ = [&](const char* name) { return differing(none, picture(name), 264, 24, 14); };
  CHECK(differ("cyrillic.png") > 40);
  CHECK(differ("greek.png") > 40);
  CHECK(differing(picture("greek.png"), picture("cyrillic.png"), 264, 24, 14) > 40);
  if (hasChinese) CHECK(differ("chinese.png") > 40);
}

TEST_CASE("recent models are those that can be read; a missing one is reported, and a scene keeps its name") {
  if (!hasScenes()) return;
  if (!hasDisplay()) return;
  const auto played = playWell(
      "--size 480x360 --rate 250 --backend cpu",
      [](const auto& folder) {
        makeSphere(folder, 500);
        std::ofstream(folder / "broken.ply") << "no cloud";
        std::filesystem::create_directories(folder / "state" / "palpate");
        std::ofstream recent(folder / "state" / "palpate" / "recent");
        for (const char* name : {"gone.ply", "broken.ply", "sphere.ply"}) recent << (folder / name).string() << "\n";
      },
      R"(
0.1 click gone.ply
0.2 state %/gone.json
0.3 click broken.ply
0.5 click sphere.ply
0.7 state %/sphere.json
0.8 drop jelly
1.0 state %/jelly.json
1.1 quit
)");
  CHECK(says(std::string(played->state("gone.json")["last_message"]), "'gone.ply' cannot be clicked"));
  CHECK(says(std::string(played->state("sphere.json")["model"]), "sphere.ply"));
  CHECK(played->state("jelly.json")["model"] == "jelly");
  const auto& folder = played->folder.path();
  CHECK(contentOf(folder / "state" / "palpate" / "recent") ==
        "jelly\n" + (folder / "sphere.ply").string() + "\n" + (folder / "gone.ply").string() + "\n");
}

}  // namespace palpate::view_truth_test
