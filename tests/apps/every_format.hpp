// A file of every format there is.
#pragma once

#include <map>

#include "engine/cloud/analytic_shape.hpp"
#include "tests/io/fuzz_specimens.hpp"

namespace palpate {

/// The same ball in each format, or else what the readers' tests have of it; where it is, by the format's name.
inline std::map<std::string, std::filesystem::path> filesOfAllFormats(const std::filesystem::path& folder) {
  std::map<std::string, std::filesystem::path> files;
  PointCloud ball = sampleShape(*makeShape("sphere", 40), {.count = 1500, .seed = 1});
  ball.colors.assign(ball.size(), {200, 150, 100, 255});
  const std::vector<std::array<std::uint32_t, 3>> triangles = [&] {  // of neighbours, as good as any
    std::vector<std::array<std::uint32_t, 3>> all;
    for (std::uint32_t k = 0; k + 2 < 1500; k += 3) all.push_back({k, k + 1, k + 2});
    return all;
  }();
  for (const CloudFormat& format : cloudFormats().all()) {
    if (!format.write) continue;
    const std::filesystem::path file = folder / ("ball" + std::string(format.endings.front()));
    format.write(file, ball, {.triangles = format.ofTriangles ? &triangles : nullptr});
    files[std::string(format.name)] = file;
  }
  const std::map<std::string, std::string> names{
      {"copc", "COPC"}, {"e57", "E57"}, {"gltf", "glTF"}, {"colmap", "COLMAP"}};
  for (const test::Specimen& specimen : test::specimens()) {
    const auto name = names.find(specimen.format);
    if (name == names.end() || files.contains(name->second)) continue;
    const std::filesystem::path place = specimen.beside.empty() ? folder : folder / "colmap";
    std::filesystem::create_directories(place);
    const auto put = [&](const std::string& file, const std::string& text) {
      std::ofstream(place / file, std::ios::binary) << text;
    };
    put(specimen.name, specimen.dressed ? specimen.dressed(specimen.text) : specimen.text);
    for (const auto& [file, text] : specimen.beside) put(file, text);
    files[name->second] = specimen.beside.empty() ? place / specimen.name : place;
  }
  return files;
}

}  // namespace palpate
