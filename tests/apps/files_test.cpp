// Files in the window: browsing, saving to another file, exporting triangles; and inspecting a point.
#include "engine/io/ply_reader.hpp"
#include "tests/apps/every_format.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::files_test {

TEST_CASE("the window opens a file by folder and format, saves it elsewhere, and exports its mesh") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/ball.ply --size 900x640 --rate 250 --backend cpu --resolution 32",
      [](const std::filesystem::path& folder) {
        works("make sphere -n 3000 --size 40 -o " + (folder / "ball.ply").string());
        std::filesystem::create_directory(folder / "inner");
        works("make torus -n 3000 --size 40 -o " + (folder / "ring.ply").string());
        works("convert " + (folder / "ring.ply").string() + " " + (folder / "inner" / "ring.xyz").string());
        std::ofstream(folder / "inner" / "notes.doc") << "no cloud";
      },
      R"(
0.05 key ctrl+o
0.10 screenshot %/dialog.png
0.15 click inner/
0.30 state %/inner.json
0.35 click ring.xyz
0.45 click Open
0.70 state %/opened.json
0.75 key ctrl+shift+s
0.80 click Up
0.90 click Save
1.30 state %/saved.json
1.35 key ctrl+o
1.40 key escape
1.45 state %/cancelled.json
1.50 key M
1.55 click Look
2.00 click Export mesh...
2.10 click Export
2.35 state %/exported.json
2.40 click Export mesh...
2.50 click Replace
2.70 state %/again.json
2.75 quit
)");
  const std::string opened = played->state("opened.json")["model"];
  CHECK(opened.ends_with("inner/ring.xyz"));
  const std::string saved = played->state("saved.json")["last_message"];
  CHECK(says(saved, "ring.xyz is saved"));
  CHECK(std::filesystem::exists(played->folder / "ring.xyz"));
  CHECK(played->state("cancelled.json")["model"] == (played->folder / "ring.xyz").string());  // as last saved
  CHECK(says(played->state("exported.json")["last_message"], "ring-mesh.ply is written"));
  CHECK(says(played->state("again.json")["last_message"], "the old file is kept as"));
  const PointCloud mesh = readPly(played->folder / "ring-mesh.ply");
  CHECK(mesh.size() > 1000);
  CHECK(mesh.hasNormals());
  CHECK(std::filesystem::exists(played->folder / "ring-mesh.ply.bak"));
  CHECK(contentOf(played->folder / "inner" / "notes.doc") == "no cloud");
}

TEST_CASE("picking a position shows the point there, its normal, its attributes and its stiffness") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/ball.ply --size 480x480 --rate 250 --backend cpu",
      [](const std::filesystem::path& folder) {
        std::ofstream file(folder / "ball.ply");
        file << "ply\nformat ascii 1.0\nelement vertex 4002\nproperty float x\nproperty float y\nproperty float z\n"
                "property float nx\nproperty float ny\nproperty float nz\nproperty ushort intensity\nend_header\n";
        // Uniformly on a sphere of 50 about (10, 20, 30); each point's intensity follows from its position.
        const auto write = [&](const DVec3& n) {
          file << 10 + 50 * n.x << ' ' << 20 + 50 * n.y << ' ' << 30 + 50 * n.z << ' ' << n.x << ' ' << n.y << ' '
               << n.z << ' ' << static_cast<int>(1000 + 100 * n.y) << '\n';
        };
        for (int k = 0; k < 4002; ++k) {
          const double y = 1 - 2 * (k + 0.5) / 4002, turn = 2.399963 * k, far = std::sqrt(1 - y * y);
          write({far * std::cos(turn), y, far * std::sin(turn)});
        }
      },
      R"(
0.05 key tab
0.07 key R
0.10 key D
0.15 mouse 240 240
0.50 button left down
0.60 button left up
0.80 state %/picked.json
0.90 quit
)");
  const auto picked = played->state("picked.json")["picked"];
  REQUIRE(!picked.is_null());
  const DVec3 place(picked["place"][0], picked["place"][1], picked["place"][2]);
  const DVec3 position(picked["position"][0], picked["position"][1], picked["position"][2]);
  const DVec3 normal(picked["normal"][0], picked["normal"][1], picked["normal"][2]), middle(10, 20, 30);
  CHECK(glm::length(place - middle) == near(50, 0.02));
  CHECK(glm::length(position - place) < 5);
  CHECK(glm::length(position - middle - 50.0 * normal) < 0.1);
  CHECK(picked["attributes"]["intensity"] == std::to_string(static_cast<int>(1000 + 100 * normal.y)));
  CHECK(picked["stiffness_N_per_mm"] == 0.8);  // the default
  CHECK(says(picked["stiffness_of"], "rigid"));
}

