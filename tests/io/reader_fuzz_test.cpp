// Every reader that takes bytes from strangers, with files that are made worse, for a while or for as long as one
// likes: PALPATE_FUZZ_S=3600 build/asan/tests_io --source-file='*reader_fuzz*' says how many seconds,
// and PALPATE_FUZZ_FROM from which round on, so that several can run at once.
#include <doctest/doctest.h>

#include <cstdlib>
#include <new>

#include "engine/core/clock.hpp"
#include "engine/io/mesh_import.hpp"
#include "tests/io/damage.hpp"
#include "tests/io/e57_bytes.hpp"
#include "tests/io/laz_bytes.hpp"

namespace palpate::test {

namespace {

/// A file that is right, how much of its beginning says what it holds, and whether it has checksums to be put right.
struct Specimen {
  std::string ending, text;
  std::size_t head;
  bool paged = false;
};

PointCloud smallCloud() {
  PointCloud cloud = reading(variedFile(3, 60).text()).cloud;
  for (std::size_t i = 0; i < cloud.size(); ++i) cloud.normals.emplace_back(0, 0, i % 2 ? 1 : -1);
  return cloud;
}

std::vector<Specimen> specimens() {
  std::vector<Specimen> all;
  const PointCloud cloud = smallCloud();
  const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};
  for (const char* ending : {".ply", ".las", ".laz", ".pcd", ".npy", ".xyz", ".csv", ".pts", ".obj", ".stl", ".off"}) {
    if (std::string_view(".obj .stl .off").find(ending) != std::string_view::npos && !canImportMeshes()) continue;
    for (const bool ascii : {false, true}) {
      const ScratchFolder folder;
      const std::filesystem::path file = folder / (std::string("a") + ending);
      writeCloud(file, cloud, {.ascii = ascii, .triangles = &triangles});
      const std::string text = bytesOf(file);
      all.push_back({ending, text, std::min<std::size_t>(text.size(), 800)});
    }
  }
  for (const unsigned format : {1u, 3u, 6u, 8u})
    all.push_back({".laz", packedFile(variedFile(format, 200, 2), {.chunks = {50, 150}}), 700});
  all.push_back({".laz", packedFile(variedFile(2, 200), {.chunked = false}), 400});
  E57Bytes e57;
  std::vector<double> ramp(50);
  for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = 0.5 * static_cast<double>(i);
  std::vector<std::int64_t> whole(50, 3);
  e57.add({.points = 50,
           .streams = {floats("cartesianX", ramp, true), floats("cartesianY", ramp, false),
                       integers("cartesianZ", whole, -7, 9, "scale=\"0.25\""), integers("intensity", whole, 0, 1000)},
           .more = "<pose><rotation><w>1</w></rotation></pose>"});
  const std::string logical = E57Bytes::unpaged(e57.text());
  all.push_back({".e57", logical, logical.size(), true});
  return all;
}

/// Whether it is read; anything but a refusal with the file's name ends the test.
bool isRead(const ScratchFolder& folder, const Specimen& specimen, Damage& damage) {
  const std::filesystem::path file = folder / ("a" + specimen.ending);
  std::string text = damage.of(specimen.text, specimen.head);
  if (specimen.paged) text = E57Bytes::paged(text + std::string((1020 - text.size() % 1020) % 1020, '\0'));
  std::ofstream(file, std::ios::binary) << text;
  try {
    contentsOf(file);
    const StoredCloud stored = readCloud(file, nullptr, {.samples = 40});
    const std::string ending = cloudFormats().endingToSave(file);
    writeCloud(folder / ("b" + ending), stored.cloud);
    return true;
  } catch (const FileError& error) {
    REQUIRE(std::string(error.what()).find(file.string()) == 0);
    return false;
  }
}

}  // namespace

TEST_CASE("no reader falls over whatever a file has become") {
  const char *given = std::getenv("PALPATE_FUZZ_S"), *first = std::getenv("PALPATE_FUZZ_FROM");
  const double wanted_s = given ? std::atof(given) : 0;
  const std::uint32_t from = first ? static_cast<std::uint32_t>(std::atol(first)) : 0;
  constexpr std::uint32_t kRounds = 25;  // where nobody says how long
  const std::vector<Specimen> all = specimens();
  const ScratchFolder folder;
  const Stopwatch watch;
  std::uint64_t read = 0, refused = 0;
  for (std::uint32_t round = from; wanted_s > 0 ? watch.elapsed_s() < wanted_s : round - from < kRounds; ++round)
    for (const Specimen& specimen : all) {
      CAPTURE(specimen.ending);
      CAPTURE(round);
      Damage damage(round * 2654435761u + 7);
      ++(isRead(folder, specimen, damage) ? read : refused);
    }
  MESSAGE(read, " files were read, and ", refused, " refused, in ", watch.elapsed_s(), " s");
  CHECK(read > 0);
  CHECK(refused > 0);
}

}  // namespace palpate::test
