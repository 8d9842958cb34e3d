// Files of Gaussians made by hand, in any encoding, for the tests of the reader.
#pragma once

#include <array>

#include "tests/gaussian_scenes.hpp"
#include "tests/io/ply_bytes.hpp"

namespace palpate::test::gaussian {

inline constexpr std::array kNames{"x",       "y",       "z",      "nx",       "ny",      "nz",
                                   "f_dc_0",  "f_dc_1",  "f_dc_2", "f_rest_0", "opacity", "scale_0",
                                   "scale_1", "scale_2", "rot_0",  "rot_1",    "rot_2",   "rot_3"};
inline constexpr std::size_t kOpacity = 10, kRest = 9;

/// A square of red Gaussians in z = 0 with normals along z.
inline GaussianScene square(int side) {
  GaussianScene scene;
  SceneRandom random(3);
  for (int i = 0; i < side * side; ++i) {
    const Vec4 rotation = rotationTo({0, 0, 1}, random);
    addGaussian(scene, DVec3(i % side, i / side, 0), {0.75, 0.75, 0.4}, rotation, 0.9, {1, 0, 0.5});
  }
  return scene;
}

struct FileOptions {
  PlyFormat format = PlyFormat::binaryLittleEndian;
  ScalarType type = ScalarType::f32;
  std::string leftOut = {};    ///< a property that is missing
  std::string otherType = {};  ///< a property with an integer type
  std::size_t badRow = 0;      ///< 1-based; 0: none
  std::size_t badColumn = 0;
  double badValue = 0;
};

inline std::string headerOf(const FileOptions& options, std::size_t count) {
  std::string header = magic(options.format) + fmt::format("comment by hand\nelement vertex {}\n", count);
  for (const char* name : kNames)
    if (name != options.leftOut)
      header += fmt::format("property {} {}\n", name == options.otherType ? "uchar" : plyName(options.type), name);
  return header + "end_header\n";
}

inline std::string fileOf(const GaussianScene& scene, const FileOptions& options = {}) {
  BodyWriter body(options.format);
  for (std::size_t i = 0; i < scene.size(); ++i) {
    const DVec3 c = scene.centers[i], f(scene.colorHarmonics[i]), s(scene.logScales[i]);
    const DVec4 q(scene.rotations[i]);
    const std::array<double, kNames.size()> row{
        c.x, c.y, c.z, 0, 0, 0, f.x, f.y, f.z, 0.25, scene.opacityLogits[i], s.x, s.y, s.z, q.x, q.y, q.z, q.w};
    for (std::size_t k = 0; k < kNames.size(); ++k) {
      if (kNames[k] == options.leftOut) continue;
      const bool bad = i + 1 == options.badRow && k == options.badColumn;
      body.put(kNames[k] == options.otherType ? ScalarType::u8 : options.type, bad ? options.badValue : row[k]);
    }
    body.endRow();
  }
  return headerOf(options, scene.size()) + body.text();
}

}  // namespace palpate::test::gaussian
