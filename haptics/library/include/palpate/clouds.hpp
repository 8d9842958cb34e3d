/// @file
/// Clouds and meshes in C++17, which palpate.hpp includes.
#ifndef PALPATE_CLOUDS_HPP
#define PALPATE_CLOUDS_HPP

#include <palpate/palpate.h>
#include <palpate/handles.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace pp {

/// Points with normals and colours; immutable.
class Cloud : public detail::Owned<pp_cloud, pp_cloud_close> {
 public:
  using Owned::Owned;
  /// Copies arrays of the program (pp_cloud_create()).
  explicit Cloud(const pp_cloud_arrays& arrays) : Owned(created(arrays)) {}
  /// Reads a file of any supported format. Throws Error with file and line.
  static Cloud read(const std::string& file, const pp_read_options& options = pp_default_read_options()) {
    return Cloud(detail::written<pp_cloud>(pp_cloud_read, file.c_str(), &options));
  }

  /// Writes a file in the format of its extension (pp_cloud_write()).
  void write(const std::string& file, const pp_write_options& options = pp_default_write_options()) const {
    check(pp_cloud_write(handle(), file.c_str(), &options));
  }
  /// Read-only view, valid while this is open; nothing is copied.
  pp_points view() const { return detail::written<pp_points>(pp_cloud_view, handle()); }
  /// Number of points.
  std::uint64_t size() const { return view().count; }
  /// Copies x y z of each point, in file coordinates.
  std::vector<double> positions() const {
    std::vector<double> positions(3 * size());
    check(pp_cloud_copy_positions(handle(), positions.data(), size()));
    return positions;
  }

  /// Selects and cleans points (pp_cloud_prepare()).
  Cloud prepared(const pp_prepare_options& options) const {
    pp_cloud result{};
    check(pp_cloud_prepare(handle(), &options, nullptr, size(), &result));
    return Cloud(result);
  }
  /// Which points stay: 1, else 0.
  std::vector<std::uint8_t> kept(const pp_prepare_options& options) const {
    std::vector<std::uint8_t> kept(size());
    check(pp_cloud_prepare(handle(), &options, kept.data(), kept.size(), nullptr));
    return kept;
  }
  /// The points whose entry is not 0, one for each point (pp_cloud_choose()).
  Cloud choose(const std::vector<std::uint8_t>& mask) const {
    return Cloud(detail::written<pp_cloud>(pp_cloud_choose, handle(), mask.data(), mask.size()));
  }
  /// A number for each point (pp_cloud_compute()).
  std::vector<double> compute(const std::string& number,
                              const pp_prepare_options& options = pp_default_prepare_options()) const {
    std::vector<double> values(size());
    check(pp_cloud_compute(handle(), number.c_str(), &options, values.data(), values.size()));
    return values;
  }

 private:
  static pp_cloud created(const pp_cloud_arrays& arrays) { return detail::written<pp_cloud>(pp_cloud_create, &arrays); }
};

/// A mesh of points; immutable.
class Mesh : public detail::Owned<pp_mesh, pp_mesh_close> {
 public:
  using Owned::Owned;
  /// Read-only view, valid while this is open; nothing is copied.
  pp_triangles view() const { return detail::written<pp_triangles>(pp_mesh_view, handle()); }
  /// Writes a file in the format of its extension (pp_mesh_write()).
  void write(const std::string& file, const pp_write_options& options = pp_default_write_options()) const {
    check(pp_mesh_write(handle(), file.c_str(), &options));
  }
};

}  // namespace pp

#endif  // PALPATE_CLOUDS_HPP
