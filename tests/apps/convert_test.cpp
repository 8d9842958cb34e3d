#include "tests/apps/program.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/io/ply_reader.hpp"
#include "tests/gaussian_scenes.hpp"
#include "tests/near.hpp"
#include "tests/rgbd_writer.hpp"
#include "tests/says.hpp"

namespace palpate::convert_test {

namespace {

constexpr const char* kMesh =
    "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 4\nproperty double x\nproperty float y\nproperty float z\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty int label\nproperty float heat\n"
    "element face 2\nproperty list uchar int vertex_indices\nelement edge 1\nproperty int a\nend_header\n"
    "400000.123456789 0 0 1 2 3 7 0.5\n400001 0 0 4 5 6 8 0.25\n400000 1 0 7 8 9 9 1\n400001 1 0 1 1 1 -1 2\n"
    "3 0 1 2\n3 1 3 2\n5\n";

// A ball of 10 units around (0, 0, 40), its front half seen by one camera at the origin that looks along +z.
void writeColmapFolder(const std::filesystem::path& folder) {
  constexpr int kPoints = 2000;
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "cameras.txt") << "1 SIMPLE_PINHOLE 640 480 500 320 240\n";
  std::ofstream(folder / "images.txt") << "4 1 0 0 0 0 0 0 1 front.jpg\n\n";
  std::ofstream points(folder / "points3D.txt");
  for (int i = 0; i < kPoints; ++i) {  // a spiral of uniform density
    const double z = (i + 0.5) / kPoints, turn = 2.399963229728653 * i, aside = std::sqrt(1 - z * z);
    points << i << ' ' << 10 * aside * std::cos(turn) << ' ' << 10 * aside * std::sin(turn) << ' ' << 40 - 10 * z
           << " 200 100 50 0.5 4 0\n";
  }
}

// A ball of 10 units around the origin, of flat Gaussians, orange from all sides.
void writeGaussians(const std::filesystem::path& file) {
  constexpr int kGaussians = 3000;
  const test::KnownScene known =
      test::gaussiansOn(*makeShape("sphere", 20), 400 * std::numbers::pi, {.count = kGaussians, .faint = 1});
  std::ofstream out(file);
  out << "ply\nformat ascii 1.0\nelement vertex " << known.scene.size() << '\n';
  for (const char* name : {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2",
                           "rot_0", "rot_1", "rot_2", "rot_3"})
    out << "property float " << name << '\n';
  out << "end_header\n";
  for (std::size_t i = 0; i < known.scene.size(); ++i) {
    const DVec3& c = known.scene.centers[i];
    const Vec3& s = known.scene.logScales[i];
    const Vec4& q = known.scene.rotations[i];
    out << c.x << ' ' << c.y << ' ' << c.z << " 1.7 0 -1.7 " << known.scene.opacityLogits[i] << ' ' << s.x << ' ' << s.y
        << ' ' << s.z << ' ' << q[0] << ' ' << q[1] << ' ' << q[2] << ' ' << q[3] << '\n';
  }
}

}  // namespace

TEST_CASE("a folder of depth frames becomes one cloud whose points lie on the recorded surfaces") {
  const ScratchFolder folder;
  const std::filesystem::path room = folder / "room";
  writeRedwood(room, {.frames = 6, .rate_Hz = 30});
  const std::string out = (folder / "out.ply").string(), json = (folder / "a.json").string();
  works("convert " + room.string() + " " + out + " --json " + json);
  CHECK(jsonOf(json)["from"] == "Redwood");
  CHECK(jsonOf(json)["frames"] == 6);
  CHECK(jsonOf(json)["fused"] == 6);
  CHECK(jsonOf(json)["lost_frames"] == 0);
  CHECK(jsonOf(json)["kept"] == std::vector<std::string>{"positions", "normals", "colours"});
  const PointCloud cloud = readPly(out);
  REQUIRE(cloud.size() > 30);
  CHECK(cloud.hasColors());
  for (std::size_t i = 0; i < cloud.size(); ++i)
    CHECK(std::abs(recordedShape().signedDistance(cloud.fileCoordinates(i))) < 0.02);

  // Without poses the frames do not tell the camera's position: a sphere looks the same from all sides.
  std::filesystem::remove(room / "trajectory.log");
  const Outcome unplaced = palpate("convert " + room.string() + " " + out + " --force --json " + json);
  CHECK_MESSAGE(unplaced.code == 0, unplaced.text);
  CHECK(jsonOf(json)["fused"] == 1);
  CHECK(jsonOf(json)["unplaced"] == 5);
  CHECK(unplaced.text.find("frame 1 is not fused: ") != std::string::npos);

  // Impossible depths are reported, and no file is left.
  std::filesystem::remove(out);
  checkEnds(1, "convert " + room.string() + " " + out + " --depth-scale 1000000", {"show no surface"});
  CHECK_FALSE(std::filesystem::exists(out));
}

