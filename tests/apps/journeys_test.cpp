// Journeys: a street is labelled, a statue cleaned, a folder of mixed files read. The files that come out are judged.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <set>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/io/cloud_formats.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/content_of.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"
#include "tests/shared_files.hpp"

namespace palpate::journeys_test {
namespace {

enum Part : std::uint8_t { ground, wall, tree };
constexpr std::array<std::uint8_t, 3> kTrueClasses{2, 6, 5};

/// A street of 30 x 20 m far from zero, on a grid of a millimetre: ground, a wall at its far side, and a tree.
struct Street {
  PointCloud cloud;
  std::vector<Part> parts;

  void add(const DVec3& place, Part part) {
    const DVec3 exact = glm::round(1000.0 * (DVec3(637000, 849000, 90) + place)) / 1000.0;
    cloud.exactPositions.push_back(exact);
    cloud.positions.emplace_back(exact - cloud.origin);
    parts.push_back(part);
  }
};

Street street(bool labelled) {
  Street made;
  made.cloud.origin = {637000, 849000, 0};
  // A little noise, the same in each run.
  auto noise = [state = 1u]() mutable {
    state = state * 1664525u + 1013904223u;
    return 0.02 * (static_cast<double>(state >> 8) / (1 << 24) - 0.5);
  };
  for (int x = 0; x < 120; ++x)
    for (int y = 0; y < 80; ++y) made.add({0.25 * x, 0.25 * y, noise()}, ground);
  for (int x = 0; x < 120; ++x)
    for (int z = 3; z < 32; ++z) made.add({0.25 * x, 20.2 + noise(), 0.25 * z}, wall);
  for (int i = 0; i < 2500; ++i) {
    const double z = 1 - (2 * i + 1) / 2500.0, angle = 2.399963229728653 * i, r = std::sqrt(1 - z * z);
    made.add(DVec3(9, 7, 5) + 2.2 * DVec3(r * std::cos(angle), r * std::sin(angle), z) + noise(), tree);
  }
  PointCloud& cloud = made.cloud;
  cloud.storedAs.position = ScalarType::f64;
  cloud.storedAs.grid = CoordinateGrid{.step = DVec3(0.001), .offset = {637000, 849000, 0}};
  Attribute classes{"classification", ScalarType::u8, {}}, intensity{"intensity", ScalarType::u16, {}};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    classes.data.push_back(std::byte(labelled ? kTrueClasses[made.parts[i]] : 1));
    intensity.data.push_back(std::byte(i % 251));
    intensity.data.push_back(std::byte(i % 7));
  }
  cloud.extra = {classes, intensity};
  return made;
}

const Attribute* fieldIn(const PointCloud& cloud, std::string_view name) {
  const auto found = std::ranges::find(cloud.extra, name, &Attribute::name);
  return found == cloud.extra.end() ? nullptr : &*found;
}

// Points and attributes that differ, bit by bit, but for the classes of points for which `mayChange` holds.
std::size_t differences(const PointCloud& before, const PointCloud& after, auto&& mayChange) {
  if (before.size() != after.size() || before.extra.size() != after.extra.size()) return before.size() + after.size();
  std::size_t differing = before.colors != after.colors;
  for (std::size_t i = 0; i < before.size(); ++i) {
    differing += before.fileCoordinates(i) != after.fileCoordinates(i);
    for (const Attribute& had : before.extra) {
      const Attribute* const has = fieldIn(after, had.name);
      if (!has || has->type != had.type) return before.size();
      if (had.name == "classification" && mayChange(i)) continue;
      const std::size_t bytes = sizeOf(had.type);
      differing += std::memcmp(&has->data[i * bytes], &had.data[i * bytes], bytes) != 0;
    }
  }
  return differing;
}

constexpr auto kNone = [](std::size_t) { return false; };

}  // namespace

