// The points of a session as queries need them: an index of its surface, and the rows that its points come from.
#pragma once

#include <palpate/palpate.h>

#include <memory>
#include <optional>

#include "engine/contact/surface_index.hpp"
#include "haptics/library/objects.hpp"
#include "haptics/session/placed_clouds.hpp"
#include "haptics/session/session.hpp"

namespace palpate::library {

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

}  // namespace palpate::library