TEST_CASE("a scene of Gaussians is described, converted, felt and sculpted, and its file stays unchanged") {
  const ScratchFolder folder;
  const std::filesystem::path scene = folder / "scene.ply";
  writeGaussians(scene);
  const std::string before = contentOf(scene), json = (folder / "a.json").string();
  works("info " + scene.string() + " --json " + json);
  CHECK(jsonOf(json)["format"] == "3DGS");
  CHECK(jsonOf(json)["made_from"] ==
        "a splat scene of 6000 Gaussians of degree 0; the points are those of their surface");
  CHECK(jsonOf(json)["elements"]["Gaussian"] == 6000);
  CHECK(jsonOf(json)["normals"] == true);
  CHECK(jsonOf(json)["colors"] == true);

  const std::string out = (folder / "out.ply").string();
  checkEnds(0, "convert " + scene.string() + " " + out + " --surface --json " + json, {"3000 faint"});
  CHECK(jsonOf(json)["from"] == "3DGS");
  CHECK(jsonOf(json)["kept"] == std::vector<std::string>{"positions", "normals", "colours"});
  works("info " + out + " --json " + json);
  CHECK(jsonOf(json)["format"] == "PLY");
  CHECK(jsonOf(json)["made_from"].is_null());

  // Straight down onto the ball's top: the force pushes up at the ball's surface.
  std::ofstream(folder / "path.csv") << "t_s,x,y,z\n0,0,0,11\n0.2,0,0,9.5\n";
  works("touch " + scene.string() + " --backend cpu --mm-per-unit 1 --path " + (folder / "path.csv").string() +
        " --trace " + (folder / "trace.csv").string() + " --edit push --save " + (folder / "pushed.ply").string());
  const std::vector<Row> rows = readTrace(folder / "trace.csv");
  REQUIRE(!rows.empty());
  CHECK(rows.back().contact);
  CHECK(rows.back().force.z > 0.01);
  const auto touched = std::ranges::find_if(rows, [](const Row& row) { return row.contact; });
  CHECK(touched->hip.z == near(10, 0.02));
  CHECK(std::filesystem::exists(folder / "pushed.ply"));
  CHECK(contentOf(scene) == before);

  // Overwritten only if it is named, and then the Gaussians are kept in a backup.
  works("touch " + scene.string() + " --backend cpu --mm-per-unit 1 --path " + (folder / "path.csv").string() +
        " --edit push --save " + scene.string());
  CHECK(contentOf(folder / "scene.ply.bak") == before);
}

TEST_CASE("a COLMAP folder is described, converted and felt, and stays unchanged") {
  const ScratchFolder folder;
  const std::filesystem::path model = folder / "model";
  writeColmapFolder(model);
  const std::string before = contentOf(model / "points3D.txt"), json = (folder / "a.json").string();
  works("info " + model.string() + " --json " + json);
  CHECK(jsonOf(json)["points"] == 2000);
  CHECK(jsonOf(json)["elements"]["image"] == 1);
  CHECK(jsonOf(json)["normals"] == true);
  CHECK(jsonOf(json)["up"] == "-y");

  const std::string out = (folder / "out.ply").string();
  const Outcome outcome = palpate("convert " + model.string() + " " + out + " --json " + json);
  REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
  CHECK(jsonOf(json)["from"] == "COLMAP");
  CHECK(jsonOf(json)["lost"] == std::vector<std::string>{"1 image", "1 camera", "which images saw each point"});

  // Straight onto the camera's side of the ball: the force pushes back to the camera.
  std::ofstream(folder / "path.csv") << "t_s,x,y,z\n0,0,0,29\n0.2,0,0,30.2\n";
  works("touch " + model.string() + " --backend cpu --mm-per-unit 1 --path " + (folder / "path.csv").string() +
        " --trace " + (folder / "trace.csv").string() + " --edit push --save " + (folder / "pushed.ply").string());
  const std::vector<Row> rows = readTrace(folder / "trace.csv");
  REQUIRE(!rows.empty());
  CHECK(rows.back().contact);
  CHECK(rows.back().force.z < -0.01);
  CHECK(std::filesystem::exists(folder / "pushed.ply"));
  const Outcome over = palpate("touch " + model.string() + " --backend cpu --edit push --save " + model.string());
  CHECK(over.code != 0);
  CHECK(over.text.find("is a folder") != std::string::npos);
  CHECK(contentOf(model / "points3D.txt") == before);
  CHECK(std::distance(std::filesystem::directory_iterator(model), {}) == 3);
}