TEST_CASE("journey 9: ground, wall and tree of a street are labelled by flood and brush, and saved as classes in LAS") {
  if (!hasDisplay()) return;
  const Street truth = street(false);
  const auto prepare = [&](const std::filesystem::path& folder) { writeCloud(folder / "street.las", truth.cloud); };
  std::string script = R"(0.1 key ctrl+7
0.2 click Colours
0.3 click colour by
0.5 click classification
0.7 click Colours
0.8 key s
0.9 key o
1.0 screenshot %/begin.png
1.1 state %/begin.json
1.2 mouse 359 360
1.4 button left down
1.4 button left up
1.8 value classification 2
2.0 mouse 399 200
2.2 button left down
2.2 button left up
2.6 value classification 6
2.8 screenshot %/flooded.png
2.8 state %/flooded.json
3.0 where classification != 1
3.2 click Lock
3.4 key ctrl+shift+a
3.6 key a
3.8 click class
4.0 click high vegetation
)";
  for (int k = 0; k < 12; ++k) script += fmt::format("{:.1f} key ]\n", 4.2 + 0.1 * k);
  // Strokes over the crown from four sides: beside what is locked, and then without it, which hides the far side.
  double at_s = 5.6;
  for (const char* side : {"ctrl+1", "ctrl+3", "ctrl+2", "ctrl+4"}) {
    if (side == std::string("ctrl+2"))
      script += fmt::format("{0:.1f} where classification == 2 || classification == 6\n{0:.1f} key h\n", at_s);
    script += fmt::format("{:.1f} key {}\n", at_s, side);
    script += fmt::format("{:.1f} screenshot %/{}.png\n", at_s + 0.3, side);
    for (const int y : {200, 250, 300, 350, 400}) {
      script += fmt::format("{0:.1f} mouse 59 {1}\n{2:.1f} button left down\n", at_s + 0.4, y, at_s + 0.6);
      for (int x = 340; x <= 880; x += 40) script += fmt::format("{:.2f} mouse {} {}\n", at_s + 0.6 + x / 4000.0, x, y);
      script += fmt::format("{:.2f} button left up\n", at_s + 0.9);
      at_s += 0.7;
    }
    at_s += 0.6;
  }
  script +=
      fmt::format("{0:.1f} state %/end.json\n{0:.1f} screenshot %/end.png\n{1:.1f} save %/labelled.las\n{2:.1f} quit\n",
                  at_s, at_s + 0.2, at_s + 1.2);
  const auto played = playWell("%/street.las --size 900x600 --rate 250 --up z", prepare, script);

  const PointCloud saved = readCloud(played->folder.path() / "labelled.las").cloud;
  const PointCloud before = readCloud(played->folder.path() / "street.las").cloud;
  CHECK(differences(before, saved, [](std::size_t) { return true; }) == 0);
  // The colours follow: ground and wall look different from before, and the statistics know their classes.
  CHECK(played->state("begin.json")["color_field"]["max"] == "1");
  CHECK(played->state("flooded.json")["color_field"]["max"] == "6");
  CHECK(played->state("end.json")["color_field"]["median"] == "5");  // what is not hidden: the tree
  const Picture begin(played->folder.path() / "begin.png"), flooded(played->folder.path() / "flooded.png");
  CHECK(differing(begin, flooded, 359, 330, 10) > 400);
  const Attribute* const classes = fieldIn(saved, "classification");
  REQUIRE(classes);
  REQUIRE(classes->type == ScalarType::u8);
  // Rows: the truth; columns: the class in the file.
  std::map<Part, std::map<int, int>> found;
  for (std::size_t i = 0; i < saved.size(); ++i) ++found[truth.parts[i]][static_cast<int>(classes->data[i])];
  CAPTURE(found[tree][5]);
  CAPTURE(found[ground][2]);
  CAPTURE(found[wall][6]);
  CHECK(found[ground][2] > 0.98 * 120 * 80);
  CHECK(found[wall][6] > 0.98 * 120 * 29);
  CHECK(found[tree][5] > 0.9 * 2500);
  CHECK(found[tree][2] + found[tree][6] == 0);
  CHECK(found[ground][6] + found[wall][2] == 0);
}

TEST_CASE("journey 9 on a scan: what a brush labels in the lidar of Autzen is all that differs in the saved file") {
  const auto autzen = sharedFile("formats/autzen_trim.laz");
  if (!hasDisplay() || autzen.empty()) return;
  const auto played = playWell(
      "%/autzen.laz --size 900x600 --rate 250 --color-by classification",
      [&](const auto& folder) { std::filesystem::copy_file(autzen, folder / "autzen.laz"); }, R"(
0.2 key ctrl+5
0.4 key s
0.5 key a
0.6 click class
0.8 click water
1.0 mouse 299 300
1.2 button left down
1.3 mouse 339 300
1.4 mouse 379 300
1.5 button left up
1.8 state %/labelled.json
1.8 screenshot %/labelled.png
1.9 save %/labelled.laz
3.0 key ctrl+z
3.2 save %/undone.laz
4.2 quit
)");
  const std::filesystem::path& path = played->folder.path();
  const PointCloud before = readCloud(path / "autzen.laz").cloud, after = readCloud(path / "labelled.laz").cloud,
                   undone = readCloud(path / "undone.laz").cloud;
  const std::string said = played->state("labelled.json")["last_message"].get<std::string>();
  const auto is = [&](std::size_t i) { return fieldIn(after, "classification")->data[i] == std::byte{9}; };
  std::size_t water = 0;
  for (std::size_t i = 0; i < after.size(); ++i) water += is(i);
  CHECK(water > 200);
  CHECK(says(said, fmt::format("classification of {} points is 9 water", water)));
  CHECK(differences(before, after, is) == 0);
  CHECK(differences(before, undone, kNone) == 0);
}

