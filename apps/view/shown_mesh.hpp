// The triangles that the window shows instead of discs.
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "engine/mesh/marching_cubes.hpp"
#include "engine/render/frame.hpp"

namespace palpate {

class WindowSession;

/// Made anew when another lattice is asked for; otherwise it follows what is edited.
class ShownMesh {
 public:
  explicit ShownMesh(Device& sight) : sight_(sight) {}

  /// `edited` since the last call. False where nothing was done yet: a software driver will hold the picture up, so
  /// that one that says so comes first. Throws what making them throws.
  bool follow(const WindowSession& session, std::uint32_t lattice, std::span<const PointState> edited);
  void clear();

  bool isAnnounced() const { return isAnnounced_; }  ///< the next call makes what the last one did not
  std::uint64_t triangleCount() const { return mesh_ ? mesh_->triangleCount() : 0; }
  std::uint64_t version() const { return version_; }  ///< another one after each change
  double time_ms() const { return time_ms_; }         ///< that the last change took
  /// Writes the triangles as they are; a file that is there is kept as what is returned. Throws FileError, and Error
  /// where there are none.
  std::filesystem::path write(const std::string& file) const;
  /// Only while there are triangles.
  DrawnMesh drawn(const Bounds& bounds) const;

 private:
  void make(const WindowSession& session, std::uint32_t lattice);

  Device& sight_;
  std::unique_ptr<MarchingCubes> mesh_;
  std::uint32_t lattice_ = 0;
  std::uint64_t version_ = 0;
  double time_ms_ = 0;
  bool isAnnounced_ = false;
};

}  // namespace palpate
