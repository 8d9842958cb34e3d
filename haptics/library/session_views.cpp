#include "haptics/library/session_views.hpp"

#include "engine/cloud/voxel_sample.hpp"
#include "haptics/library/failures.hpp"
#include "haptics/library/options.hpp"

namespace palpate::library {

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
