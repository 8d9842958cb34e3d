// The triangles that the window shows instead of discs.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/core/edit_batch.hpp"
#include "engine/core/point_set.hpp"
#include "engine/mesh/marching_cubes.hpp"
#include "engine/render/frame.hpp"

namespace palpate {

class ColoredField;
struct ColorConfig;
class WindowSession;

/// Rebuilt when another resolution is requested; otherwise updated where points are edited.
class ShownMesh {
 public:
  explicit ShownMesh(Device& sight) : sight_(sight) {}

  /// `edited`: changes since the last call. `field`: what colours the points; null: their own colours do. False if a
  /// rebuild is only announced: on a software driver it takes so long that a frame with a message is shown first.
  /// Throws what the rebuild throws.
  bool follow(const WindowSession& session, std::uint32_t resolution, const EditBatch& edited,
              const ColoredField* field, const ColorConfig& color);
  void clear();

  bool isAnnounced() const { return isAnnounced_; }  ///< the next follow() rebuilds the mesh
  std::uint64_t triangleCount() const { return mesh_ ? mesh_->triangleCount() : 0; }
  std::uint64_t version() const { return version_; }  ///< increases with each change
  double time_ms() const { return time_ms_; }         ///< duration of the last change
  /// Writes the present triangles; returns the name under which an existing file is kept. `lost`: see lostInMeshFile().
  /// Throws FileError, and Error without triangles.
  std::filesystem::path write(const std::string& file, std::vector<std::string>& lost) const;
  /// Requires triangles.
  DrawnMesh drawn(const Bounds& bounds) const;

 private:
  void make(const WindowSession& session, std::uint32_t resolution);
  // Leaves hidden points out, and takes shown ones in.
  std::vector<PointState> hidden(const WindowSession& session);
  void update(std::vector<PointState> states);

  Device& sight_;
  std::unique_ptr<MarchingCubes> mesh_;
  PointSet hidden_;  // that it leaves out
  // The colours of all points by a field, and what they show; empty: their own.
  std::vector<std::array<std::uint8_t, 4>> colors_;
  std::string by_;
  ColorMap map_{};
  FieldColors shown_;
  std::uint32_t resolution_ = 0;
  std::uint64_t version_ = 0;
  double time_ms_ = 0;
  bool isAnnounced_ = false;
};

}  // namespace palpate
