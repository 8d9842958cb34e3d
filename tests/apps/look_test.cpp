// Up direction, length units, and the annotations of a picture.
#include "tests/apps/window_play.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::look_test {

namespace {

/// Cone without its tip, on its base, with up along `axis` (x, y or z) or against it.
void writeCone(const std::filesystem::path& file, int axis, double sign, const std::string& comment = "made up") {
  constexpr int kPoints = 3000;
  std::ofstream out(file);
  out << "ply\nformat ascii 1.0\ncomment " << comment << "\nelement vertex " << kPoints
      << "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  for (int i = 0; i < kPoints; ++i) {
    const double t = (i + 0.5) / kPoints, angle = 2.39996323 * i;
    const bool base = i % 4 == 0;
    const double height = base ? 0 : 2.5 * (1 - std::sqrt(1 - 0.9 * t)), r = base ? std::sqrt(t) : 1 - 0.32 * height;
    DVec3 p(0);
    p[axis] = sign * height;
    p[(axis + 1) % 3] = r * std::cos(angle);
    p[(axis + 2) % 3] = r * std::sin(angle);
    out << p.x << ' ' << p.y << ' ' << p.z << '\n';
  }
}

}  // namespace

TEST_CASE("info reports the up direction with its reason, and the unit") {
  const ScratchFolder folder;
  const auto info = [&](const std::string& arguments) {
    works("info " + arguments + " --json " + (folder / "i.json").string());
    return jsonOf(folder / "i.json");
  };
  for (const auto& [name, axis, sign] : {std::tuple("x", 0, 1.0), std::tuple("-y", 1, -1.0), std::tuple("z", 2, 1.0)}) {
    CAPTURE(name);
    const std::string file = (folder / "cone.ply").string();
    writeCone(file, axis, sign, "units: cm");
    const auto said = info(file);
    CHECK(said["up"] == name);
    CHECK(says(said["up_reason"].get<std::string>(), "base"));
    CHECK(said["unit"] == "cm");
    CHECK(said["heights"][0].get<double>() == within(0, 0.01));
    CHECK(said["heights"][1].get<double>() == near(1.71, 0.02));
    CHECK(info(file + " --up -z")["up"] == "-z");
    CHECK(info(file + " --up=-z --unit ft")["unit"] == "ft");
    const Outcome text = palpate("info " + file);
    CHECK(says(text.text, std::string("up: ") + name + " (guessed from its flat base, likely)"));
    CHECK(said["up_sureness"] == "likely");
    CHECK(said["front_sureness"] == "unsure");  // a cone looks the same from all sides
    CHECK(says(text.text, "cm"));
  }
  works("--quiet make sphere -n 2000 -o " + (folder / "s.ply").string());
  const auto sphere = info((folder / "s.ply").string());
  CHECK(sphere["up"] == "y");
  CHECK(sphere["up_sureness"] == "unsure");
  CHECK(sphere["unit"].is_null());
  for (const char* wrong : {"--up w", "--up +y", "--unit parsec"})
    CHECK(palpate(std::string("info ") + (folder / "s.ply").string() + " " + wrong).code == 2);
}

