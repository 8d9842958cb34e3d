// A file of every format.
#pragma once

#include <map>
#include <numbers>

#include "engine/cloud/analytic_shape.hpp"
#include "tests/io/fuzz_specimens.hpp"
#include "tests/labels.hpp"

namespace palpate {

/// The same ball in each format, or the file of the reader's tests; paths by format name.
inline std::map<std::string, std::filesystem::path> filesOfAllFormats(const std::filesystem::path& folder) {
  std::map<std::string, std::filesystem::path> files;
  PointCloud ball = sampleShape(*makeShape("sphere", 40), {.count = 1500, .seed = 1});
  ball.colors.assign(ball.size(), {200, 150, 100, 255});
  // Meshes of rings around the z axis and triangles between them.
  PointCloud rings;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  constexpr std::uint32_t kAround = 24, kRings = 13;
  for (std::uint32_t k = 0; k < kRings; ++k)
    for (std::uint32_t j = 0; j < kAround; ++j) {
      const double tilt = std::numbers::pi * (k + 0.02) / (kRings - 0.96), turn = 2 * std::numbers::pi * j / kAround;
      rings.positions.emplace_back(
          20.0 * DVec3(std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt)));
      const std::uint32_t here = k * kAround + j, beside = k * kAround + (j + 1) % kAround;
      if (k + 1 == kRings) continue;
      triangles.push_back({here, here + kAround, beside});
      triangles.push_back({beside, here + kAround, beside + kAround});
    }
  for (const CloudFormat& format : cloudFormats().all()) {
    if (!format.write) continue;
    const std::filesystem::path file = folder / ("ball" + std::string(format.endings.front()));
    format.write(file, format.ofTriangles ? rings : ball, {.triangles = format.ofTriangles ? &triangles : nullptr});
    files[std::string(format.name)] = file;
  }
  const std::map<std::string, std::string> names{{"copc", "COPC"},
                                                 {"e57", "E57"},
                                                 {"gltf", "glTF"},
                                                 {"colmap", "COLMAP"},
                                                 {"colmap-dense", "COLMAP dense"},
                                                 {"ptx", "PTX"},
                                                 {"splat", "splat"},
                                                 {"spz", "SPZ"},
                                                 {"compressed-3dgs", "compressed 3DGS"}};
  for (const test::Specimen& specimen : test::specimens()) {
    const auto name = names.find(specimen.format);
    if (name == names.end() || files.contains(name->second)) continue;
    const std::filesystem::path place = specimen.beside.empty() ? folder : folder / specimen.format;
    const auto put = [&](const std::string& file, const std::string& text) {
      std::filesystem::create_directories((place / file).parent_path());
      std::ofstream(place / file, std::ios::binary) << text;
    };
    put(specimen.name, specimen.dressed ? specimen.dressed(specimen.text) : specimen.text);
    for (const auto& [file, text] : specimen.beside) put(file, text);
    files[name->second] = specimen.sourceIn(place);
  }
  return files;
}

/// Triangles of any format become half a million points by the same code, which is expensive: the quick tier touches
/// one of these formats and draws none.
inline bool becomesMany(const std::string& format) {
  return format == "glTF" || format == "OBJ" || format == "OFF" || format == "STL";
}

}  // namespace palpate
