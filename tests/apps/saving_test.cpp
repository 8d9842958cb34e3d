// Files written by palpate touch --save: beside existing files, and with all properties of the points.
#include <cmath>

#include "engine/io/cloud_formats.hpp"
#include "engine/io/ply_reader.hpp"
#include "engine/io/ply_writer.hpp"
#include "tests/apps/program.hpp"
#include "tests/says.hpp"

namespace palpate::saving_test {

namespace {

std::string touch(const std::filesystem::path& model, const std::string& options) {
  return "touch " + model.string() + " --backend cpu --edit push --yield-depth 0.3 --penetration 6 " + options;
}

PointCloud sphere(const ScratchFolder& folder, const std::string& name = "sphere.ply") {
  works("--quiet make sphere -n 3000 -o " + (folder / name).string());
  return readPly(folder / name);
}

// A property of every point that identifies the point.
template <class T>
Attribute numbered(const std::string& name, ScalarType type, std::size_t count, double factor) {
  Attribute attribute{.name = name, .type = type, .data = std::vector<std::byte>(count * sizeof(T))};
  for (std::size_t i = 0; i < count; ++i) {
    const T value = static_cast<T>(factor * static_cast<double>(i));
    std::memcpy(attribute.data.data() + i * sizeof(T), &value, sizeof(T));
  }
  return attribute;
}

}  // namespace

TEST_CASE("a scan without normals is saved without them, and after undo it is the scan, number by number") {
  const ScratchFolder folder;
  PointCloud cloud = sphere(folder);
  cloud.normals.clear();
  cloud.origin = DVec3(849000, 4877000, 400);
  const CoordinateGrid grid{.step = DVec3(0.01)};
  cloud.storedAs.grid = grid;
  for (Vec3& place : cloud.positions) place = Vec3(grid.at(grid.nearest(cloud.origin + DVec3(place))) - cloud.origin);
  cloud.extra.push_back(numbered<std::uint16_t>("intensity", ScalarType::u16, cloud.size(), 1));
  writeCloud(folder / "scan.laz", cloud);
  const PointCloud scan = readCloud(folder / "scan.laz").cloud;
  for (const char* options : {"--undo 1 ", ""}) {
    CAPTURE(options);
    works(touch(folder / "scan.laz", options + ("--no-resample --save " + (folder / "out.laz").string())));
    const PointCloud out = readCloud(folder / "out.laz").cloud;
    CHECK_FALSE(out.hasNormals());
    REQUIRE(out.size() == scan.size());
    REQUIRE(out.extra.size() == 1);
    CHECK(out.extra[0].name == "intensity");
    CHECK(out.extra[0].data == scan.extra[0].data);
    bool isSame = true;
    for (std::size_t i = 0; i < out.size(); ++i) isSame &= out.fileCoordinates(i) == scan.fileCoordinates(i);
    CHECK(isSame == (options[0] != '\0'));
  }
  // Normals that were asked for are written.
  works(touch(folder / "scan.laz", "--normals estimate --save " + (folder / "more.laz").string()));
  CHECK(readCloud(folder / "more.laz").cloud.hasNormals());
  // A coordinate has the decimals of its file.
  works("convert " + (folder / "scan.laz").string() + " " + (folder / "scan.csv").string());
  std::ifstream lines(folder / "scan.csv");
  std::size_t longest = 0;
  std::string line;
  std::getline(lines, line);
  CHECK(line == "x,y,z,intensity");
  while (std::getline(lines, line)) longest = std::max(longest, line.size());
  CHECK(longest <= std::string("849050.12,4877050.12,450.12,2999").size());
  works("convert " + (folder / "scan.csv").string() + " " + (folder / "back.laz").string());
  const PointCloud back = readCloud(folder / "back.laz").cloud;
  for (std::size_t i = 0; i < back.size(); ++i) REQUIRE(back.fileCoordinates(i) == scan.fileCoordinates(i));
}

TEST_CASE("touch --save keeps unknown point properties, and new points have those of a neighbour") {
  const ScratchFolder folder;
  PointCloud cloud = sphere(folder);
  cloud.extra.push_back(numbered<float>("scalar_Intensity", ScalarType::f32, cloud.size(), 0.5));
  cloud.extra.push_back(numbered<std::uint16_t>("ring", ScalarType::u16, cloud.size(), 1));
  cloud.extra.push_back(numbered<double>("gps_time", ScalarType::f64, cloud.size(), 1.0 / 3));
  writePly(folder / "scan.ply", cloud);
  std::string backend;
  SUBCASE("cpu") { backend = "cpu"; }
  SUBCASE("vulkan") { backend = "vulkan"; }
  works("touch " + (folder / "scan.ply").string() + " --backend " + backend +
        " --edit push --yield-depth 0.3 --penetration 6 --rate 250 --save " + (folder / "out.ply").string());
  const PointCloud out = readPly(folder / "out.ply");
  REQUIRE(out.extra.size() == 3);
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(out.extra[k].name == cloud.extra[k].name);
    CHECK(out.extra[k].type == cloud.extra[k].type);
    REQUIRE(out.extra[k].data.size() == out.size() * sizeOf(out.extra[k].type));
  }
  std::size_t wrong = 0, moved = 0, added = 0;
  std::vector<bool> seen(cloud.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto ring = loadScalar<std::uint16_t>(out.extra[1].data.data() + 2 * i);
    wrong += ring >= cloud.size();
    if (ring >= cloud.size()) continue;
    wrong += loadScalar<float>(out.extra[0].data.data() + 4 * i) != 0.5f * ring;
    wrong += loadScalar<double>(out.extra[2].data.data() + 8 * i) != 1.0 / 3 * ring;
    // An inserted point has the number of a nearby point.
    wrong += glm::distance(out.positions[i], cloud.positions[ring]) > 15;
    moved += !seen[ring] && out.positions[i] != cloud.positions[ring];
    added += seen[ring];
    seen[ring] = true;
  }
  CHECK(wrong == 0);
  CHECK(moved > 5);
  CHECK(added > 0);
}