TEST_CASE("a few points far away change neither the touch scale nor what a hand feels, and info counts them") {
  const ScratchFolder folder;
  const auto in = [&](const std::string& name) { return (folder / name).string(); };
  works("--quiet make sphere -n 3000 --size 1 -o " + in("0.xyz"));
  const std::string sphere = contentOf(in("0.xyz"));
  const auto felt = [&](int outliers) {
    const std::string file = in(std::to_string(outliers) + ".xyz");
    std::ofstream out(file, std::ios::binary);
    out << sphere;
    for (int i = 0; i < outliers; ++i)
      out << 1e6 * std::cos(i) << ' ' << 1e6 * std::sin(i) << ' ' << 2e5 * i << " 0 1 0\n";
    out.close();
    works("info " + file + " --json " + in("i.json"));
    CHECK(jsonOf(in("i.json"))["outliers"] == outliers);
    CHECK(says(palpate("info " + file).text, "far from all others") == (outliers > 0));
    works("--quiet touch " + file + " --backend cpu --path builtin:press --json " + in("t.json"));
    CHECK(jsonOf(in("i.json"))["mm_per_unit"] == jsonOf(in("t.json"))["mm_per_unit"]);
    return jsonOf(in("t.json"));
  };
  const auto plain = felt(0);
  CHECK(plain["mm_per_unit"].get<double>() == near(100, 0.01));
  CHECK(plain["peak_force_N"] > 0.5);
  for (const int outliers : {1, 5}) {
    CAPTURE(outliers);
    const auto report = felt(outliers);
    CHECK(report["mm_per_unit"] == plain["mm_per_unit"]);
    CHECK(report["peak_force_N"].get<double>() == near(plain["peak_force_N"].get<double>(), 0.1));
  }
}

TEST_CASE("lengths are in the model's own unit, and the touch scale is reported once") {
  const ScratchFolder folder;
  const std::string ply = (folder / "s.ply").string(), las = (folder / "s.las").string();
  works("--quiet make sphere -n 3000 --size 3 --center 637177.98,4877754.178,421.33 -o " + ply);
  works("--quiet convert " + ply + " " + las);
  const std::string unknown = palpate("info " + ply).text, metres = palpate("info " + las + " --unit m").text;
  CHECK_MESSAGE(says(metres, "touch scale: 100 mm in the hand for 2.99904 m\n"), metres);
  CHECK(says(metres, "637176.4"));
  CHECK_FALSE(says(metres, "e+"));
  CHECK_MESSAGE(says(unknown, "touch scale: 100 mm in the hand for 2.99904 units\n"), unknown);
  const std::string feet = palpate("info " + las + " --unit ft").text;
  CHECK(says(feet, "100 mm in the hand for 2.99904 ft\n"));
  // Only the touch scale is in millimetres of the hand.
  CHECK(feet.find(" mm") == feet.rfind(" mm"));
  const std::string report =
      palpate("touch " + las + " --unit m --backend cpu --path builtin:press --duration 0.05 --edit push").text;
  CHECK_MESSAGE(says(report, "touch scale           100 mm in the hand for 2.99904 m\n"), report);
  CHECK(report.find(" mm") == report.rfind(" mm"));
  CHECK(says(report, "support radius 0."));
}

TEST_CASE("a model is drawn upright, whatever the up axis of its file") {
  const ScratchFolder folder;
  const auto render = [&](int axis, double sign, const std::string& options) {
    const std::string file = (folder / "cone.ply").string(), image = (folder / "i.png").string();
    writeCone(file, axis, sign);
    const Outcome outcome =
        palpate("render " + file + " -o " + image + " --size 320x240 --samples 1 --pass depth " + options);
    CAPTURE(outcome.text);
    REQUIRE(outcome.code == 0);
    return std::pair(Picture(image), outcome.text);
  };
  const auto [upright, said] = render(1, 1, "");
  CHECK(says(said, "up is y: guessed from its flat base"));
  const auto unlike = [&](const Picture& other) { return differing(upright, other, 160, 120, 110); };
  for (const auto& [axis, sign] : {std::pair(0, 1.0), std::pair(1, -1.0), std::pair(2, 1.0), std::pair(2, -1.0)}) {
    CAPTURE(axis);
    CAPTURE(sign);
    // The points are sampled differently around the axis: the outline is the same within some pixels.
    CHECK(unlike(render(axis, sign, "").first) < 1500);
    CHECK(unlike(render(axis, sign, "--up " + std::string(axis == 1 ? "y" : "-y")).first) > 5000);
  }
  const auto [told, quiet] = render(2, 1, "--up z");
  CHECK(!says(quiet, "up is"));
  CHECK(unlike(told) < 1500);
}