TEST_CASE(
    "journey 1: a scan is coloured by its classes and vegetation is hidden; the saved file keeps all points and bits") {
  if (!hasDisplay()) return;
  const auto journey = [](const char* file, const char* hidden, const std::filesystem::path& source) {
    const auto prepare = [&](const std::filesystem::path& folder) {
      if (source.empty()) writeCloud(folder / file, street(true).cloud);
      if (!source.empty()) std::filesystem::copy_file(source, folder / file);
    };
    const std::string saved = "%/saved" + std::filesystem::path(file).extension().string();
    return playWell("%/" + std::string(file) + " --size 900x600 --rate 250 --color-by classification", prepare,
                    "0.2 state %/open.json\n0.2 screenshot %/open.png\n0.3 key s\n0.4 where " + std::string(hidden) +
                        "\n0.6 state %/chosen.json\n0.7 key h\n0.9 state %/hidden.json\n0.9 screenshot %/hidden.png\n" +
                        "1.0 save " + saved + "\n2.0 state %/saved.json\n2.1 quit\n");
  };
  const auto judge = [](const Played& played, const char* file, std::size_t vegetation) {
    const std::filesystem::path& path = played.folder.path();
    const PointCloud before = readCloud(path / file).cloud;
    const PointCloud after =
        readCloud((path / "saved").string() + std::filesystem::path(file).extension().string()).cloud;
    CHECK(played.state("open.json")["color"] == "classification");
    CHECK(played.state("open.json")["color_map"] == "classes");
    CHECK(played.state("open.json")["color_field"]["count"] == before.size());
    CHECK(played.state("chosen.json")["selection"]["selected"] == vegetation);
    CHECK(played.state("hidden.json")["selection"]["hidden"] == vegetation);
    CHECK(played.state("hidden.json")["color_field"]["count"] == before.size() - vegetation);
    CHECK(says(played.state("hidden.json")["notices"].dump(), "points are hidden"));
    CHECK(played.state("saved.json")["points"] == before.size());
    CHECK(differences(before, after, kNone) == 0);
    const Picture open(path / "open.png"), hidden(path / "hidden.png");
    CHECK(differing(open, hidden, 347, 300, 200) > 500);
  };
  judge(*journey("street.las", "classification >= 3 && classification <= 5", {}), "street.las", 2500);
  // The lidar of Autzen has ground and unclassified points: what stands above the ground is not classified.
  if (const auto autzen = sharedFile("formats/autzen_trim.laz"); !autzen.empty()) {
    const PointCloud cloud = readCloud(autzen).cloud;
    const auto count = std::ranges::count(fieldIn(cloud, "classification")->data, std::byte{1});
    judge(*journey("autzen.laz", "classification == 1", autzen), "autzen.laz", static_cast<std::size_t>(count));
  }
}

namespace {

// On a table, with lone points around it, as a scanner leaves them.
constexpr std::size_t kLone = 40, kTable = 60 * 60;
PointCloud onTable(PointCloud statue) {
  const Bounds box = boundsOf(statue);
  const double side = box.longestSide();
  const auto add = [&](const DVec3& position, const DVec3& normal) {
    statue.positions.emplace_back(position);
    statue.normals.emplace_back(normal);
    if (statue.hasColors()) statue.colors.push_back({0, 0, 0, 255});
  };
  for (std::size_t i = 0; i < kLone; ++i) {
    const auto k = static_cast<double>(i);
    add(box.center() + side * DVec3(std::cos(2.4 * k), 0.7 + 0.01 * k, std::sin(2.4 * k)), DVec3(0, 1, 0));
  }
  for (std::size_t i = 0; i < kTable; ++i)
    add({box.center().x + side * (static_cast<double>(i % 60) / 60 - 0.5), box.min.y - 0.03 * side,
         box.center().z + side * (static_cast<double>(i / 60) / 60 - 0.5)},
        DVec3(0, 1, 0));
  return statue;
}

// The soft bumps of a made statue, with a round hole in the middle of each of four sides.
constexpr double kHole = 5;
PointCloud holedStatue(const std::filesystem::path& whole) {
  const PointCloud cloud = readCloud(whole).cloud;
  PointCloud holed;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3& p = cloud.positions[i];
    const double across = std::min(std::hypot(p.x, p.y), std::hypot(p.z, p.y));
    if (across < kHole) continue;
    holed.positions.push_back(p);
    holed.normals.push_back(cloud.normals[i]);
  }
  return holed;
}

