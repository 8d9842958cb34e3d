// Colours by a field in pictures and in the window, and what is selected, kept and labelled by numbers.
#include <algorithm>
#include <cmath>
#include <fstream>

#include "engine/io/cloud_formats.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/content_of.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::view_color_test {

namespace {

/// A sheet of 60 x 60 points, seen from the side of +z: intensity is the column, missing in the last ten rows; a
/// second, equal sheet three spacings behind it.
void makeSheets(const std::filesystem::path& folder) {
  std::ofstream file(folder / "sheets.ply");
  file << "ply\nformat ascii 1.0\nelement vertex 7200\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "intensity"}) file << "property float " << name << '\n';
  file << "property int64 id\nend_header\n";
  for (const int up : {1, -1})
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 60; ++x)
        file << x << ' ' << y << ' ' << 1.5 * up << " 0 0 " << up << ' ' << (y < 50 ? std::to_string(x) : "nan") << ' '
             << 9007199254740993 + x << '\n';
}

constexpr const char* kSheets = "%/sheets.ply --size 900x600 --rate 250 --up y";

// Red, green and blue at a position of the rendered sheet, 0 to 1 from the left and the top; lit, so that only their
// ratios count.
DVec3 hueAt(const Picture& picture, double across, double down) {
  const auto p = picture.at(static_cast<int>(across * picture.width), static_cast<int>(down * picture.height));
  const DVec3 color(p[0], p[1], p[2]);
  return color / std::max({color.x, color.y, color.z, 1.0});
}

int selectedIn(const Played& played, const std::string& name) {
  return played.state(name)["selection"]["selected"].get<int>();
}

PointCloud cloudOf(const Played& played, const char* name) { return readCloud(played.folder.path() / name).cloud; }

const Attribute& fieldIn(const PointCloud& cloud, std::string_view name) {
  const auto found = std::ranges::find(cloud.extra, name, &Attribute::name);
  REQUIRE(found != cloud.extra.end());
  return *found;
}

std::vector<double> numbersIn(const PointCloud& cloud, std::string_view name) {
  const Attribute& field = fieldIn(cloud, name);
  std::vector<double> numbers;
  visitScalar(field.type, [&]<class T>(std::type_identity<T>) {
    for (std::size_t i = 0; i < cloud.size(); ++i)
      numbers.push_back(static_cast<double>(loadScalar<T>(field.data, i * sizeof(T))));
  });
  return numbers;
}

}  // namespace

TEST_CASE("a picture shows a field in the colours of its map over its range, grey without a number, with a legend") {
  const ScratchFolder folder;
  makeSheets(folder.path());
  const std::string model = (folder / "sheets.ply").string(), image = (folder / "i.png").string();
  const auto render = [&](const std::string& options) {
    works("--quiet render " + model + " -o " + image + " --size 320x320 --up y --pass color --camera 'eye=30,30,100 " +
          "target=30,30,0 up=0,1,0' " + options);
    return Picture(image);
  };
  const auto is = [](const DVec3& seen, const DVec3& expected) { return glm::distance(seen, expected) < 0.12; };
  const DVec3 grey(1, 1, 1);
  const Picture viridis = render("--color-by intensity --color-range 0,59");
  CHECK(is(hueAt(viridis, 0.18, 0.6), {0.68, 0.2, 1}));                                   // violet
  CHECK(is(hueAt(viridis, 0.7, 0.6), {0.57, 1, 0.35}));                                   // a yellow green
  CHECK(is(hueAt(viridis, 0.5, 0.2), grey));                                              // the missing rows
  CHECK(is(hueAt(render("--color-by intensity --color-map red-blue"), 0.5, 0.6), grey));  // white in the middle
  // Beyond the range both ends go on: the left half is as the low end.
  const Picture narrow = render("--color-by intensity --color-range 30,31 --color-map red-blue");
  CHECK(hueAt(narrow, 0.2, 0.6).z < 0.4);
  CHECK(hueAt(narrow, 0.7, 0.6).x < 0.4);
  CHECK(is(hueAt(narrow, 0.2, 0.6), hueAt(narrow, 0.4, 0.6)));
  // 64-bit numbers that a double cannot tell apart.
  const Picture ids = render("--color-by id --color-range 9007199254741022,9007199254741024 --color-map red-blue");
  CHECK(hueAt(ids, 0.3, 0.6).z < 0.4);
  CHECK(hueAt(ids, 0.7, 0.6).x < 0.4);
  // Triangles as discs, with the same legend.
  const Picture triangles = render("--mode mesh --color-by intensity --color-range 0,59");
  for (const double across : {0.18, 0.3, 0.5, 0.7})
    CHECK(is(hueAt(triangles, across, 0.6), hueAt(viridis, across, 0.6)));
  CHECK(is(hueAt(triangles, 0.5, 0.2), grey));
  CHECK(differing(render("--mode mesh"), triangles, 305, 160, 10) > 100);
  // The legend, over the background at the right.
  CHECK(differing(render("--color-by rgb"), viridis, 305, 160, 10) > 100);
  for (const char* made : {"density", "roughness", "curvature", "verticality", "y"}) {
    CAPTURE(made);
    CHECK(differing(render("--color-by rgb"), render(std::string("--color-by ") + made), 160, 160, 20) > 100);
  }
}

