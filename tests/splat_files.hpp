// Splat files of every degree of harmonics, made by the tests themselves, and their rows read without the reader.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <set>
#include <string>
#include <vector>

#include "tests/gaussian_scenes.hpp"

namespace palpate::test {

/// The bytes of a splat file as training programs write them: little-endian floats.
struct SplatFile {
  std::vector<std::string> names;
  std::vector<std::string> rows;  ///< bytes of each Gaussian

  std::size_t column(const std::string& name) const {
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  }
  float at(std::size_t row, const std::string& name) const {
    float value = 0;
    std::memcpy(&value, rows[row].data() + 4 * column(name), 4);
    return value;
  }
  DVec3 center(std::size_t row) const { return {at(row, "x"), at(row, "y"), at(row, "z")}; }
  std::string bytes(const std::string& comments = "comment trained by a test\n") const {
    std::string text =
        "ply\nformat binary_little_endian 1.0\n" + comments + fmt::format("element vertex {}\n", rows.size());
    for (const std::string& name : names) text += fmt::format("property float {}\n", name);
    text += "end_header\n";
    for (const std::string& row : rows) text += row;
    return text;
  }
};

inline std::vector<std::string> splatNames(unsigned degree) {
  std::vector<std::string> names{"x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"};
  for (unsigned k = 0; k < 3 * ((degree + 1) * (degree + 1) - 1); ++k) names.push_back(fmt::format("f_rest_{}", k));
  for (const char* name : {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"})
    names.emplace_back(name);
  return names;
}

inline SplatFile splatFileOf(const GaussianScene& scene, unsigned degree) {
  SplatFile file{.names = splatNames(degree), .rows = {}};
  SceneRandom random(degree + 7);
  for (std::size_t i = 0; i < scene.size(); ++i) {
    std::string& row = file.rows.emplace_back();
    const auto put = [&](double value) {
      const auto single = static_cast<float>(value);
      row.append(reinterpret_cast<const char*>(&single), sizeof single);
    };
    const auto three = [&](const auto& v) { put(v.x), put(v.y), put(v.z); };
    three(scene.centers[i]), three(DVec3(0)), three(scene.colorHarmonics[i]);
    for (std::size_t k = 0; k < file.names.size() - 17; ++k) put(0.2 * random.normal());
    put(scene.opacityLogits[i]), three(scene.logScales[i]);
    for (int k = 0; k < 4; ++k) put(scene.rotations[i][k]);
  }
  return file;
}

/// A ball of diameter 20 around the origin, red for high x and green for high y, with faint Gaussians in and around it.
inline SplatFile splatBall(unsigned degree, std::size_t count = 3000, const SceneOptions& more = {.faint = 0.3}) {
  SceneOptions options = more;
  options.count = count;
  return splatFileOf(gaussiansOn(*makeShape("sphere", 20), 400 * std::numbers::pi, options).scene, degree);
}

/// Reads a little-endian PLY file of floats.
inline SplatFile parsedSplats(const std::string& bytes) {
  SplatFile file;
  const std::size_t end = bytes.find("end_header\n") + 11;
  std::size_t count = 0;
  for (std::size_t at = 0; at < end;) {
    const std::size_t next = bytes.find('\n', at);
    const std::string line = bytes.substr(at, next - at);
    if (line.starts_with("element vertex ")) count = std::stoul(line.substr(15));
    if (line.starts_with("property float ")) file.names.push_back(line.substr(15));
    at = next + 1;
  }
  const std::size_t width = 4 * file.names.size();
  for (std::size_t i = 0; i < count && end + (i + 1) * width <= bytes.size(); ++i)
    file.rows.push_back(bytes.substr(end + i * width, width));
  return file;
}

/// For each row of `some` the row of `all` with the same bytes, in ascending order; empty if one is missing.
inline std::vector<std::size_t> rowsIn(const SplatFile& some, const SplatFile& all) {
  std::vector<std::size_t> found;
  std::size_t next = 0;
  for (const std::string& row : some.rows) {
    while (next < all.rows.size() && all.rows[next] != row) ++next;
    if (next == all.rows.size()) return {};
    found.push_back(next++);
  }
  return found;
}

/// Rows that differ between two files of as many Gaussians, and the names of the columns in which any does.
struct SplatDifference {
  std::vector<std::size_t> rows;
  std::set<std::string> columns;
};
inline SplatDifference differenceOf(const SplatFile& a, const SplatFile& b) {
  SplatDifference found;
  for (std::size_t i = 0; i < std::min(a.rows.size(), b.rows.size()); ++i) {
    if (a.rows[i] == b.rows[i]) continue;
    found.rows.push_back(i);
    for (std::size_t k = 0; k < a.names.size(); ++k)
      if (a.rows[i].compare(4 * k, 4, b.rows[i], 4 * k, 4) != 0)
        found.columns.insert(a.names[k].substr(0, a.names[k].find('_')));
  }
  return found;
}

/// Covariance of a Gaussian in world space.
inline glm::dmat3 covarianceOf(const SplatFile& file, std::size_t row) {
  const auto at = [&](const std::string& name) { return static_cast<double>(file.at(row, name)); };
  const DQuat q = glm::normalize(DQuat(at("rot_0"), at("rot_1"), at("rot_2"), at("rot_3")));
  glm::dmat3 covariance(0);
  for (int k = 0; k < 3; ++k) {
    DVec3 axis(0);
    axis[k] = std::exp(at(fmt::format("scale_{}", k)));
    axis = q * axis;
    covariance += glm::outerProduct(axis, axis);
  }
  return covariance;
}

/// Colour of a Gaussian as seen along a unit vector, by the formulas of 3DGS.
inline DVec3 colorAlong(const SplatFile& file, std::size_t row, const DVec3& d) {
  const double x = d.x, y = d.y, z = d.z;
  const double basis[15] = {-0.4886025119029199 * y,
                            0.4886025119029199 * z,
                            -0.4886025119029199 * x,
                            1.0925484305920792 * x * y,
                            -1.0925484305920792 * y * z,
                            0.31539156525252005 * (2.0 * z * z - x * x - y * y),
                            -1.0925484305920792 * x * z,
                            0.5462742152960396 * (x * x - y * y),
                            -0.5900435899266435 * y * (3 * x * x - y * y),
                            2.890611442640554 * x * y * z,
                            -0.4570457994644658 * y * (4 * z * z - x * x - y * y),
                            0.3731763325901154 * z * (2 * z * z - 3 * x * x - 3 * y * y),
                            -0.4570457994644658 * x * (4 * z * z - x * x - y * y),
                            1.445305721320277 * z * (x * x - y * y),
                            -0.5900435899266435 * x * (x * x - 3 * y * y)};
  const std::size_t perChannel = (file.names.size() - 17) / 3;
  DVec3 color(0.5);
  for (std::size_t c = 0; c < 3; ++c) {
    const int channel = static_cast<int>(c);
    color[channel] += 0.28209479177387814 * static_cast<double>(file.at(row, fmt::format("f_dc_{}", c)));
    for (std::size_t k = 0; k < perChannel; ++k)
      color[channel] += basis[k] * static_cast<double>(file.at(row, fmt::format("f_rest_{}", c * perChannel + k)));
  }
  return color;
}

}  // namespace palpate::test
