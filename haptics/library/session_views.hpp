// What is read from the points of a session: the points themselves, pictures, meshes, its surface and their rows.
#pragma once

#include <memory>
#include <vector>

#include "haptics/library/gpu_half.hpp"
#include "haptics/library/objects.hpp"
#include "haptics/library/session_queries.hpp"

namespace palpate::library {

/// Follows the edits. For one thread at a time. All functions with a session require that its edits were taken in;
/// `frame` is the newest one if the points move, else null.
class SessionViews {
 public:
  SessionViews(const GpuChoice& gpu, unsigned threads) : gpu_(gpu), queries_(CloudRows(), threads) {}

  std::unique_ptr<BackendKind> gpuBackend() { return gpu_.backend(); }
  /// The clouds and rows that the points come from.
  void setRows(CloudRows rows) { queries_ = {std::move(rows), queries_.threads()}; }

  /// Receives the edits of a session; this must outlive it.
  FollowerMaker follower();
  /// The points are those of another session.
  void forget();
  std::uint64_t edits() const { return edits_; }  ///< number of point states so far

  PointCloud points(const Session& session, const FrameObject* frame) const;
  Image draw(const Session& session, const FrameObject* frame, const PictureRequest& request);
  Mesh mesh(const Session& session, const FrameObject* frame, const pp_mesh_options& options);
  /// Throws StateError if the session has no surface here.
  const SurfaceIndex& surface(const Session& session, const std::shared_ptr<const FrameObject>& frame) {
    return queries_.surfaceOf(session, frame);
  }
  std::vector<pp_row> rows(const Session& session) const { return queries_.rowsOf(session); }
  const SessionQueries& queries() const { return queries_; }

 private:
  class Follower;

  GpuHalf gpu_;
  SessionQueries queries_;
  std::uint64_t edits_ = 0;
};

}  // namespace palpate::library