TEST_CASE("touch --save over its input names what is lost before the session, and keeps the file") {
  const ScratchFolder folder;
  PointCloud cloud = sphere(folder);
  cloud.storedAs.comments = {"comment of another program"};
  const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}, {1, 2, 3}};
  const auto mesh = folder / "mesh.ply";
  writePly(mesh, cloud, {.triangles = &triangles});
  const std::string original = contentOf(mesh);
  const Outcome first = palpate(touch(mesh, "--save " + mesh.string()));
  REQUIRE_MESSAGE(first.code == 0, first.text);
  const std::string sentence =
      "mesh.ply has 2 faces, which a sculpted cloud cannot keep; the existing file is kept as " +
      (std::filesystem::canonical(folder.path()) / "mesh.ply.bak").string();
  CHECK(says(first.text, sentence));
  CHECK(first.text.find(sentence) < first.text.find("peak force"));
  CHECK(contentOf(folder / "mesh.ply.bak") == original);
  const std::string sculpted = contentOf(mesh);
  CHECK(sculpted != original);
  // It was written by palpate now, and is kept, too; the original stays.
  for (int k = 0; k < 2; ++k) {
    const std::string before = contentOf(mesh);
    const Outcome second = palpate(touch(mesh, "--save " + mesh.string()));
    REQUIRE_MESSAGE(second.code == 0, second.text);
    CHECK(says(second.text, "mesh.ply exists; the existing file is kept as"));
    CHECK(contentOf(folder / "mesh.ply.bak") == original);
    CHECK(contentOf(folder / (k == 0 ? "mesh.ply.bak2" : "mesh.ply.bak3")) == before);
  }
}

TEST_CASE("an existing file of the same name is kept as a backup, by touch and by replay") {
  const ScratchFolder folder;
  sphere(folder);
  const auto out = folder / "out.ply", log = folder / "log";
  std::ofstream(out) << "notes";
  works(touch(folder / "sphere.ply", "--log " + log.string() + " --save " + out.string()));
  CHECK(contentOf(folder / "out.ply.bak") == "notes");
  const std::string saved = contentOf(out);
  std::ofstream(out) << "more notes";
  works("replay " + log.string() + " --recover --save " + out.string());
  CHECK(contentOf(folder / "out.ply.bak") == "notes");
  CHECK(contentOf(folder / "out.ply.bak2") == "more notes");
  CHECK(contentOf(out) == saved);
}

TEST_CASE("a trace that does not fit on the disk does not cost the sculpted points") {
  const ScratchFolder folder;
  sphere(folder);
  const std::string said = (folder / "said").string();
  const std::string command = "bash -c \"ulimit -f 120; " + program() + " " +
                              touch(folder / "sphere.ply", "--trace " + (folder / "t.csv").string() + " --save " +
                                                               (folder / "s.ply").string()) +
                              "\" >" + said + " 2>&1";
  CHECK(WEXITSTATUS(std::system(command.c_str())) == 1);
  CHECK(says(contentOf(said), "t.csv: cannot be written"));
  CHECK(contentOf(said).find("s.ply: cannot") == std::string::npos);
  CHECK(readPly(folder / "s.ply").size() >= 2900);
  CHECK_FALSE(std::filesystem::exists(folder / "t.csv"));
}

TEST_CASE("no output replaces the model, what else is read, or another output") {
  const ScratchFolder folder;
  sphere(folder);
  const std::filesystem::path model = folder / "sphere.ply";
  const std::string name = model.string(), other = (folder / "." / "sphere.ply").string();
  const std::string before = contentOf(model), out = (folder / "out").string();
  works("--quiet touch " + name + " --backend cpu --trajectory " + (folder / "path.csv").string());
  const std::string path = (folder / "path.csv").string(), steps = contentOf(path);
  for (const std::string& wrong : {
           "touch " + name + " --trace " + other,
           "touch " + name + " --log " + name,
           "touch " + name + " --json " + name,
           "touch " + name + " --hand path=builtin:slide,trace=" + name,
           "touch " + name + " --path " + path + " --trace " + path,
           "touch " + name + " --hand path=" + path + " --json " + path,
           "touch " + name + " --trace " + out + " --json " + out,
           "touch " + name + " --hand path=builtin:slide,trace=" + out + " --trace " + out,
           "touch \"" + name + " in water\" --trace " + name,
           "info " + name + " --json " + name,
           "convert " + name + " " + out + ".ply --json " + out + ".ply",
           "mesh " + name + " -o " + name,
       }) {
    CAPTURE(wrong);
    checkEnds(2, wrong, {"is also named by"});
    CHECK(contentOf(model) == before);
    CHECK(contentOf(path) == steps);
  }
  works("--quiet touch " + name + " --backend cpu --trace /dev/null --trajectory /dev/null");
}

TEST_CASE("make keeps the file that it replaces") {
  const ScratchFolder folder;
  const std::string scan = (folder / "scan.ply").string();
  std::ofstream(scan) << "a scan";
  works("make sphere -n 100 -o " + scan);
  works("make sphere -n 200 -o " + scan);
  CHECK(contentOf(folder / "scan.ply.bak") == "a scan");
  CHECK(readPly(folder / "scan.ply.bak2").size() == 100);
  CHECK(readPly(scan).size() == 200);
}

}  // namespace palpate::saving_test