std::unique_ptr<Played> cleanStatue(const PointCloud& statue, double widest_mm) {
  const Bounds box = boundsOf(statue);
  const auto prepare = [&](const std::filesystem::path& folder) {
    writeCloud(folder / "statue.ply", onTable(statue));
    std::filesystem::copy_file(folder / "statue.ply", folder / "kept.ply");
  };
  const double scale = 100 / box.longestSide();
  return playWell(fmt::format("%/statue.ply --size 900x600 --rate 250 --up y --mm-per-unit {}", scale), prepare,
                  fmt::format(R"(
0.1 key s
0.2 clean {{"outlier_neighbours": 8, "outlier_sigma": 6}}
0.3 state %/lone.json
0.4 key delete
0.5 where y < {}
0.6 state %/table.json
0.7 key delete
0.8 save %/bare.ply
1.2 clean {{"fill_holes_mm": {}}}
1.3 state %/filled.json
1.4 save %/filled.ply
2.0 key s
2.1 key 5
2.2 key ctrl+1
2.5 mouse 347 300
2.8 key space down
2.9 button left down
3.3 mouse 359 310
3.7 mouse 347 320
4.0 button left up
4.1 key space up
5.0 state %/smoothed.json
5.1 save %/clean.ply
6.0 key ctrl+p
6.5 quit
)",
                              box.min.y - 0.01 * box.longestSide(), widest_mm));
}

// Positions that are in `after` and not in `before`, bit by bit.
std::vector<Vec3> newIn(const PointCloud& before, const PointCloud& after) {
  std::set<std::array<float, 3>> had;
  for (const Vec3& p : before.positions) had.insert({p.x, p.y, p.z});
  std::vector<Vec3> added;
  for (const Vec3& p : after.positions)
    if (!had.contains({p.x, p.y, p.z})) added.push_back(p);
  return added;
}

}  // namespace

TEST_CASE("journey 2: lone points, table and holes of a statue are gone, its seam is smooth, its file as it was") {
  if (!hasDisplay()) return;
  const auto judge = [](const Played& played, std::size_t points) {
    const auto content = [&](const char* name) { return contentOf(played.folder.path() / name); };
    CHECK(content("statue.ply") == content("kept.ply"));
    CHECK(played.state("lone.json")["selection"]["selected"] == kLone);
    CHECK(played.state("table.json")["selection"]["selected"] == kTable);
    const auto cloudOf = [&](const char* name) { return readCloud(played.folder.path() / name).cloud; };
    const PointCloud bare = cloudOf("bare.ply"), filled = cloudOf("filled.ply"), clean = cloudOf("clean.ply");
    CHECK(bare.size() == points);
    const std::vector<Vec3> added = newIn(bare, filled);
    CHECK(added.size() == filled.size() - bare.size());
    CHECK(newIn(filled, bare).empty());
    // A brush of a few mm changes what is under it, and nothing else.
    const std::vector<Vec3> smoothed = newIn(filled, clean);
    CHECK(smoothed.size() > 10);
    CHECK(smoothed.size() < points / 20);
    const Picture picture(played.folder.path() / "clean-1.png");
    CHECK(picture.width > 500);
    return added;
  };
  const ScratchFolder folder;
  works("--quiet make bumpy-sphere -n 20000 -o " + (folder / "whole.ply").string());
  const PointCloud whole = readCloud(folder / "whole.ply").cloud, made = holedStatue(folder / "whole.ply");
  const std::size_t missing = whole.size() - made.size();
  const std::vector<Vec3> added = judge(*cleanStatue(made, 15), made.size());
  CHECK(added.size() == within(static_cast<double>(missing), 0.15 * static_cast<double>(missing)));
  const auto shape = makeShape("bumpy-sphere");
  for (const Vec3& p : added) {
    CHECK(std::abs(shape->signedDistance(DVec3(p))) < 0.2);
    CHECK(std::min(std::hypot(p.x, p.y), std::hypot(p.z, p.y)) < kHole + 1);
  }
  if (const auto bunny = sharedFile("bunny_34834.ply"); !bunny.empty()) {
    const PointCloud scanned = readCloud(bunny).cloud;
    const std::vector<Vec3> closed = judge(*cleanStatue(scanned, 40), scanned.size());
    CHECK(closed.size() == within(530, 80));  // two round holes and two slits below
    const double low = boundsOf(scanned).min.y;
    const auto isBelow = [&](const Vec3& p) { return static_cast<double>(p.y) < low + 0.01; };
    CHECK(std::ranges::count_if(closed, isBelow) > 400);
  }
}