TEST_CASE("colours by height come with a legend, and a scale bar with its length") {
  const ScratchFolder folder;
  const std::string file = (folder / "cone.ply").string();
  writeCone(file, 2, 1);
  const auto render = [&](const std::string& options, const std::string& size = "640x480") {
    const Outcome outcome = palpate("render " + file + " -o " + (folder / "i.png").string() + " --samples 1 --size " +
                                    size + " " + options);
    CAPTURE(outcome.text);
    REQUIRE(outcome.code == 0);
    return std::pair(Picture(folder / "i.png"), outcome.text);
  };
  const Picture plain = render("").first, heights = render("--color height").first;
  // The colour ramp is at the right edge, over the background: violet at the bottom, yellow at the top.
  const auto low = heights.at(624, 340), high = heights.at(624, 140);
  CHECK(low[2] > low[1] + 40);
  CHECK(high[0] > high[2] + 40);
  CHECK(differing(plain, heights, 580, 240, 30) > 30);  // numbers
  CHECK(differing(render("--color height --unit ft").first, heights, 600, 118, 20) > 10);
  const auto normals = [&](const std::string& color) { return render("--pass normal " + color, "320x240").first; };
  CHECK(differing(normals("--color height"), normals(""), 240, 120, 75) == 0);
  const auto [bar, said] = render("--scale-bar --unit m");
  CHECK(says(said, " m long"));
  CHECK(differing(plain, bar, 60, 435, 15) > 10);
  // The numbers are dark on a light background.
  const Picture light = render("--color height --background 255,255,255").first;
  CHECK(count(580, 240, 30, [&](int x, int y) { return light.at(x, y)[0] < 100; }) > 5);
  // So is the bar.
  const Picture lightBar = render("--scale-bar --background 255,255,255").first;
  CHECK(count(60, 451, 8, [&](int x, int y) { return lightBar.at(x, y)[0] < 100; }) > 10);
  CHECK(count(60, 451, 8, [&](int x, int y) { return bar.at(x, y)[0] > 150; }) > 10);
  // Guides leave the legend and the bar as they are, and their letters have plates.
  const auto near = [&](const std::string& guides) {
    return render("--color height --background 255,255,255 --scale-bar --camera 'eye=0,40,150 target=0,0,0' " + guides)
        .first;
  };
  const Picture without = near(""), axes = near("--guides axes,box,compass"), boxes = near("--guides box");
  const auto isDark = [](const Picture& picture) {
    return [&](int x, int y) { return picture.at(x, y)[0] < 60 && picture.at(x, y)[2] < 60; };
  };
  CHECK(count(610, 240, 25, isDark(axes)) <= count(610, 240, 25, isDark(without)) + 5);
  CHECK(differing(axes, boxes, 62, 48, 40) > 400);  // the compass, on its plates
}

TEST_CASE("touch reports when the colours of a picture hide what was painted") {
  const ScratchFolder folder;
  const std::string image = (folder / "i.png").string();
  const std::string sphere = (folder / "s.ply").string();
  works("--quiet make sphere -n 2000 -o " + sphere);
  const auto painted = [&](const std::string& options) {
    const Outcome outcome =
        palpate("touch " + sphere + " --backend cpu --edit paint --rate 100 --size 64x48 --picture " + image + options);
    CAPTURE(outcome.text);
    REQUIRE(outcome.code == 0);
    return says(outcome.text, "do not show what was painted");
  };
  CHECK(!painted(""));
  CHECK(!painted(" --pass color"));
  CHECK(painted(" --color height"));
  CHECK(painted(" --pass normal"));
}

