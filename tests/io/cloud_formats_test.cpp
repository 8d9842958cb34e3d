// The table of formats, reading and writing through a table with an additional format, and what the desktop is told of
// the formats.
#include "engine/io/cloud_formats.hpp"

#include <doctest/doctest.h>

#include <fstream>
#include <regex>
#include <set>

#include "engine/core/atomic_file.hpp"
#include "engine/core/error.hpp"
#include "engine/io/known_formats.hpp"
#include "engine/io/saving.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/source_folder.hpp"

namespace palpate::test::cloud_formats_test {

namespace {

// Three numbers a line; the first line gives the number of lines that follow.
FileContents contentsOfTally(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::uint64_t count = 0;
  if (!(in >> count)) throw FileError::atLine(file, 1, "no tally");
  return {.elements = {{"vertex", count, {{"x"}, {"y"}, {"z"}}}}, .comments = {}};
}

StoredCloud readTally(const std::filesystem::path& file, Log*, const CloudReadOptions&) {
  std::ifstream in(file);
  StoredCloud stored;
  std::uint64_t count = 0;
  for (in >> count; count > 0; --count) {
    Vec3& p = stored.cloud.positions.emplace_back();
    if (!(in >> p.x >> p.y >> p.z)) throw FileError(file, "ends too early");
  }
  return stored;
}

void writeTally(const std::filesystem::path& file, const PointCloud& cloud, const CloudWriteOptions& options) {
  AtomicFile out(file);
  out.write(fmt::format("{}\n", cloud.size()));
  for (const Vec3& p : cloud.positions) out.write(fmt::format("{} {} {}\n", p.x, p.y, p.z));
  if (options.keptAs)
    *options.keptAs = out.commitAndKeep();
  else
    out.commit();
}

std::vector<std::string> lacksOfTally(const PointCloud& cloud) {
  std::vector<std::string> lost;
  if (cloud.hasNormals()) lost.emplace_back("normals");
  return lost;
}

constexpr std::array<std::string_view, 2> kTallyEndings{".tally", ".tly"};
constexpr std::array<std::string_view, 1> kScanEndings{".scan"};

// One format that is read and written, and one that is only read.
const std::array kFormats{
    plyFormat(),
    CloudFormat{.name = "tally",
                .endings = kTallyEndings,
                .contents = contentsOfTally,
                .read = readTally,
                .write = writeTally,
                .lacks = lacksOfTally},
    CloudFormat{.name = "scan", .endings = kScanEndings, .contents = contentsOfTally, .read = readTally}};
const CloudFormats kTable{kFormats};

PointCloud threePoints() {
  PointCloud cloud;
  cloud.positions = {{0, 0, 0.125f}, {1, 0, 0}, {0, 1, 0}};
  return cloud;
}

std::string packaged(const char* name) {
  std::ifstream file(sourceFolder() / "third_party" / "debian" / name);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::set<std::string> matches(const std::string& text, const char* pattern) {
  const std::regex regex(pattern);
  std::set<std::string> found;
  for (std::sregex_iterator at(text.begin(), text.end(), regex), end; at != end; ++at) found.insert((*at)[1]);
  return found;
}

}  // namespace

TEST_CASE("a format is known by its ending; others are refused for writing, with a list of those that are written") {
  CHECK(cloudFormats().toWrite("folder.x/cloud.PLY").name == "PLY");
  CHECK(cloudFormats().toRead("cloud.ply").name == "PLY");
  CHECK(cloudFormats().toRead("no-ending").name == "PLY");
  CHECK_THROWS_WITH_AS(cloudFormats().toWrite("cloud.xyzzy"),
                       "cloud.xyzzy: clouds are written as .ply, .las, .laz, .pcd, .npy, .npz, .xyz, .asc, .txt, .csv, "
                       ".pts, .obj, .stl, .off, .3dgs.ply; use one of these extensions",
                       UsageError);
  CHECK_THROWS_AS(cloudFormats().toWrite("cloud"), UsageError);
  CHECK(cloudFormats().toSave("cloud").name == "PLY");
}

TEST_CASE("points are not written as STL or 3DGS, a mesh not as 3DGS, and a device file is written as PLY") {
  const auto refuses = [](const char* file, Written what, const char* complaint) {
    CHECK_THROWS_WITH_AS(cloudFormats().toWrite(file, what), doctest::Contains(complaint), UsageError);
  };
  refuses("a.stl", Written::points, "a.stl: STL contains triangles, but these are points; clouds are written as .ply");
  refuses("a.3dgs.ply", Written::points, "only palpate convert can write 3DGS");
  refuses("a.3dgs.ply", Written::mesh, "only palpate convert can write 3DGS; meshes are written as .ply");
  refuses("a.foo", Written::mesh, "a.foo: meshes are written as .ply");
  for (const char* file : {"a.xyz", "a.csv", "a.pts", "a.las", "a.laz", "a.pcd", "a.npy", "a.npz"})
    refuses(file, Written::mesh,
            "cannot hold the triangles of a mesh; meshes are written as .ply, .obj, .stl, .off; use one of these");
  CHECK(cloudFormats().toWrite("a.ply", Written::mesh).name == "PLY");
  CHECK(cloudFormats().toWrite("a.stl", Written::mesh).name == "STL");
  CHECK(cloudFormats().toWrite("a.las", Written::points).name == "LAS");
  CHECK(cloudFormats().endingsWritten(Written::points) ==
        ".ply, .las, .laz, .pcd, .npy, .npz, .xyz, .asc, .txt, .csv, .pts");
  if (std::filesystem::exists("/dev/null")) CHECK(cloudFormats().toWrite("/dev/null").name == "PLY");  // not on Windows
}

TEST_CASE("every format that is written is read back, point by point") {
  const ScratchFolder folder;
  const PointCloud cloud = threePoints();
  const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}};
  std::set<std::string_view> tried;
  for (const CloudFormat& format : cloudFormats().all())
    for (const std::string_view ending : format.endings)
      for (const bool ascii : {false, true}) {
        if (!format.write || format.onlyCopied) continue;
        tried.insert(ending);
        CAPTURE(std::string(ending));
        CAPTURE(ascii);
        const std::filesystem::path file = folder / ("a" + std::string(ending));
        CHECK(&cloudFormats().toWrite(file) == &format);
        writeCloud(file, cloud, {.ascii = ascii, .triangles = &triangles});
        CHECK(&cloudFormats().toRead(file) == &format);
        const StoredCloud again = readCloud(file, nullptr, {.asTriangles = true});
        CHECK(contentsOf(file).elements.at(0).count == (format.ofTriangles ? kUsualSamples : cloud.size()));
        REQUIRE(again.cloud.size() == cloud.size());
        for (std::size_t i = 0; i < cloud.size(); ++i)
          CHECK(again.cloud.fileCoordinates(i) == cloud.fileCoordinates(i));
        CHECK(again.triangles ==
              (format.ofTriangles || format.keepsTriangles ? triangles : decltype(again.triangles)()));
        CHECK(again.lost.empty());
      }
  CHECK(tried.size() == 14);
}