TEST_CASE("a field that cannot be shown is refused in one sentence, and nothing is written") {
  const ScratchFolder folder;
  makeSheets(folder.path());
  const std::string render = "render " + (folder / "sheets.ply").string() + " -o " + (folder / "i.png").string() + " ";
  checkEnds(2, render + "--color-by intensty", {"--color-by: unknown field 'intensty'; did you mean 'intensity'?"});
  checkEnds(2, render + "--color-by intensity --color-range 5", {"--color-range: '5' is not LOW,HIGH"});
  checkEnds(2, render + "--color-by intensity --color-range 5,1", {"--color-range: '5,1' begins above its end"});
  checkEnds(2, render + "--color-by height --color-map classes", {"--color-map: classes are numbers of a field"});
  checkEnds(2, render + "--color-by intensity --color-map rainbow", {"--color-map"});
  checkEnds(2, render + "--color-by intensty --mode mesh", {"--color-by: unknown field 'intensty'"});
  CHECK_FALSE(std::filesystem::exists(folder / "i.png"));
}

TEST_CASE("pictures of touched models show fields, and a window without the field says so and opens") {
  const ScratchFolder folder;
  const std::string sphere = (folder / "s.ply").string(), image = (folder / "i.png").string();
  works("--quiet make sphere -n 3000 -o " + sphere);
  for (const char* backend : {"cpu", "vulkan"}) {
    CAPTURE(backend);
    const auto touched = [&](const std::string& color) {
      works("--quiet touch " + sphere + " --backend " + backend +
            " --edit push --penetration 3 --duration 0.2 --rate 250 --size 160x120 --picture " + image + " " + color);
      return Picture(image);
    };
    const Picture heights = touched("--color-by y --color-map grey");
    CHECK(hueAt(heights, 0.5, 0.3).z > 0.95);
    CHECK(differing(heights, touched("--color-by y --color-map turbo"), 80, 60, 30) > 1000);
  }
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 600x400 --rate 250 --color-by clasification", sphereOf(500),
                               "0.2 state %/opened.json\n0.3 quit\n");
  CHECK(says(played->state("opened.json")["errors"].dump(), "--color-by: unknown field 'clasification'"));
  CHECK(played->state("opened.json")["color"] == "rgb");
}