TEST_CASE("a few points are drawn as separate discs, and none is cut off") {
  const ScratchFolder folder;
  const std::string file = (folder / "few.ply").string(), image = (folder / "i.png").string();
  for (const int points : {1, 2, 4, 8, 20}) {
    CAPTURE(points);
    // One or two points are drawn as discs that face the eye, also without normals in the file.
    const bool bare = points <= 2;
    {
      std::ofstream out(file);
      out << "ply\nformat ascii 1.0\nelement vertex " << points;
      for (const char* name : {"x", "y", "z"}) out << "\nproperty float " << name;
      if (!bare)
        for (const char* name : {"nx", "ny", "nz"}) out << "\nproperty float " << name;
      out << "\nend_header\n";
      for (int i = 0; i < points; ++i)
        out << 10 * (i % 4) << ' ' << 10 * (i / 4) << ' ' << 3 * (i % 3) << (bare ? "\n" : " 0 0 1\n");
    }
    works("--quiet render " + file + " -o " + image + " --size 200x150 --background 0,0,0");
    const Picture picture(image);
    int lit = 0, atBorder = 0;
    for (int y = 0; y < 150; ++y)
      for (int x = 0; x < 200; ++x) {
        const bool shows = picture.at(x, y)[0] > 20;
        lit += shows;
        atBorder += shows && (x == 0 || y == 0 || x == 199 || y == 149);
      }
    CHECK(lit > 40 * points);
    CHECK(lit < 200 * 150 / 2);
    CHECK(atBorder == 0);
  }
}

TEST_CASE("a model turns by 90 degrees with a click or a key, and the panel says how sure its orientation is") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/cone.ply --size 560x640 --backend cpu",
      [](const std::filesystem::path& folder) { writeCone(folder / "cone.ply", 2, 1); }, R"(
0.2 state %/first.json
0.3 click Turn
0.6 state %/once.json
0.7 key u
1.0 state %/twice.json
1.1 key u
1.3 key u
1.6 state %/whole.json
1.7 quit
)");
  const auto up = [&](const char* file) { return played->state(file)["up"].get<std::string>(); };
  CHECK(up("first.json") == "z");
  CHECK(up("once.json") == "-x");  // what was at the left is above
  CHECK(up("twice.json") == "-z");
  CHECK(up("whole.json") == "z");
  // The same side stays in front.
  const auto eye = [&](const char* file) { return played->state(file)["camera"]["eye"][1].get<double>(); };
  for (const char* file : {"first.json", "once.json", "twice.json", "whole.json"}) CHECK(eye(file) < -1);
}

TEST_CASE("the window draws a model upright, turns it upside down on demand, and shows paint") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/cone.ply --size 560x640 --rate 250",
      [](const std::filesystem::path& folder) { writeCone(folder / "cone.ply", 2, 1); }, R"(
0.2 state %/first.json
0.2 screenshot %/first.png
0.3 click Tool
0.4 click Look
0.6 click up
0.9 click -z
1.2 state %/turned.json
1.3 click Colours
1.5 click colour by
1.7 click height
1.9 state %/heights.json
1.9 screenshot %/heights.png
2.0 mouse 177 320
2.1 key 7
2.2 key space down
2.4 button left down
3.2 button left up
3.3 key space up
3.6 state %/painted.json
3.7 quit
)");
  const auto first = played->state("first.json"), turned = played->state("turned.json");
  CHECK(first["up"] == "z");
  CHECK(first["camera"]["up"] == std::vector{0.0, 0.0, 1.0});
  CHECK(first["camera"]["eye"][1].get<double>() < -1);
  CHECK(turned["up"] == "-z");
  CHECK(turned["camera"]["up"] == std::vector{0.0, 0.0, -1.0});
  CHECK(played->state("heights.json")["color"] == "height");
  const Picture shown(played->folder.path() / "heights.png"), before(played->folder.path() / "first.png");
  CHECK(differing(before, shown, 284, 490, 8) > 50);  // the legend
  const auto painted = played->state("painted.json");
  REQUIRE(painted["edits"].get<int>() > 0);
  CHECK(painted["color"] == "rgb");
  CHECK(says(played->outcome.text, "so that the paint is visible"));
}

