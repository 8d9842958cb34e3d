#include "haptics/library/session_views.hpp"

#include <cstring>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/voxel_sample.hpp"
#include "haptics/library/failures.hpp"
#include "haptics/library/options.hpp"

namespace palpate::library {

namespace {

pp_row rowFrom(const CloudRows::Row& from) {
  return {
      .row = from.row, .cloud = from.isInserted ? PP_INSERTED : static_cast<std::uint32_t>(from.cloud), .changed = 0};
}

std::unique_ptr<SurfaceIndex> indexOf(std::span<const PointState> points, const SurfaceOptions& options,
                                      unsigned threads) {
  std::vector<Vec3> positions, normals;
  std::vector<std::uint8_t> there;
  positions.reserve(points.size());
  normals.reserve(points.size());
  there.reserve(points.size());
  for (const PointState& point : points) {
    positions.push_back(point.position);
    normals.push_back(point.normal);
    there.push_back(!point.gone);
  }
  return std::make_unique<SurfaceIndex>(std::move(positions), std::move(normals), std::move(there), options, threads);
}

std::unique_ptr<SurfaceIndex> indexOf(const PointCloud& cloud, const SurfaceOptions& options, unsigned threads) {
  return std::make_unique<SurfaceIndex>(cloud.positions, cloud.normals, std::vector<std::uint8_t>(cloud.size(), 1),
                                        options, threads);
}

}  // namespace

const SurfaceIndex& SessionQueries::surfaceOf(const Session& session, const std::shared_ptr<const FrameObject>& frame) {
  if (session.model().fluid()) throw StateError("water and sand have no surface; read their particles as a frame");
  if (session.far())
    throw StateError("this program has only the points around its hands, and so not the whole surface");
  const SurfaceKind kind = session.config().surface.kind;
  if (frame != frame_) forget();
  frame_ = frame;
  if (!index_) {
    SurfaceOptions options = session.surface();
    options.kind = kind;
    if (frame)
      index_ = indexOf(frame->cloud, options, threads_);
    else if (const History* const history = session.pointHistory())
      index_ = indexOf(history->points(), options, threads_);
    else
      index_ = indexOf(session.model().cloud, options, threads_);
  }
  index_->setKind(kind);
  return *index_;
}

std::vector<pp_row> SessionQueries::rowsOf(const Session& session) const {
  const PointCloud& opened = session.model().cloud;
  std::vector<pp_row> rows;
  if (session.far()) {
    const Attribute numbers = session.sculpted().cloud.extra.back();
    rows.resize(numbers.data.size() / sizeOf(numbers.type));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      std::uint32_t number = 0;
      std::memcpy(&number, numbers.data.data() + i * sizeof number, sizeof number);
      rows[i] = {.row = number, .cloud = 0, .changed = session.history() && session.history()->points().knows(number)};
    }
    return rows;
  }
  if (const History* const history = session.pointHistory()) {
    const PointStates& points = history->points();
    rows.reserve(points.present());
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (points[i].gone) continue;
      rows.push_back(rowFrom(rows_.of(i)));
      rows.back().changed =
          i >= opened.size() || points[i].position != opened.positions[i] || points[i].color != packedColor(opened, i);
    }
    return rows;
  }
  rows.reserve(opened.size());
  for (std::size_t i = 0; i < opened.size(); ++i) rows.push_back(rowFrom(rows_.of(i)));
  return rows;
}

pp_surface_point SessionQueries::toldOf(const std::optional<SurfaceHit>& hit, const DVec3& origin) const {
  pp_surface_point told{};
  if (!hit) return told;
  putVector(hit->position + origin, told.position);
  putVector(hit->normal, told.normal);
  told.distance = hit->distance;
  const pp_row from = rowFrom(rows_.of(hit->point));
  told.row = from.row;
  told.cloud = from.cloud;
  told.found = 1;
  told.behind = hit->behind;
  return told;
}

class SessionViews::Follower final : public EditFollower {
 public:
  explicit Follower(SessionViews& views) : views_(views) {}
  void catchUp(const EditBatch& batch) override {
    views_.edits_ += batch.points.size();
    views_.gpu_.follow(batch);
    views_.queries_.follow(batch);
  }

 private:
  SessionViews& views_;
};

FollowerMaker SessionViews::follower() {
  return [this](const Model&, TouchBackend&) { return std::make_unique<Follower>(*this); };
}

void SessionViews::forget() {
  gpu_.forgetPicture();
  queries_.forget();
}

PointCloud SessionViews::points(const Session& session, const FrameObject* frame) const {
  const JobStopScope cuts(JobStopScope::cutting());
  const PointCloud& opened = session.model().cloud;
  if (!frame) return session.pointHistory() || session.far() ? session.sculpted().cloud : opened;
  PointCloud cloud = frame->cloud;
  if (cloud.size() == opened.size()) cloud.colors = opened.colors;
  cloud.storedAs.comments = opened.storedAs.comments;
  return cloud;
}

Image SessionViews::draw(const Session& session, const FrameObject* frame, const PictureRequest& request) {
  const JobStopScope cuts(JobStopScope::cutting());
  try {
    if (!frame) return gpu_.draw(session.scene().layers[0], session.pointHistory(), request);
    gpu_.forgetPicture();
    Model now = session.model();
    now.cloud = points(session, frame);
    return gpu_.draw({std::make_shared<const Model>(std::move(now))}, nullptr, request);
  } catch (const Stopped&) {
    gpu_.forgetPicture();  // it may be incomplete
    throw;
  }
}

Mesh SessionViews::mesh(const Session& session, const FrameObject* frame, const pp_mesh_options& options) {
  const PointCloud cloud = points(session, frame);
  const JobStopScope cuts(JobStopScope::cutting());
  const Model& model = session.model();
  return gpu_.mesh(cloud, thinned(planMesh(coreBoundsOf(cloud), model.spacing, meshFrom(options, model.scale)), cloud));
}

}  // namespace palpate::library