TEST_CASE("the window colours by a field, selects its range, and changes nothing that is saved") {
  if (!hasDisplay()) return;
  const auto played = playWell(kSheets, makeSheets, R"(
0.1 key ctrl+1
0.2 screenshot %/plain.png
0.3 save %/before.ply
0.8 click Tool
0.9 click Colours
1.0 click colour by
1.2 click intensity
1.4 state %/shown.json
1.4 screenshot %/shown.png
1.5 click range
1.7 text 9.5,19
1.8 key enter
2.0 state %/typed.json
2.1 click Select range
2.3 state %/selected.json
2.3 key ctrl+z
2.3 key s
2.35 click Select range
2.4 state %/by_key.json
2.4 click range
2.5 key ctrl+a
2.6 text 7
2.7 key enter
2.9 state %/wrong.json
3.0 click Auto
3.2 click histogram
3.4 state %/dragged.json
3.5 save %/after.ply
4.0 click Auto
4.2 key v
4.3 screenshot %/discs.png
4.4 key m
4.9 screenshot %/triangles.png
5.0 click colour by
5.2 click colour
5.6 screenshot %/own.png
5.7 quit
)");
  const Result shown = played->state("shown.json"), typed = played->state("typed.json");
  CHECK(shown["color"] == "intensity");
  CHECK(shown["color_map"] == "viridis");
  CHECK(shown["color_field"]["count"] == 6000);
  CHECK(shown["color_field"]["missing"] == 1200);
  CHECK(shown["color_field"]["min"] == "0");
  CHECK(shown["color_field"]["max"] == "59");
  CHECK(shown["color_field"]["mean"] == "29.5");
  CHECK(shown["color_field"]["median"] == "29.5");
  CHECK(shown["color_field"]["low"] == "1");
  CHECK(shown["color_field"]["high"] == "58");
  CHECK(shown["color_field"]["deviation"].get<double>() == near(17.3, 0.1));
  CHECK(typed["color_field"]["in_range"] == 10 * 100);
  CHECK(selectedIn(*played, "selected.json") == 1000);
  CHECK(selectedIn(*played, "by_key.json") == 1000);
  CHECK(says(played->state("wrong.json")["errors"].dump(), "'7' is not LOW,HIGH"));
  CHECK(played->state("wrong.json")["color_field"]["in_range"] == 1000);
  // The middle of the histogram is nearer to one end, which goes there.
  const Result dragged = played->state("dragged.json")["color_field"];
  const bool isLow = dragged["high"] == "58";
  CHECK(std::stod(dragged[isLow ? "low" : "high"].get<std::string>()) == within(29.5, 2));
  CHECK(contentOf(played->folder.path() / "before.ply") == contentOf(played->folder.path() / "after.ply"));
  const Picture plain(played->folder.path() / "plain.png"), colored(played->folder.path() / "shown.png");
  CHECK(differing(plain, colored, 347, 300, 40) > 3000);
  CHECK(differing(plain, colored, 622, 428, 20) > 30);  // the legend
  // Triangles have the colours of their points, until these have their own again.
  const auto picture = [&](const char* name) { return Picture(played->folder.path() / name); };
  const auto hue = [&](const char* name, double across) { return hueAt(picture(name), across, 0.8); };
  for (const double across : {0.35, 0.41, 0.48}) {
    CHECK(glm::distance(hue("triangles.png", across), hue("discs.png", across)) < 0.15);
    CHECK(glm::distance(hue("own.png", across), hue("plain.png", across)) < 0.15);
  }
  CHECK(glm::distance(hue("own.png", 0.48), hue("triangles.png", 0.48)) > 0.2);
}

TEST_CASE("a selection is kept as a field, which an expression finds; its errors name their column") {
  if (!hasDisplay()) return;
  const auto played = playWell(kSheets, makeSheets, R"(
0.1 key ctrl+1
0.2 key s
0.2 where intensity == 5
0.3 key delete
0.4 where intensity >= 40 && z > 0
0.5 state %/where.json
0.6 click name of the field
0.8 text right
0.9 key enter
1.1 state %/kept.json
1.2 key ctrl+shift+a
1.3 where right == 1
1.5 state %/found.json
1.6 where right == 
1.8 state %/wrong.json
1.9 where rigth == 1
2.1 state %/unknown.json
2.2 where right == 0
2.4 state %/others.json
2.5 click Keep
2.7 state %/refused.json
2.8 save %/kept.ply
3.2 key ctrl+z
3.2 key ctrl+z
3.2 key ctrl+z
3.3 key ctrl+z
3.6 state %/undone.json
3.7 where right == 1
3.9 state %/gone.json
4.0 quit
)");
  CHECK(selectedIn(*played, "where.json") == 20 * 50);
  CHECK(played->state("kept.json")["undo_count"] == 4);  // two selections, a removal, the field
  CHECK(says(played->state("kept.json")["last_message"].get<std::string>(), "right is 1 of 1000 selected points"));
  CHECK(selectedIn(*played, "found.json") == 1000);
  const auto errorIn = [&](const char* name) {
    return played->state(name)["selection"]["where_error"].get<std::string>();
  };
  CHECK(errorIn("found.json").empty());
  CHECK(says(errorIn("wrong.json"), "where: column 9: a value is expected after '=='"));
  CHECK(selectedIn(*played, "wrong.json") == 1000);  // it stays
  CHECK(says(errorIn("unknown.json"), "did you mean 'right'?"));
  CHECK(selectedIn(*played, "others.json") == 7200 - 100 - 1000);
  CHECK(errorIn("others.json").empty());
  CHECK(says(played->state("refused.json")["errors"].dump(), "has a field right already"));
  const PointCloud kept = cloudOf(*played, "kept.ply");
  CHECK(fieldIn(kept, "right").type == ScalarType::u8);
  const std::vector<double> right = numbersIn(kept, "right"), intensity = numbersIn(kept, "intensity");
  int wrong = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) wrong += right[i] != (intensity[i] >= 40 && kept.positions[i].z > 0);
  CHECK(wrong == 0);
  CHECK(says(errorIn("gone.json"), "unknown field 'right'"));
}

