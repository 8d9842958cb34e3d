// A model as a session needs it: a cloud with normals, its scale, its spacing; and what follows from those for touch.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/cloud/up.hpp"
#include "engine/contact/surface.hpp"
#include "engine/core/camera_frustum.hpp"
#include "engine/core/log.hpp"
#include "engine/core/units.hpp"
#include "engine/motion/fused_stream.hpp"
#include "haptics/far_cloud.hpp"
#include "haptics/session/session_config.hpp"
#include "haptics/shared_follower.hpp"
#include "haptics/shared_presence.hpp"

namespace palpate {

class MatterModel;
struct SoftModel;
class TouchBackend;

/// Takes part in a session that several have: from the points as they were joined, and what answers them.
using SharedMaker = std::function<std::unique_ptr<SharedFollower>(const PointCloud& cloud, TouchBackend& backend)>;

struct Model {
  PointCloud cloud;
  ModelScale scale;
  double spacing = 0;      ///< model units
  double wideSpacing = 0;  ///< where the points lie far apart (SpacingRange), model units
  double noise = 0;        ///< of the positions, off their surface (SpacingRange), spacings
  /// Of all discs of a picture, model units, as of particles that fill a body; 0: each is as wide as the surface around
  /// it needs.
  double discRadius = 0;
  std::optional<Bounds> container;  ///< a box that holds the points, as it does water; model units
  double ballRadius = 0;            ///< of the ball that a hand holds in such points, model units; 0: it has none
  /// What a soft body is at rest, whose points are the cloud; null: it is none.
  std::shared_ptr<const SoftModel> soft;
  /// What stands in water or sand; its points are the last of the cloud. Null: nothing does.
  std::shared_ptr<const MatterModel> standing;
  Upright upright;  ///< by the shape
  /// What a picture shows (coreBoundsOf()); all when not given.
  std::optional<Bounds> shown;
  /// What goes on behind the cloud: of a live camera, of a map that frames have fused into, or of a stream that another
  /// session had (Session::releaseStream()). The first session takes it. Null: the model is a file, or a recording that
  /// each session plays from its beginning.
  std::shared_ptr<PlayedStream> stream;
  SharedMaker share;  ///< where others sculpt it, too; empty: nobody does
  /// What brings the points around the hands, where somebody else has all of them: the cloud are then a few from all
  /// over it, which nobody feels. Null: all points are here.
  std::shared_ptr<FarCloud> far;
  std::optional<MatterScene> farMatter;      ///< of which those points are particles; nothing: they are of a surface
  std::optional<PointExtent> extent;         ///< of all of them
  std::shared_ptr<SharedPresence> presence;  ///< of whoever has joined it, too; null: it was not joined
  std::vector<CameraFrustum> cameras;        ///< that took pictures of it, in file coordinates; empty where nobody says
  /// What discs are measured by, model units; 0: they are not.
  double spacingOfDiscs() const { return discRadius > 0 ? 0 : spacing; }
  Bounds shownBounds() const { return shown ? *shown : boundsOf(cloud); }
};

/// Gives a cloud normals that are estimated from its points, and says in words what that took.
using NormalEstimator = std::function<std::string(PointCloud& cloud, unsigned threads)>;
/// On the CPU.
std::string estimateNormalsOnCpu(PointCloud& cloud, unsigned threads);

/// What was joined.
struct JoinedModel {
  PointCloud cloud;                          ///< as it was loaded, with a scale in its comments
  SharedMaker share;                         ///< empty: nobody sculpts it
  std::string host;                          ///< the machine that serves it
  std::string source;                        ///< what its points are, in that machine's words
  std::shared_ptr<FarCloud> far;             ///< null: all points are there
  std::optional<FarFacts> facts;             ///< of all points, where they are not there
  std::shared_ptr<SharedPresence> presence;  ///< null: nobody is told of
};
/// Fetches the session that is served under a name.
using SessionJoiner = std::function<JoinedModel(const std::string& name, const JoinConfig& join, Log& log)>;

/// A model of this beginning is no file, but a topic of ROS: a cloud that somebody sends, or frames one after another.
inline constexpr std::string_view kRosModel = "ros:";
inline bool isRosModel(std::string_view name) { return name.starts_with(kRosModel); }
inline std::string rosTopicOf(std::string_view name) { return std::string(name.substr(kRosModel.size())); }
/// Gets the cloud of such a name.
using CloudFetcher = std::function<PointCloud(const std::string& name, Log& log)>;
/// Gets the frames of such a name. The intrinsics are those that the stream's configuration names, if any.
using FrameWatcher = std::function<std::shared_ptr<DepthStream>(
    const std::string& name, const StreamConfig& stream, const std::optional<DepthCamera>& intrinsics, Log& log)>;

struct ModelLoading {
  Log& log;
  unsigned threads = 0;  ///< 0: one per core
  NormalEstimator estimate = estimateNormalsOnCpu;
  SessionJoiner join = {};  ///< empty: this program joins none
  CloudFetcher fetch = {};  ///< empty: this program hears nothing of ROS
  FrameWatcher watch = {};  ///< likewise
};
/// A cloud that is in memory: sees to normals as the configuration says, whose file is only its name.
Model modelOf(PointCloud cloud, const ModelConfig& config, const ModelLoading& loading);
/// Reads the file, and sees to normals as the configuration says. Throws FileError, UsageError.
Model loadModel(const ModelConfig& config, const ModelLoading& loading);
/// The same of a whole configuration, whose model may be a stream: that is the cloud of its first frame, then.
Model loadModel(const SessionConfig& config, const ModelLoading& loading);

/// What stands in a scene of water or sand: its file is read, or its shape sampled, and becomes a field. Null where
/// nothing does. Throws FileError, and Error where it is not closed.
std::shared_ptr<const MatterModel> standingModel(const MatterScene& scene, const ModelLoading& loading);

/// What is given, mm per unit; where that is 0 what the cloud's file says (scaleSaidIn()), or else the longest side is
/// 100 mm.
ModelScale scaleOf(const PointCloud& cloud, double mm_per_unit);
/// The same, but nothing where neither says it.
std::optional<ModelScale> knownScaleOf(const PointCloud& cloud, double mm_per_unit);

/// The checksum of a model as it was loaded, normals included.
std::uint64_t checksumOf(const Model& model);

/// Support radius in model units that the model has when nobody says one: four spacings.
double usualSupportRadius(const Model& model);
/// The surface that the configuration asks for on this model. `adapts`: where no radius is given, it may follow the
/// spacing of a place, and widen where points are noisy.
SurfaceOptions surfaceOptions(const Model& model, const SurfaceConfig& config, bool adapts);

/// Edge of a hash cell that the configuration asks for, model units; 0: the support radius.
double cellFor(const Model& model, const IndexConfig& config);

}  // namespace palpate