TEST_CASE("journey 8: each of a folder of mixed files is converted, or says why not in a sentence") {
  const ScratchFolder folder;
  const std::filesystem::path mixed = folder / "mixed";
  std::filesystem::create_directory(mixed);
  // Names must differ without their endings: all become PLY.
  std::set<std::string> broken;
  PointCloud plain = street(true).cloud;
  for (const char* ending : {"las", "laz", "ply", "pcd", "npz", "csv", "xyz"})
    writeCloud((mixed / (std::string("good_") + ending + '.' + ending)).string(), plain);
  const auto breaks = [&](const char* name, const std::string& content) {
    std::ofstream(mixed / name, std::ios::binary) << content;
    broken.insert(name);
  };
  breaks("empty.las", "");
  breaks("short.ply",
         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 "
         "2 3\n");
  breaks("words.xyz", "these are words\nand no numbers\n");
  breaks("picture.ply", "\x89PNG\r\n\x1a\n and more");
  breaks("huge.ply",
         "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float "
         "y\nproperty float z\nend_header\n");
  breaks("no_kind.abc", "neither points nor words that name a kind of file\n");
  for (const char* ending : {"las", "laz"}) {
    std::string half = contentOf(mixed / (std::string("good_") + ending + '.' + ending));
    breaks((std::string("cut_") + ending + '.' + ending).c_str(), half.substr(0, half.size() / 2));
  }
  std::size_t shared = 0;
  for (const char* room : {"formats", "wild", "cases/ply", "cases/las", "cases/text", "cases/pcd"}) {
    const auto from = sharedFile(room);
    if (from.empty()) continue;
    for (const auto& entry : std::filesystem::directory_iterator(from)) {
      if (!entry.is_regular_file() || entry.path().extension() == ".json" || entry.path().extension() == ".md")
        continue;
      std::filesystem::copy_file(entry.path(),
                                 mixed / (std::to_string(shared++) + '_' + entry.path().filename().string()));
    }
  }
  if (shared > 0) CHECK(shared >= 40);
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(mixed)) files.push_back(entry.path());
  std::string names;
  for (const auto& file : files) names += " '" + file.string() + "'";
  const std::string json = (folder / "m.json").string();
  const Outcome outcome =
      palpate("--quiet convert" + names + " --to " + (folder / "out").string() + " --format ply --json " + json);
  CHECK(outcome.code == 1);
  const Result result = jsonOf(json);
  REQUIRE(result["files"].size() == files.size());
  std::size_t failed = 0;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Result each = result["files"][i];
    const std::string name = files[i].filename().string();
    CAPTURE(name);
    CAPTURE(each.dump());
    const Outcome info = palpate("info '" + files[i].string() + "'");
    CHECK((info.code == 0 || info.code == 1 || info.code == 2));
    if (each.contains("error")) {
      ++failed;
      const std::string why = each["error"].get<std::string>();
      CHECK(says(why, name));
      CHECK(std::ranges::count(why, '\n') == 0);
      CHECK(why.size() > name.size() + 10);
      CHECK(why.size() < 700);
      CHECK(!name.starts_with("good_"));
      CHECK_FALSE(std::filesystem::exists(folder / "out" / files[i].filename().replace_extension(".ply")));
    } else {
      CHECK(!broken.contains(name));
      CHECK(readCloud(folder / "out" / files[i].filename().replace_extension(".ply")).cloud.size() > 0);
    }
  }
  CHECK(result["failed"] == failed);
  CHECK(failed >= broken.size());
  MESSAGE(files.size(), " files, of which ", failed, " say why they cannot be read");
}

}  // namespace palpate::journeys_test