TEST_CASE("the longer of two endings of a file name counts, and COPC is refused for writing") {
  CHECK_THROWS_WITH_AS(cloudFormats().toWrite("a.copc.laz"),
                       doctest::Contains("a.copc.laz: COPC can be read but not written; clouds are written as .ply"),
                       UsageError);
  CHECK_THROWS_WITH_AS(cloudFormats().toWrite("folder/A.COPC.LAZ"), doctest::Contains("COPC can be read"), UsageError);
  CHECK(cloudFormats().toWrite("a.laz").name == "LAZ");
  CHECK(cloudFormats().toWrite("copc.laz").name == "LAZ");
  CHECK(cloudFormats().toWrite("a.3dgs.ply").name == "3DGS");
  CHECK(cloudFormats().toWrite("3dgs.ply").name == "PLY");
  // A file without COPC or Gaussians has the shorter ending's format, and sculpted Gaussians are saved as PLY points.
  CHECK(cloudFormats().toRead("a.copc.laz").name == "LAZ");
  CHECK(cloudFormats().toRead("a.3dgs.ply").name == "PLY");
  CHECK(cloudFormats().toSave("a.3dgs.ply").name == "PLY");
  CHECK(cloudFormats().endingToSave("a.3dgs.ply") == ".ply");
  CHECK(cloudFormats().toSave("a.copc.laz").name == "LAZ");
  CHECK(cloudFormats().endingToSave("a.copc.laz") == ".laz");
  CHECK(cloudFormats().endingToSave("a.e57") == ".ply");
}