TEST_CASE("the light of a picture is set on the command line, and what is automatic leaves software drivers alone") {
  const ScratchFolder folder;
  const std::string torus = (folder / "t.ply").string(), picture = (folder / "p.png").string();
  works("--quiet make torus -n 4000 -o " + torus);
  const auto drawn = [&](const std::string& light) {
    works("--quiet render " + torus + " -o " + picture + " --size 160x120 " + light + " --json " +
          (folder / "r.json").string());
    return Picture(picture).rgb;
  };
  const auto plain = drawn("--occlusion off --cavity off --ground off");
  if (says(jsonOf(folder / "r.json")["gpu"].get<std::string>(), "llvmpipe")) {
    CHECK(drawn("") == plain);
    CHECK(drawn("--material auto --occlusion auto --cavity auto --ground auto --eye-dome auto") == plain);
  }
  for (const char* light : {"--occlusion on --cavity off --ground off", "--occlusion off --cavity on --ground off",
                            "--occlusion off --cavity off --ground on", "--eye-dome on", "--material stone",
                            "--material plaster", "--material metal", "--material unlit"}) {
    CAPTURE(light);
    CHECK(drawn(light) != plain);
  }
  const Outcome wrong = palpate("render " + torus + " -o " + picture + " --material wood");
  CHECK(wrong.code == 2);
  CHECK(says(wrong.text, "--material"));
  CHECK(says(wrong.text, "plaster"));
}

TEST_CASE("the window shows colours without normals as they are, and the light that its panel sets") {
  if (!hasDisplay()) return;
  const auto writeBall = [](const std::filesystem::path& file) {
    std::ofstream out(file);
    constexpr int kPoints = 4000;
    out << "ply\nformat ascii 1.0\nelement vertex " << kPoints
        << "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
           "property uchar blue\nend_header\n";
    for (int i = 0; i < kPoints; ++i) {
      const double z = 1 - 2 * (i + 0.5) / kPoints, angle = 2.39996323 * i, r = std::sqrt(1 - z * z);
      out << r * std::cos(angle) << ' ' << r * std::sin(angle) << ' ' << z << " 90 160 60\n";
    }
  };
  const auto played = playWell(
      "%/ball.ply --size 900x640 --rate 250",
      [&](const std::filesystem::path& folder) { writeBall(folder / "ball.ply"); },
      R"(
0.2 screenshot %/bare.png
0.3 click Look
0.5 click material
0.7 click metal
0.9 key ctrl+p
1.1 screenshot %/metal.png
1.2 state %/end.json
1.3 quit
)");
  const Picture bare(played->folder.path() / "bare.png"), metal(played->folder.path() / "metal.png");
  const std::array<int, 3> green{90, 160, 60};
  const int x = 347, y = 320;  // the middle of the ball, beside the panel
  int inColor = 0;
  for (int dy = -60; dy <= 60; dy += 20)
    for (int dx = -60; dx <= 60; dx += 20)
      inColor +=
          std::abs(bare.at(x + dx, y + dy)[0] - green[0]) <= 2 && std::abs(bare.at(x + dx, y + dy)[1] - green[1]) <= 2;
  CHECK(inColor >= 45);  // of 49
  CHECK(differing(bare, metal, x, y, 40) > 3000);
  // The saved picture has the light of the window, and the ball in its middle.
  const Picture saved(played->folder.path() / "ball-1.png");
  int unlike = 0;
  for (int dy = -40; dy <= 40; ++dy)
    for (int dx = -40; dx <= 40; ++dx)
      for (std::size_t k = 0; k < 3; ++k)
        unlike += std::abs(saved.at(saved.width / 2 + dx, y + dy)[k] - metal.at(x + dx, y + dy)[k]) > 12;
  CHECK(unlike < 60);
}

}  // namespace palpate::look_test
