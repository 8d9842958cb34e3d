#include "engine/io/saving.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <fstream>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/io/ply_reader.hpp"
#include "engine/io/ply_writer.hpp"
#include "tests/content_of.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::saving_test {

namespace {

constexpr const char* kMesh =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "property list uchar int rings\nelement face 2\nproperty list uchar int vertex_indices\nelement edge 1\n"
    "property int a\nelement camera 0\nproperty float f\nend_header\n0 0 0 0\n1 0 0 0\n1 1 0 0\n0 1 0 0\n"
    "3 0 1 2\n3 0 2 3\n5\n";

std::filesystem::path write(const std::filesystem::path& file, const std::string& content) {
  std::ofstream(file, std::ios::binary) << content;
  return file;
}

std::size_t filesIn(const ScratchFolder& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder.path()), {}));
}

}  // namespace

TEST_CASE("losses of a file that a sculpted cloud would replace are named: elements, lists, foreign origin") {
  const ScratchFolder folder;
  const FileInTheWay mesh = fileInTheWay(write(folder / "mesh.ply", kMesh));
  CHECK(mesh.losesSomething());
  CHECK_FALSE(mesh.byPalpate);
  CHECK(mesh.sentence() ==
        "mesh.ply has the list 'rings' of each point, 2 faces, 1 edge, which a sculpted cloud cannot keep");

  const std::string plain =
      "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty "
      "float z\nend_header\n";
  const FileInTheWay foreign = fileInTheWay(write(folder / "plain.ply", plain));
  CHECK(foreign.losesSomething());
  CHECK(foreign.sentence() == "plain.ply was not written by palpate");
  CHECK(fileInTheWay(write(folder / "scan.xyz", "1 2 3")).losesSomething());
  CHECK_FALSE(fileInTheWay(folder / "none.ply").losesSomething());
  CHECK_FALSE(fileInTheWay("").losesSomething());
  CHECK_FALSE(fileInTheWay(folder.path()).losesSomething());
}

TEST_CASE(
    "a replaced file is kept as a backup; of the versions that a session wrote the newest is kept, and all others") {
  const ScratchFolder folder;
  const auto file = write(folder / "mesh.ply", kMesh);
  write(folder / "mesh.ply.bak", "of long ago");
  const PointCloud cloud = readPly(file);
  CHECK(saveKeeping(file, cloud) == folder / "mesh.ply.bak2");
  CHECK(contentOf(folder / "mesh.ply.bak2") == kMesh);
  CHECK(contentOf(folder / "mesh.ply.bak") == "of long ago");
  const FileInTheWay ours = fileInTheWay(file);
  CHECK(ours.byPalpate);
  CHECK_FALSE(ours.losesSomething());
  std::string saved = contentOf(file);
  PointCloud moved = readPly(file);
  OwnSave own;
  const std::string opened = saved;
  for (int k = 0; k < 3; ++k) {
    moved.positions[0].x += 1;
    const auto kept = folder / (k == 0 ? "mesh.ply.bak3" : "mesh.ply.bak4");
    CHECK(saveKeeping(file, moved, {.own = &own}) == kept);
    CHECK(contentOf(kept) == saved);
    saved = contentOf(file);
  }
  CHECK(contentOf(folder / "mesh.ply.bak3") == opened);
  CHECK(saved.find("written by palpate") == saved.rfind("written by palpate"));  // the mark is written once
  CHECK(contentOf(folder / "mesh.ply.bak2") == kMesh);
  CHECK(filesIn(folder) == 5);
  // Another program's version is not the session's.
  write(file, opened);
  std::filesystem::last_write_time(file, own.written + std::chrono::seconds(2));
  CHECK(saveKeeping(file, moved, {.own = &own}) == folder / "mesh.ply.bak5");
  CHECK(contentOf(folder / "mesh.ply.bak5") == opened);
  CHECK(saveKeeping(folder / "new.ply", cloud).empty());

  // A mesh written by palpate loses its faces, too.
  PointCloud marked = cloud;
  markAsOurs(marked);
  const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}};
  writePly(folder / "ours.ply", marked, {.triangles = &triangles});
  CHECK(fileInTheWay(folder / "ours.ply").byPalpate);
  CHECK(fileInTheWay(folder / "ours.ply").sentence() == "ours.ply has 1 face, which a sculpted cloud cannot keep");
  CHECK(saveKeeping(folder / "ours.ply", cloud) == folder / "ours.ply.bak");
}

TEST_CASE("the name for saving beside a file is an unused one") {
  const ScratchFolder folder;
  CHECK(nameBeside(folder / "a.b.ply") == folder / "a.b-sculpted.ply");
  write(folder / "a.b-sculpted.ply", "");
  CHECK(nameBeside(folder / "a.b.ply") == folder / "a.b-sculpted-2.ply");
  CHECK(nameBeside("scan") == "scan-sculpted.ply");
}

TEST_CASE("a file in ASCII stays one, and so does its copy under another name") {
  const ScratchFolder folder;
  const auto file = write(folder / "mesh.ply", kMesh);
  const PointCloud cloud = readPly(file);
  saveKeeping(file, cloud);
  saveKeeping(folder / "copy.ply", cloud, {.like = file});
  saveKeeping(folder / "new.ply", cloud);
  for (const char* name : {"mesh.ply", "copy.ply"})
    CHECK(contentOf(folder / name).starts_with("ply\nformat ascii 1.0\n"));
  CHECK(contentOf(folder / "new.ply").starts_with("ply\nformat binary_little_endian 1.0\n"));
}

TEST_CASE("a file is saved under its name only in its own format") {
  const ScratchFolder folder;
  for (const char* name : {"a.tsv", "a.dat", "a"}) {
    CHECK(whereToSave(write(folder / name, "x\ty\tz\n1\t2\t3\n")) == folder / "a-sculpted.ply");
    CHECK(whereToSave(write(folder / name, kMesh)) == folder / name);
  }
  CHECK(whereToSave(write(folder / "a.csv", "x,y,z\n1,2,3\n")) == folder / "a.csv");
}

}  // namespace palpate::saving_test