TEST_CASE("what a file in another format has is what it keeps") {
  StoredCloud stored{.cloud = threePoints(), .triangles = {{0, 1, 2}}, .lost = {}};
  stored.cloud.normals.assign(3, Vec3(0, 0, 1));
  stored.cloud.colors.assign(3, {1, 2, 3, 255});
  stored.cloud.extra = {{"scalar_Intensity", ScalarType::u8, std::vector<std::byte>(3)},
                        {"ring", ScalarType::u8, std::vector<std::byte>(3)}};
  const auto kept = [&](const char* file) { return keptOnTheWay(stored, cloudFormats().toWrite(file)); };
  using Names = std::vector<std::string>;
  CHECK(kept("a.ply") == Names{"positions", "normals", "colours", "scalar_Intensity", "ring", "1 triangle"});
  CHECK(kept("a.xyz") == Names{"positions", "normals", "colours", "scalar_Intensity", "ring"});
  CHECK(kept("a.pts") == Names{"positions", "colours", "scalar_Intensity"});
  CHECK(kept("a.stl") == Names{"positions", "1 triangle"});
  CHECK(kept("a.obj") == Names{"positions", "normals", "colours", "1 triangle"});
  CHECK(lostOnTheWay(stored, cloudFormats().toWrite("a.pts")) == Names{"1 triangle", "normals", "the column 'ring'"});
}

TEST_CASE("colours of 16 bits that are 8 bits are kept as they are, and finer ones are named") {
  const ScratchFolder folder;
  const auto lost = [&](const char* file, const std::string& text) {
    std::ofstream(folder / file) << text;
    return readCloud(folder / file).lost;
  };
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
      "property ushort red\nproperty ushort green\nproperty ushort blue\nend_header\n";
  CHECK(lost("a.ply", ply + "0 0 0 257 65535 2570\n1 0 0 0 514 771\n").empty());
  CHECK(lost("a.ply", ply + "0 0 0 257 65535 2570\n1 0 0 0 514 772\n") ==
        std::vector<std::string>{"colours finer than 8 bits a channel"});
}

TEST_CASE("a format added to the table is read, written and saved like the built-in ones") {
  const ScratchFolder folder;
  const PointCloud cloud = threePoints();
  writeCloud(folder / "a.tally", cloud, {}, kTable);
  CHECK(readCloud(folder / "a.tally", nullptr, {}, kTable).cloud.positions == cloud.positions);
  CHECK(contentsOf(folder / "a.tally", kTable).elements.at(0).count == 3);
  CHECK(cloudFormats().toRead(folder / "a.tally").name == "PTS");  // as without that table
  CHECK(kTable.toWrite("a.TLY").name == "tally");
  CHECK(kTable.toWrite("a.tly").lacks(cloud).empty());

  // The format cannot hold the mark that palpate wrote the file, so the existing file is kept as a backup.
  CHECK(fileInTheWay(folder / "a.tally", kTable).sentence() == "a.tally was not written by palpate");
  CHECK(saveKeeping(folder / "a.tally", cloud, {.formats = kTable}) == folder / "a.tally.bak");
  CHECK(readCloud(folder / "a.tally", nullptr, {}, kTable).cloud.positions == cloud.positions);
}

TEST_CASE("a read-only format is not written, and messages list the formats of the table") {
  CHECK(kTable.toRead("a.scan").name == "scan");
  CHECK(kTable.toSave("a.scan").name == "PLY");
  CHECK_THROWS_WITH_AS(
      kTable.toWrite("a.scan"),
      "a.scan: scan can be read but not written; clouds are written as .ply, .tally, .tly; use one of these extensions",
      UsageError);
  CHECK(kTable.namesRead() == "PLY, tally, scan");
  CHECK(kTable.endingsRead() == ".ply, .tally, .tly, .scan");
  CHECK(kTable.endingsWritten() == ".ply, .tally, .tly");
}

TEST_CASE("the desktop knows every ending that is read, and offers the program for each of its types") {
  const std::string types = packaged("palpate.xml"), entry = packaged("palpate.desktop");
  const std::set<std::string> patterns = matches(types, "<glob pattern=\"\\*([^\"]+)\"/>");
  // Every desktop defines these types; the program is not to become the default for general text.
  const std::set<std::string> elsewhere{".txt", ".csv"};
  std::set<std::string> endings;
  for (const CloudFormat& format : cloudFormats().all())
    for (const std::string_view ending : format.endings) {
      CAPTURE(std::string(ending));
      endings.emplace(ending);
      CHECK(patterns.contains(std::string(ending)) != elsewhere.contains(std::string(ending)));
    }
  for (const std::string& pattern : patterns) CHECK_MESSAGE(endings.contains(pattern), pattern);
  const std::string offered = *matches(entry, "MimeType=([^\n]+)\n").begin();
  const std::set<std::string> named = matches(types, "<mime-type type=\"([^\"]+)\">");
  CHECK(named.size() > 10);
  for (const std::string& type : named) CHECK_MESSAGE(offered.find(type + ";") != std::string::npos, type);
  CHECK(offered.find("text/csv;") != std::string::npos);
}

}  // namespace palpate::test::cloud_formats_test