TEST_CASE("convert keeps points, properties and faces, and names what is lost") {
  const ScratchFolder folder;
  const std::string in = (folder / "in.ply").string(), out = (folder / "out.ply").string();
  std::ofstream(in) << kMesh;
  checkEnds(0, "convert " + in + " " + out + " --json " + (folder / "c.json").string(), {"not kept: 1 edge"});
  const auto json = jsonOf(folder / "c.json");
  CHECK(json["points"] == 4);
  CHECK(json["triangles"] == 2);
  CHECK(json["lost"] == std::vector<std::string>{"1 edge"});
  CHECK(json["kept"] == std::vector<std::string>{"positions", "colours", "label", "heat", "2 triangles"});
  CHECK(contentOf(out).find("binary_little_endian") != std::string::npos);

  const std::string text = (folder / "text.ply").string();
  works("convert " + out + " " + text + " --ascii");
  const std::string content = contentOf(text);
  for (const char* line : {"comment by hand", "element vertex 4", "property int label", "property float heat",
                           "\n400000.123456789 0 0 1 2 3 7 0.5\n", "\n400001 1 0 1 1 1 -1 2\n", "\n3 0 1 2\n3 1 3 2\n"})
    CHECK_MESSAGE(content.find(line) != std::string::npos, line << "\n" << content);
  CHECK(content.find("nx") == std::string::npos);

  const std::string bare = (folder / "bare.pts").string();
  checkEnds(0, "convert " + in + " " + bare + " --json " + (folder / "p.json").string(), {"the column 'heat'"});
  CHECK(jsonOf(folder / "p.json")["kept"] == std::vector<std::string>{"positions", "colours"});
}

TEST_CASE("convert adds normals only on request") {
  const ScratchFolder folder;
  const std::string in = (folder / "in.ply").string();
  std::ofstream(in) << kMesh;
  const std::string face = (folder / "face.ply").string(), estimated = (folder / "estimated.ply").string();
  works("convert " + in + " " + face + " --normals face --ascii");
  CHECK(contentOf(face).find("\n400000.123456789 0 0 0 0 1 1 2 3 7 0.5\n") != std::string::npos);
  works("convert " + in + " " + estimated + " --normals estimate");
  CHECK(contentOf(estimated).find("property float nz") != std::string::npos);
  CHECK(palpate("convert " + in + " " + face + " --normals guess").code == 2);
}

TEST_CASE("convert overwrites neither its input nor another existing file") {
  const ScratchFolder folder;
  const std::string in = (folder / "in.ply").string(), other = (folder / "other.ply").string();
  const std::string link = (folder / "link.ply").string();
  std::ofstream(in) << kMesh;
  std::ofstream(other) << "mine";
  std::filesystem::create_symlink(in, link);
  for (const std::string& target : {in, link}) {
    checkEnds(1, "convert " + in + " " + target, {"is the file that is read; name another file, or add --force"});
  }
  CHECK(contentOf(in) == kMesh);
  checkEnds(1, "convert " + in + " " + other, {"exists; name another file, or add --force"});
  CHECK(contentOf(other) == "mine");
  const std::string missing = (folder / "nothing.ply").string();
  for (const std::string& target : {other, std::string("/nowhere/b.ply")}) {
    checkEnds(1, "convert " + missing + " " + target, {missing + ": does not exist"});
  }
  works("convert " + in + " " + other + " --force");
  CHECK(contentOf(other).starts_with("ply\n"));
  CHECK(contentOf(other + ".bak") == "mine");
  works("convert " + in + " " + in + " --force --ascii");
  CHECK(contentOf(in).find("element edge") == std::string::npos);
  CHECK(contentOf(in + ".bak") == kMesh);

  std::ofstream(in) << "ply\nformat ascii 1.0\nelement vertex 2\n";
  CHECK(palpate("convert " + in + " " + other + " --force").code == 1);
  CHECK(contentOf(other).starts_with("ply\nformat binary"));  // unchanged
}