TEST_CASE("the file dialogue filters by format and offers recent folders") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/ball.ply --size 900x640 --rate 250 --backend cpu",
      [](const std::filesystem::path& folder) {
        works("make sphere -n 2000 --size 40 -o " + (folder / "ball.ply").string());
        works("make sphere -n 2000 --size 40 -o " + (folder / "ball.pcd").string());
        works("make sphere -n 2000 --size 40 -o " + (folder / "ball.xyz").string());
        std::filesystem::create_directories(folder / "lately");
        works("make torus -n 2000 --size 40 -o " + (folder / "lately" / "ring.xyz").string());
        std::filesystem::create_directories(folder / "state" / "palpate");
        std::ofstream(folder / "state" / "palpate" / "recent") << (folder / "lately" / "gone.las").string() << '\n';
      },
      R"(
0.05 key ctrl+o
0.10 click format
0.15 click PCD (.pcd)
0.20 click ball.xyz
0.30 state %/hidden.json
0.35 click ball.pcd
0.40 click Open
0.60 state %/filtered.json
0.65 key ctrl+o
0.70 click recent folders
0.75 click %/lately
0.80 click ring.xyz
0.85 click Open
1.05 state %/recent.json
1.10 quit
)");
  CHECK(says(played->state("hidden.json")["last_message"], "'ball.xyz' cannot be clicked"));
  CHECK(played->state("filtered.json")["model"].get<std::string>().ends_with("ball.pcd"));
  CHECK(played->state("recent.json")["model"].get<std::string>().ends_with("lately/ring.xyz"));
}

TEST_CASE("the window exports triangles in each mesh format") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/ball.ply --size 900x640 --rate 250 --backend cpu --resolution 32",
      [](const std::filesystem::path& folder) {
        works("make sphere -n 3000 --size 40 -o " + (folder / "ball.ply").string());
      },
      R"(
0.10 key M
0.15 click Look
0.60 click Export mesh...
0.70 click format
0.75 click OBJ (.obj)
0.80 click Export
1.00 click Export mesh...
1.05 click format
1.10 click STL (.stl)
1.15 click Export
1.35 click Export mesh...
1.40 click format
1.45 click OFF (.off)
1.50 click Export
1.75 quit
)");
  for (const char* name : {"ball-mesh.obj", "ball-mesh.stl", "ball-mesh.off"}) {
    CAPTURE(std::string(name));
    REQUIRE(std::filesystem::exists(played->folder / name));
    const StoredCloud mesh = readCloud(played->folder / name, nullptr, {.asTriangles = true});
    CHECK(mesh.triangles.size() > 1000);
    for (const Vec3& p : mesh.cloud.positions) CHECK(std::abs(glm::length(p) - 20) < 2);
  }
}

TEST_CASE("a file of every format opens when dropped on the window" * kMoreInFull) {
  if (!hasDisplay()) return;
  std::map<std::string, std::string> dropped;
  std::string script;
  const ScratchFolder folder;
  for (const auto& [format, file] : filesOfAllFormats(folder.path())) {
    if (becomesMany(format) && !inFullTier()) continue;
    const std::string state = "dropped" + std::to_string(dropped.size()) + ".json";
    script += fmt::format("{0:.2f} drop {1}\n{0:.2f} state %/{2}\n", 0.1 + 0.1 * static_cast<double>(dropped.size()),
                          file.string(), state);
    dropped[state] = file.string();
  }
  script += fmt::format("{:.2f} quit\n", 0.2 + 0.1 * static_cast<double>(dropped.size()));
  const auto played = playWell(
      "%/first.ply --size 320x240 --rate 250 --backend cpu",
      [](const auto& in) { works("make sphere -n 2000 --size 40 -o " + (in / "first.ply").string()); }, script);
  CHECK(dropped.size() >= byTier<std::size_t>(13, 17));
  for (const auto& [state, file] : dropped) {
    CAPTURE(file);
    CHECK(played->state(state)["model"] == file);
    CHECK(played->state(state)["points"] > 0);
  }
}

}  // namespace palpate::files_test
