// Splat scenes through the program: described, cut, touched and saved as splats with all that they have.
#include <algorithm>
#include <cmath>

#include "engine/io/cloud_formats.hpp"
#include "tests/apps/program.hpp"
#include "tests/says.hpp"
#include "tests/shared_files.hpp"
#include "tests/splat_files.hpp"

namespace palpate::test::splats_test {

namespace {

/// A splat scene in a folder; names are of files there.
struct Splats {
  explicit Splats(unsigned degree) : file(splatBall(degree)) {
    std::ofstream(folder / "scene.ply", std::ios::binary) << file.bytes();
    std::ofstream(folder / "path.csv") << "t_s,x,y,z\n0,0,0,11\n0.2,0,0,9\n";
  }
  std::string name(const char* of) const { return (folder / of).string(); }
  SplatFile saved(const char* of) const { return parsedSplats(contentOf(folder / of)); }
  /// Straight down onto the ball's top.
  SplatFile touched(const std::string& options) const {
    works("touch " + name("scene.ply") + " --backend cpu --mm-per-unit 1 --path " + name("path.csv") + " " + options +
          " --save " + name("touched.ply"));
    return saved("touched.ply");
  }

  ScratchFolder folder;
  SplatFile file;
};

}  // namespace

TEST_CASE("info describes a splat scene by its Gaussians and their degree") {
  const Splats splats(2);
  checkEnds(0, "info " + splats.name("scene.ply") + " --json " + splats.name("i.json"),
            {"a splat scene of 3900 Gaussians of degree 2", "element Gaussian: 3900"});
  CHECK(jsonOf(splats.folder / "i.json")["made_from"] ==
        "a splat scene of 3900 Gaussians of degree 2; the points are those of their surface");
  CHECK(jsonOf(splats.folder / "i.json")["lost"].empty());
}

TEST_CASE("convert keeps a splat scene in PLY, crops its Gaussians, and says what other formats do not keep") {
  const Splats splats(3);
  const std::string convert = "convert " + splats.name("scene.ply") + " ", json = " --json " + splats.name("c.json");
  checkEnds(0, convert + splats.name("copy.ply") + json, {"copy.ply: 3900 Gaussians of degree 3 with all properties"});
  const std::string whole = splats.file.bytes("comment trained by a test\ncomment written by palpate\n");
  CHECK((contentOf(splats.folder / "copy.ply") == whole));
  CHECK(jsonOf(splats.folder / "c.json")["gaussians"] == 3900);
  CHECK(jsonOf(splats.folder / "c.json")["lost"].empty());

  for (const char* cut : {"cut.ply", "cut.3dgs.ply"}) {
    checkEnds(0, convert + splats.name(cut) + " --crop 0,-20,-20:20,20,20", {"--crop keeps", "Gaussians"});
    const SplatFile saved = splats.saved(cut);
    const std::vector<std::size_t> rows = rowsIn(saved, splats.file);
    REQUIRE_FALSE(rows.empty());
    const auto isIn = [&](std::size_t i) { return splats.file.at(i, "x") >= 0; };
    std::size_t expected = 0;
    for (std::size_t i = 0; i < splats.file.rows.size(); ++i) expected += isIn(i) ? 1 : 0;
    CHECK(rows.size() == expected);
    CHECK(std::ranges::all_of(rows, isIn));
  }
  // The surface of the whole, not of the part, has its pose; only other formats need that of the part.
  works(convert + splats.name("part.ply") + " --crop 0,-20,-20:20,20,20 --normals flip" + json);
  CHECK(contentOf(splats.folder / "part.ply") == contentOf(splats.folder / "cut.ply"));
  works(convert + splats.name("part.las") + " --crop 0,-20,-20:20,20,20" + json);
  CHECK(jsonOf(splats.folder / "c.json")["points"] > 100);
  checkEnds(0, convert + splats.name("out.las"),
            {"not kept: ",
             "3900 Gaussians of degree 3, of which the points are the surface (opacity, scale, rotation, "
             "colours by the direction of view)"});
  checkEnds(0, convert + splats.name("surface.ply") + " --surface", {"not kept: 3900 Gaussians of degree 3"});
  CHECK(cloudFormats().toRead(splats.folder / "surface.ply").name == "PLY");
  checkEnds(1, convert + splats.name("none.ply") + " --where 'opacity > 100'", {"nothing is left"});
  CHECK_FALSE(std::filesystem::exists(splats.folder / "none.ply"));
  // Gaussians that cannot be seen are kept, too, but have no points.
  works(convert + splats.name("faint.ply") + " --where 'opacity < -3'");
  works("convert " + splats.name("faint.ply") + " " + splats.name("again.ply"));
  CHECK_FALSE(splats.saved("again.ply").rows.empty());
  CHECK(splats.saved("again.ply").rows == splats.saved("faint.ply").rows);
  checkEnds(1, "convert " + splats.name("faint.ply") + " " + splats.name("faint.las"), {"contains no points"});
  checkEnds(1, convert + splats.name("faint.las") + " --where 'opacity < -3'", {"contains no points"});
}

TEST_CASE("a picture of a splat scene is of its Gaussians, says so, and shows the surface when that is chosen") {
  const Splats splats(2);
  const auto drawn = [&](const std::string& options) {
    const std::string render = "render " + splats.name("scene.ply") + " --size 120x90 -o " + splats.name("p.png");
    const Outcome outcome = palpate(render + " --json " + splats.name("p.json") + " " + options);
    CHECK(outcome.code == 0);
    return std::pair(outcome.text, contentOf(splats.folder / "p.png"));
  };
  const auto [words, gaussians] = drawn("");
  CHECK(says(words, "p.png: 3900 Gaussians of degree 2, drawn as they were trained"));
  CHECK(jsonOf(splats.folder / "p.json")["gaussians"] == 3900);
  CHECK(drawn("--splats gaussians").second == gaussians);
  for (const std::string surface : {"--splats surface", "--mode points", "--color-by height", "--pass normal"}) {
    CAPTURE(surface);
    const auto [said, picture] = drawn(surface);
    CHECK(said.find("drawn as they were trained") == std::string::npos);
    CHECK((picture != gaussians));
    CHECK_FALSE(jsonOf(splats.folder / "p.json").contains("gaussians"));
  }
  works("--quiet make sphere -n 500 -o " + splats.name("s.ply"));
  checkEnds(2, "render " + splats.name("s.ply") + " --splats gaussians -o " + splats.name("s.png"),
            {"--splats: the model contains no Gaussians; choose surface or auto"});
}

TEST_CASE("a push moves the Gaussians under it, and undoing it gives the scene back byte by byte") {
  for (const unsigned degree : {0, 3}) {
    CAPTURE(degree);
    const Splats splats(degree);
    const SplatFile pushed = splats.touched("--edit push --no-resample");
    REQUIRE(pushed.rows.size() == splats.file.rows.size());
    const SplatDifference difference = differenceOf(splats.file, pushed);
    CHECK(difference.rows.size() > 5);
    CHECK(difference.rows.size() < 1000);
    const std::set<std::string> allowed{"x", "y", "z", "rot", "f"};
    for (const std::string& column : difference.columns) CHECK_MESSAGE(allowed.contains(column), column);
    double deepest = 0;
    for (const std::size_t i : difference.rows) {
      CHECK(splats.file.center(i).z > 5);
      deepest = std::max(deepest, splats.file.center(i).z - pushed.center(i).z);
      for (const char* name : {"f_dc_0", "f_dc_1", "f_dc_2"}) CHECK(pushed.at(i, name) == splats.file.at(i, name));
    }
    CHECK(deepest > 0.1);
    CHECK(splats.touched("--edit push --undo 1").rows == splats.file.rows);
    const std::string undone = contentOf(splats.folder / "touched.ply");
    const std::string body = splats.file.bytes();
    CHECK(undone.ends_with(body.substr(body.find("element vertex"))));
  }
}

TEST_CASE("a recorded session gives the Gaussians that it saved") {
  const Splats splats(2);
  splats.touched("--edit push --log " + splats.name("session"));
  works("replay " + splats.name("session") + " --recover --save " + splats.name("recovered.ply"));
  CHECK(splats.saved("recovered.ply").rows == splats.saved("touched.ply").rows);
  CHECK(splats.saved("recovered.ply").rows != splats.file.rows);
}

TEST_CASE("paint changes only the colours of Gaussians, and carve removes some and leaves the others") {
  const Splats splats(1);
  const SplatFile painted = splats.touched("--edit paint --paint-color 255,0,0");
  REQUIRE(painted.rows.size() == splats.file.rows.size());
  const SplatDifference difference = differenceOf(splats.file, painted);
  CHECK(difference.rows.size() > 5);
  CHECK(difference.columns == std::set<std::string>{"f"});
  for (const std::size_t i : difference.rows)
    for (int k = 0; k < 9; ++k)
      CHECK(painted.at(i, fmt::format("f_rest_{}", k)) == splats.file.at(i, fmt::format("f_rest_{}", k)));

  const SplatFile carved = splats.touched("--edit carve");
  std::size_t same = 0;
  std::set<std::string> rows(splats.file.rows.begin(), splats.file.rows.end());
  for (const std::string& row : carved.rows) same += rows.contains(row) ? 1 : 0;
  CHECK(same > 3000);
  for (std::size_t i = 0; i < carved.rows.size(); ++i)
    if (!rows.contains(carved.rows[i])) CHECK(carved.center(i).z > 5);
}

TEST_CASE("a trained scene is cropped and pushed, and keeps all other Gaussians byte for byte") {
  const std::filesystem::path model = sharedFile("gaussians_9080.ply");
  if (model.empty()) return;
  const ScratchFolder folder;
  const SplatFile scene = parsedSplats(contentOf(model));
  REQUIRE(scene.rows.size() == 9080);
  works("convert " + model.string() + " " + (folder / "cut.ply").string() + " --where 'x > 0 && opacity > -2'");
  const SplatFile cut = parsedSplats(contentOf(folder / "cut.ply"));
  const std::vector<std::size_t> rows = rowsIn(cut, scene);
  REQUIRE_FALSE(rows.empty());
  std::size_t expected = 0;
  for (std::size_t i = 0; i < scene.rows.size(); ++i) expected += scene.at(i, "x") > 0 && scene.at(i, "opacity") > -2;
  CHECK(rows.size() == expected);

  works("touch " + model.string() +
        " --backend cpu --edit push --yield-depth 0.3 --penetration 6 --no-resample --save " +
        (folder / "pushed.ply").string());
  const SplatFile pushed = parsedSplats(contentOf(folder / "pushed.ply"));
  REQUIRE(pushed.names == scene.names);
  std::set<std::string> known(scene.rows.begin(), scene.rows.end());
  const auto isSame = [&](const std::string& row) { return known.contains(row); };
  const auto same = std::ranges::count_if(pushed.rows, isSame);
  MESSAGE(pushed.rows.size(), " of 9080 Gaussians, ", same, " of them unchanged");
  CHECK(same > 7000);
  CHECK(static_cast<std::size_t>(same) < pushed.rows.size());
}

}  // namespace palpate::test::splats_test