TEST_CASE("convert refuses output names of unknown type, and reports what is wrong with a file") {
  const ScratchFolder folder;
  const std::string in = (folder / "in.ply").string();
  std::ofstream(in) << kMesh;
  checkEnds(2, "convert " + in + " " + (folder / "out.xyzzy").string(), {"clouds are written as .ply"});
  CHECK(palpate("convert " + in).code == 2);
  std::ofstream(in) << "solid cube";
  checkEnds(1, "convert " + in + " " + (folder / "out.ply").string(), {"is not a PLY file"});
  CHECK_FALSE(std::filesystem::exists(folder / "out.ply"));
}

TEST_CASE("convert samples the requested number of points from a mesh, and refuses to sample points") {
  const ScratchFolder folder;
  const std::string mesh = (folder / "roof.obj").string(), points = (folder / "points.ply").string();
  // Two squares that meet at a ridge, one of them four times as large.
  std::ofstream(mesh) << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -4 0 0\nv -4 1 0\nf 1 2 3 4\nf 1 4 6 5\n";
  for (const std::size_t samples : {1u, 999u, 20'000u}) {
    CAPTURE(samples);
    works(fmt::format("convert {} {} --samples {} --force", mesh, points, samples));
    const PointCloud cloud = readPly(points);
    REQUIRE(cloud.size() == samples);
    std::size_t onSmall = 0;
    for (const Vec3& p : cloud.positions) {
      CHECK(p.z == 0);
      CHECK((p.x >= -4 && p.x <= 1 && p.y >= 0 && p.y <= 1));
      onSmall += p.x > 0;
    }
    const double expected = 0.2 * static_cast<double>(samples);
    if (samples > 900) CHECK(static_cast<double>(onSmall) == near(expected, 0.05));
  }
  CHECK(palpate("convert " + mesh + " " + points + " --samples 0 --force").code == 2);
  checkEnds(2, "convert " + points + " " + (folder / "b.ply").string() + " --samples 10",
            {"--samples applies to meshes only; PLY contains points"});
  CHECK_FALSE(std::filesystem::exists(folder / "b.ply"));
}

TEST_CASE("convert keeps triangles from mesh to mesh, samples them for points, and refuses what it cannot write") {
  const ScratchFolder folder;
  const auto file = [&](const char* name) { return (folder / name).string(); };
  std::ofstream(folder / "part.obj") << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nf 1 2 3 4\nf 1 2 5\n";
  works("convert " + file("part.obj") + " " + file("part.stl") + " --json " + file("a.json"));
  CHECK(jsonOf(folder / "a.json")["triangles"] == 3);
  works("convert " + file("part.stl") + " " + file("part.off"));
  const std::string off = contentOf(folder / "part.off");
  CHECK(off.starts_with("OFF\n9 3 0\n"));
  works("convert " + file("part.off") + " " + file("part.ply") + " --samples 500 --json " + file("b.json"));
  CHECK(jsonOf(folder / "b.json")["points"] == 500);
  CHECK(jsonOf(folder / "b.json")["triangles"] == 0);
  checkEnds(2, "convert " + file("part.ply") + " " + file("part.copc.laz"), {"COPC can be read but not written"});
  CHECK_FALSE(std::filesystem::exists(folder / "part.copc.laz"));
  works("convert " + file("part.ply") + " " + file("part.3dgs.ply") + " --json " + file("c.json"));
  CHECK(jsonOf(folder / "c.json")["to"] == "3DGS");
}

TEST_CASE("convert --unit against the unit of the file says that no length is converted") {
  const ScratchFolder folder;
  const auto file = [&](const char* name) { return (folder / name).string(); };
  works("make sphere -n 100 -o " + file("a.ply"));
  works("convert " + file("a.ply") + " " + file("feet.ply") + " --unit ft");
  const Outcome again = palpate("convert " + file("feet.ply") + " " + file("b.ply") + " --unit ft");
  CHECK(again.code == 0);
  CHECK_FALSE(says(again.text, "no length is converted"));
  checkEnds(0, "convert " + file("feet.ply") + " " + file("c.ply") + " --unit m",
            {"feet.ply: its unit is ft; ", "c.ply says m, with the same coordinates: no length is converted"});
}

}  // namespace palpate::convert_test
