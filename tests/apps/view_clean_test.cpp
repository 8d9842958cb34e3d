// Cleaning in the window: what a step would drop is selected, what it makes is one change, and it can be stopped.
#include <cmath>
#include <fstream>
#include <string>
#include <thread>

#include "engine/core/clock.hpp"
#include "engine/io/cloud_formats.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/content_of.hpp"
#include "tests/says.hpp"

namespace palpate::view_clean_test {

namespace {

int selectedIn(const Played& played, const char* name) {
  return played.state(name)["selection"]["selected"].get<int>();
}
std::string messageIn(const Played& played, const char* name) {
  return played.state(name)["last_message"].get<std::string>();
}
PointCloud cloudOf(const Played& played, const char* name) { return readCloud(played.folder.path() / name).cloud; }

/// A sphere of radius 50 with a hole of radius 6 at +x, five points twice, and nine far ones.
constexpr int kTwice = 5, kFar = 9;
void makeHoled(const std::filesystem::path& folder) {
  makeSphere(folder, 8000);
  const PointCloud whole = readCloud(folder / "sphere.ply").cloud;
  PointCloud cloud;
  const auto add = [&](const Vec3& position, const Vec3& normal) {
    cloud.positions.push_back(position);
    cloud.normals.push_back(normal);
  };
  for (std::size_t i = 0; i < whole.size(); ++i)
    if (glm::distance(whole.positions[i], Vec3(50, 0, 0)) > 6) add(whole.positions[i], whole.normals[i]);
  for (int k = 0; k < kTwice; ++k) add(cloud.positions[k], cloud.normals[k]);
  for (int k = 0; k < kFar; ++k) {
    const float angle = 0.7f * static_cast<float>(k);
    add(90.0f * Vec3(std::cos(angle), std::sin(angle), 0), Vec3(0, 0, 1));
  }
  writeCloud(folder / "holed.ply", cloud);
}

constexpr const char* kHoled = "%/holed.ply --size 900x600 --rate 250 --mm-per-unit 1";

void checkCleaning(bool isOnGpu) {
  const std::string backend = isOnGpu ? " --backend vulkan" : " --backend cpu";
  const auto played = playWell(kHoled + backend, makeHoled, R"(
0.1 save %/before.ply
0.5 key s
0.6 clean {"outlier_neighbours": 8, "outlier_sigma": 6}
0.7 state %/outliers.json
0.9 key delete
1.0 state %/removed.json
1.1 clean {"drop_duplicates": true}
1.2 state %/duplicates.json
1.3 key delete
1.4 clean {"fill_holes_mm": 12}
1.5 state %/filled.json
1.6 save %/filled.ply
2.0 clean normals flip
2.1 state %/flipped.json
2.2 save %/flipped.ply
2.6 key ctrl+z
2.7 save %/unflipped.ply
3.0 key ctrl+z
3.1 key ctrl+z
3.2 key ctrl+z
3.2 key ctrl+z
3.2 key ctrl+z
3.3 state %/undone.json
3.4 save %/undone.ply
4.0 clean {"radius_neighbours": 3, "radius_mm": 4}
4.1 state %/lone.json
4.2 clean {"subsample_mm": 10}
4.3 state %/subsampled.json
4.4 clean {"upright": "y"}
4.5 save %/upright.ply
5.0 quit
)");
  const int all = played->state("undone.json")["points"];
  CHECK(selectedIn(*played, "outliers.json") == kFar);
  CHECK(messageIn(*played, "outliers.json") ==
        "outliers: 9 points are found, 0.1 % of the points; Delete, while selecting (S), removes what is selected");
  CHECK(played->state("removed.json")["points"] == all - kFar);
  CHECK(selectedIn(*played, "duplicates.json") == kTwice);
  const int filled = played->state("filled.json")["points"];
  const int made = filled - (all - kFar - kTwice);
  CHECK(messageIn(*played, "filled.json") == fmt::format("fill-holes: closes 1 hole with {} new points", made));
  CHECK(std::abs(made - 29) <= 5);  // the area of the cap, by that of a point
  const PointCloud after = cloudOf(*played, "filled.ply");
  REQUIRE(static_cast<int>(after.size()) == filled);
  for (std::size_t i = after.size() - static_cast<std::size_t>(made); i < after.size(); ++i) {
    CHECK(std::abs(glm::length(after.positions[i]) - 50) < 0.1);
    CHECK(glm::distance(after.positions[i], Vec3(50, 0, 0)) < 7);
    CHECK(glm::dot(after.normals[i], glm::normalize(after.positions[i])) > 0.999f);
  }
  const PointCloud flipped = cloudOf(*played, "flipped.ply");
  REQUIRE(flipped.size() == after.size());
  CHECK(flipped.positions == after.positions);
  for (std::size_t i = 0; i < after.size(); ++i) CHECK(flipped.normals[i] == -after.normals[i]);
  const auto content = [&](const char* name) { return contentOf(played->folder.path() / name); };
  CHECK(content("unflipped.ply") == content("filled.ply"));
  CHECK(content("undone.ply") == content("before.ply"));
  CHECK(selectedIn(*played, "lone.json") == kFar);
  // A cell of 10 mm keeps one point: about six in a hundred squared mm of sphere are in a cell.
  CHECK(selectedIn(*played, "subsampled.json") > all * 9 / 10);
  const PointCloud before = cloudOf(*played, "before.ply"), upright = cloudOf(*played, "upright.ply");
  REQUIRE(upright.size() == before.size());
  const float shift = upright.positions[0].z - before.positions[0].y;
  for (std::size_t i = 0; i < before.size(); ++i)
    CHECK(std::abs(upright.positions[i].z - before.positions[i].y - shift) < 1e-3f);
}

}  // namespace

TEST_CASE("outliers and duplicates are selected, holes are closed and normals flipped, each undone to the bit") {
  if (!hasDisplay()) return;
  for (const bool isOnGpu : {false, true}) {
    CAPTURE(isOnGpu);
    checkCleaning(isOnGpu);
  }
}

TEST_CASE("the section Clean has the steps of the table, which its buttons do, and Esc stops one") {
  if (!hasDisplay()) return;
  const auto played = playWell(kHoled, makeHoled, R"(
0.1 click Clean
0.4 click Outliers
0.7 state %/outliers.json
0.8 screenshot %/clean.png
0.9 click Duplicates
1.2 state %/duplicates.json
1.4 click Fill holes
1.8 state %/filled.json
2.0 click Flip
2.3 state %/flipped.json
2.4 quit
)");
  CHECK(selectedIn(*played, "outliers.json") >= kFar);
  CHECK(selectedIn(*played, "duplicates.json") == kTwice);
  CHECK(messageIn(*played, "filled.json") ==
        "fill-holes: closes 0 holes with 0 new points; 1 hole is wider: 11.7 mm");  // none so narrow
  // In the unit of the panel, where the file has none.
  const auto bare = playWell("%/holed.ply --size 600x400 --rate 250", makeHoled,
                             "0.1 clean {\"fill_holes_mm\": 1}\n0.4 state %/open.json\n0.5 quit\n");
  CHECK(messageIn(*bare, "open.json").ends_with(" % of the model"));
  CHECK(says(messageIn(*played, "flipped.json"), "points have other normals"));
  const auto stopped = playWell("%/sphere.ply --size 600x400 --rate 250", sphereOf(150'000), R"(
0.1 impatient
0.2 clean {"fill_holes_mm": 5}
0.2 key escape
0.3 patient
0.9 state %/stopped.json
1.0 key s
1.1 where x > 45
1.2 impatient
1.3 clean {"fill_holes_mm": 5}
1.3 key delete
1.4 patient
1.9 state %/changed.json
2.0 quit
)");
  const Result changed = stopped->state("changed.json");
  CHECK(says(changed["errors"].dump(), "fill-holes: points have changed meanwhile; nothing was done"));
  CHECK(changed["points"] < 150'000);
  CHECK(messageIn(*stopped, "stopped.json") == "fill-holes: stopped; nothing has changed");
  CHECK(stopped->state("stopped.json")["points"] == 150'000);
}

TEST_CASE("a model that cannot be cleaned so says why, and stays as it is") {
  if (!hasDisplay()) return;
  const auto prepare = [](const std::filesystem::path& folder) {
    makeHoled(folder);
    works("--quiet convert " + (folder / "holed.ply").string() + " " + (folder / "upy.ply").string() + " --up y");
  };
  const auto played = playWell("%/upy.ply --size 900x600 --rate 250", prepare, R"(
0.1 save %/before.ply
0.5 clean {"upright": "y"}
0.6 state %/stated.json
0.7 where x > 40
0.8 key s
0.9 click Lock
1.2 clean normals flip
1.3 state %/locked.json
1.4 save %/after.ply
2.0 quit
)");
  CHECK(says(played->state("stated.json")["errors"].dump(), "the file states that y is up, which cannot change here"));
  CHECK(messageIn(*played, "locked.json") == "normals: no normal changes");  // all selected points are locked
  const auto content = [&](const char* name) { return contentOf(played->folder.path() / name); };
  CHECK(content("before.ply") == content("after.ply"));
}

TEST_CASE("exported points are opened in another window, if that is wanted") {
  if (!hasDisplay()) return;
  std::unique_ptr<Played> played;
  std::filesystem::path folder;
  std::atomic<bool> isMade = false;
  std::thread window([&] {
    played = play(kHoled,
                  "0.1 key s\n0.2 where x > 40\n0.3 export %/alone.ply\n0.4 click open beside\n0.8 export %/part.ply\n"
                  "0.9 state %/exported.json\n1.0 await %/seen\n1.1 quit\n",
                  "", [&](const std::filesystem::path& made) {
                    makeHoled(made);
                    folder = made;
                    isMade = true;
                  });
  });
  // The other window remembers what it has opened.
  const auto hasOpened = [&](const char* name) {
    const std::filesystem::path recent = folder / "state" / "palpate" / "recent";
    return std::filesystem::exists(recent) && contentOf(recent).find((folder / name).string()) != std::string::npos;
  };
  const Stopwatch since;
  bool isOpen = false;
  while (!isOpen && since.elapsed_s() < 120) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    isOpen = isMade && hasOpened("part.ply");
  }
  CHECK(isOpen);
  if (isMade) {
    CHECK_FALSE(hasOpened("alone.ply"));
    std::ofstream(folder / "seen") << "yes";
  }
  window.join();
  CHECK_MESSAGE(played->outcome.code == 0, played->outcome.text);
  CHECK(says(messageIn(*played, "exported.json"), "selected points in"));
}

TEST_CASE("that normals are not saved to a file that contains none is said, and is true") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/bare.xyz --size 600x700 --rate 250",
      [](const std::filesystem::path& folder) {
        std::ofstream bare(folder / "bare.xyz");
        constexpr int kCount = 2000;
        for (int i = 0; i < kCount; ++i) {
          const double z = 1 - (2.0 * i + 1) / kCount, r = std::sqrt(1 - z * z), turn = 2.399963 * i;
          bare << 50 * r * std::cos(turn) << ' ' << 50 * r * std::sin(turn) << ' ' << 50 * z << '\n';
        }
      },
      R"(
0.1 click Clean
0.4 click Flip
0.7 state %/flipped.json
0.8 save %/flipped.ply
1.1 quit
)");
  CHECK(messageIn(*played, "flipped.json") ==
        "normals: 2000 points have other normals; they are not saved, since the file contains no normals");
  CHECK_FALSE(cloudOf(*played, "flipped.ply").hasNormals());
}

}  // namespace palpate::view_clean_test
