// The model of a session: a cloud with normals, scale and spacing, and the properties derived from them.
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

/// Joins the editing of a shared session: from the points as they were joined, and their back end.
using SharedMaker = std::function<std::unique_ptr<SharedFollower>(const PointCloud& cloud, TouchBackend& backend)>;

struct Model {
  PointCloud cloud;
  ModelScale scale;
  double spacing = 0;      ///< model units
  double wideSpacing = 0;  ///< of the sparse parts (SpacingRange), model units
  double noise = 0;        ///< of the positions, off their surface (SpacingRange), spacings
  /// Radius of all discs in a picture, model units, as for particles that fill a body; 0: each disc is as wide as the
  /// surface around it requires.
  double discRadius = 0;
  std::optional<Bounds> container;  ///< a box that holds the points, as it does water; model units
  double ballRadius = 0;            ///< of the ball that a hand holds in such points, model units; 0: no ball
  /// The soft body at rest, whose points are the cloud; null: the model is not a soft body.
  std::shared_ptr<const SoftModel> soft;
  /// The body that stands in water or sand; its points are the last of the cloud. Null: there is none.
  std::shared_ptr<const MatterModel> standing;
  Upright upright;  ///< estimated from the shape
  /// The part that a picture shows (coreBoundsOf()); empty: all.
  std::optional<Bounds> shown;
  /// Stream that continues behind the cloud: of a live camera, of a map into which frames have been fused, or released
  /// by another session (Session::releaseStream()). The first session takes it. Null: the model is a file, or a
  /// recording that each session plays from its beginning.
  std::shared_ptr<PlayedStream> stream;
  SharedMaker share;  ///< if others sculpt it, too; empty: it is not shared
  /// Fetches the points around the hands, if another program has all of them: the cloud is then a sample of all points,
  /// which is not felt. Null: all points are here.
  std::shared_ptr<FarCloud> far;
  std::optional<MatterScene> farMatter;      ///< whose particles those points are; empty: they are of a surface
  std::optional<PointExtent> extent;         ///< of all of them
  std::shared_ptr<SharedPresence> presence;  ///< of all participants; null: it was not joined
  std::vector<CameraFrustum> cameras;        ///< that took pictures of it, in file coordinates, if known
  /// Spacing from which disc radii are computed, model units; 0: they are not.
  double spacingOfDiscs() const { return discRadius > 0 ? 0 : spacing; }
  Bounds shownBounds() const { return shown ? *shown : boundsOf(cloud); }
};

/// Estimates normals of a cloud from its points. Returns a description of the cost.
using NormalEstimator = std::function<std::string(PointCloud& cloud, unsigned threads)>;
/// The same on the CPU.
std::string estimateNormalsOnCpu(PointCloud& cloud, unsigned threads);

/// A joined session.
struct JoinedModel {
  PointCloud cloud;                          ///< as loaded by the server, with the scale in its comments
  SharedMaker share;                         ///< empty: it cannot be sculpted
  std::string host;                          ///< the machine that serves it
  std::string source;                        ///< name of the model on that machine
  std::shared_ptr<FarCloud> far;             ///< null: all points are in `cloud`
  std::optional<FarFacts> facts;             ///< of all points, with `far`
  std::shared_ptr<SharedPresence> presence;  ///< null: without presence
};
/// Joins the session that is served under a name.
using SessionJoiner = std::function<JoinedModel(const std::string& name, const JoinConfig& join, Log& log)>;

/// Prefix of a model that is not a file, but a ROS topic: a single cloud, or a sequence of frames.
inline constexpr std::string_view kRosModel = "ros:";
inline bool isRosModel(std::string_view name) { return name.starts_with(kRosModel); }
inline std::string rosTopicOf(std::string_view name) { return std::string(name.substr(kRosModel.size())); }
/// Fetches the cloud of such a name.
using CloudFetcher = std::function<PointCloud(const std::string& name, Log& log)>;
/// Subscribes to the frames of such a name. The intrinsics are those named in the stream's configuration, if any.
using FrameWatcher = std::function<std::shared_ptr<DepthStream>(
    const std::string& name, const StreamConfig& stream, const std::optional<DepthCamera>& intrinsics, Log& log)>;

struct ModelLoading {
  Log& log;
  unsigned threads = 0;  ///< 0: one per core
  NormalEstimator estimate = estimateNormalsOnCpu;
  SessionJoiner join = {};  ///< empty: this program cannot join sessions
  CloudFetcher fetch = {};  ///< empty: this program does not support ROS
  FrameWatcher watch = {};  ///< likewise
};
/// Makes a model of a cloud in memory, with normals as configured; the configuration's file is only its name.
Model modelOf(PointCloud cloud, const ModelConfig& config, const ModelLoading& loading);
/// Reads the file; normals are as configured. Throws FileError, UsageError.
Model loadModel(const ModelConfig& config, const ModelLoading& loading);
/// The same for a whole configuration. If its model is a stream, the cloud is that of the first frame.
Model loadModel(const SessionConfig& config, const ModelLoading& loading);

/// The body that stands in a scene of water or sand: reads its file or samples its shape, and computes a field. Null if
/// there is none. Throws FileError, and Error if the body is not closed.
std::shared_ptr<const MatterModel> standingModel(const MatterScene& scene, const ModelLoading& loading);

/// The given scale, mm per unit; if that is 0, the scale in the cloud's file (scaleSaidIn()), or else a scale that
/// makes the longest side 100 mm.
ModelScale scaleOf(const PointCloud& cloud, double mm_per_unit);
/// The same, but empty if neither is known.
std::optional<ModelScale> knownScaleOf(const PointCloud& cloud, double mm_per_unit);

/// The checksum of a model as it was loaded, normals included.
std::uint64_t checksumOf(const Model& model);

/// Default support radius, model units: four spacings.
double usualSupportRadius(const Model& model);
/// The surface of this model as configured. `adapts`: unless a radius is given, it may follow the local spacing, and be
/// wider if points are noisy.
SurfaceOptions surfaceOptions(const Model& model, const SurfaceConfig& config, bool adapts);

/// Configured edge of a hash cell, model units; 0: the support radius.
double cellFor(const Model& model, const IndexConfig& config);

}  // namespace palpate
