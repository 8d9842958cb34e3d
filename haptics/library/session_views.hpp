// What is read from the points of a session: the points themselves, pictures, meshes, its surface and their rows.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "engine/contact/surface_index.hpp"
#include "haptics/library/gpu_half.hpp"
#include "haptics/library/objects.hpp"
#include "haptics/session/placed_clouds.hpp"
#include "haptics/session/session.hpp"

#include <palpate/palpate.h>

namespace palpate::library {

/// The points of a session as queries need them: an index of its surface, and the rows that its points come from.
/// Made by the first query, and then follows the edits. For one thread at a time.
class SessionQueries {
 public:
  SessionQueries(CloudRows rows, unsigned threads) : rows_(std::move(rows)), threads_(threads) {}

  void follow(const EditBatch& batch) {
    if (index_) index_->follow(batch.points);
  }
  /// The points are those of another session, or frame.
  void forget() { index_.reset(); }
  /// `frame`: newest one, if the points move; else null. All edits must have been taken in. Throws StateError if the
  /// session has no surface here.
  const SurfaceIndex& surfaceOf(const Session& session, const std::shared_ptr<const FrameObject>& frame);

  /// Where the present points come from, in the order of pp_session_cloud().
  std::vector<pp_row> rowsOf(const Session& session) const;
  pp_surface_point toldOf(const std::optional<SurfaceHit>& hit, const DVec3& origin) const;
  unsigned threads() const { return threads_; }

 private:
  CloudRows rows_;
  unsigned threads_;
  std::unique_ptr<SurfaceIndex> index_;
  std::shared_ptr<const FrameObject> frame_;  // that the index is of
};

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