TEST_CASE(
    "the label brush sets a class on the first surface under it, as one change, and leaves locked and hidden points") {
  if (!hasDisplay()) return;
  const auto stroke = [](double from_s, int y) {
    return fmt::format(
        "{0:.1f} mouse 239 {3}\n{1:.1f} button left down\n{1:.1f} mouse 359 {3}\n{2:.1f} mouse 459 {3}\n"
        "{2:.1f} button left up\n",
        from_s, from_s + 0.2, from_s + 0.4, y);
  };
  const auto played =
      playWell(std::string(kSheets) + " --color-by y", makeSheets,
               "0.1 key ctrl+1\n0.2 key s\n0.3 where intensity < 20\n0.5 click Lock\n"
               "0.6 where intensity >= 40\n0.8 click Hide\n0.9 key a\n" +
                   stroke(1.0, 300) + "1.6 state %/nothing.json\n1.7 click class\n1.9 click building\n" +
                   stroke(2.1, 300) + "2.8 state %/labelled.json\n2.9 save %/labelled.ply\n" +
                   "3.3 key ctrl+z\n3.5 state %/undone.json\n3.6 key ctrl+shift+z\n3.7 state " +
                   "%/again.json\n3.8 screenshot %/panel.png\n4.0 quit\n");
  CHECK(says(played->state("nothing.json")["errors"].dump(), "choose a class, or type a value of classification"));
  const Result labelled = played->state("labelled.json");
  CHECK(labelled["selection"]["shape"] == "label");
  CHECK(says(labelled["last_message"].get<std::string>(), "is 6 building"));
  CHECK(labelled["undo_count"].get<int>() == played->state("nothing.json")["undo_count"].get<int>() + 1);
  CHECK(played->state("undone.json")["undo_count"] == played->state("nothing.json")["undo_count"]);
  CHECK(played->state("again.json")["undo_count"] == labelled["undo_count"]);
  const PointCloud cloud = cloudOf(*played, "labelled.ply");
  CHECK(fieldIn(cloud, "classification").type == ScalarType::u8);
  const std::vector<double> classes = numbersIn(cloud, "classification");
  int count = 0, wrong = 0;
  double low = 100, high = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (classes[i] == 0) continue;
    const Vec3& p = cloud.positions[i];
    ++count;
    wrong += classes[i] != 6 || p.z < 0 || p.x < 20 || p.x >= 40;
    low = std::min(low, double{p.y}), high = std::max(high, double{p.y});
  }
  CHECK(wrong == 0);
  CHECK(says(labelled["last_message"].get<std::string>(), fmt::format("of {} points", count)));
  // A band of the ball's width: 5 mm in the hand, of 100 mm for 59 units, to either side.
  CHECK(high - low == within(2 * 5 * 0.59, 1.2));
  CHECK(count > 0.7 * 20 * (high - low));
}

TEST_CASE(
    "strokes carry the field that colours them: moved points have their coordinates, new ones their parents' numbers") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sheets.ply --size 900x600 --rate 250 --up y --edit push --color-by z", makeSheets, R"(
0.1 key ctrl+1
0.3 state %/before.json
0.4 mouse 347 300
0.6 key space down
0.7 button left down
1.3 mouse 399 300
1.6 button left up
1.7 key space up
2.5 state %/after.json
2.6 click Tool
2.7 click Colours
2.8 click colour by
3.0 click intensity
3.3 state %/intensity.json
3.4 save %/pushed.ply
3.9 key ctrl+z
4.5 state %/undone.json
4.6 quit
)");
  const PointCloud pushed = cloudOf(*played, "pushed.ply");
  REQUIRE(played->state("after.json")["edits"] > 0);
  const auto lowest = std::ranges::min_element(pushed.positions, {}, &Vec3::z)->z;
  CHECK(std::stod(played->state("before.json")["color_field"]["min"].get<std::string>()) == -1.5);
  CHECK(std::stod(played->state("after.json")["color_field"]["min"].get<std::string>()) == near(double{lowest}, 0.01));
  CHECK(played->state("after.json")["color_field"]["count"] == pushed.size());
  const std::vector<double> intensity = numbersIn(pushed, "intensity");
  const auto present = std::ranges::count_if(intensity, [](double number) { return !std::isnan(number); });
  CHECK(played->state("intensity.json")["color_field"]["count"] == present);
  CHECK(played->state("undone.json")["color_field"]["count"] == 6000);
}

}  // namespace palpate::view_color_test
