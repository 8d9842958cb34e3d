// The model of a session: a cloud with normals, scale and spacing, and the properties derived from them.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/cloud/up.hpp"
#include "engine/contact/surface.hpp"
#include "engine/core/camera_frustum.hpp"
#include "engine/core/log.hpp"
#include "engine/core/units.hpp"
#include "engine/motion/fused_stream.hpp"
#include "haptics/session/far_cloud.hpp"
#include "haptics/session/session_config.hpp"
#include "haptics/shared_follower.hpp"
#include "haptics/shared_presence.hpp"

namespace palpate {

class TouchBackend;
struct MemoryNeed;

/// Joins the editing of a shared session: from the points as they were joined, and their back end.
using SharedMaker = std::function<std::unique_ptr<SharedFollower>(const PointCloud& cloud, TouchBackend& backend)>;

/// Points at rest: of a file, or of a program.
struct StillPoints {};

/// A frame of a depth camera, or a map into which its frames have been fused.
struct CameraPoints {
  /// Continues behind the points: of a live camera, of a map, or released by another session
  /// (Session::releaseStream()). The first session takes it. Null: a recording that each session plays from its
  /// beginning.
  std::shared_ptr<PlayedStream> stream;
};

/// Radius of a particle in a picture, in spacings: two thirds would close a lattice at rest. Of a file: wider.
inline constexpr double kParticleRadius_spacings = 0.85, kWaterRadius_spacings = 1.1;

/// Water or sand, as a point for each particle; model units.
struct FluidPoints {
  Bounds container;                       ///< a box that holds the points
  bool isWater = false;                   ///< else sand
  double discRadius = 0;                  ///< of all discs in a picture, as particles fill a body
  double ballRadius = 0;                  ///< of the ball that a hand holds
  std::size_t standing = 0;               ///< number of points of the body that stands in it: the last of the cloud
  std::shared_ptr<const SceneBody> body;  ///< that body; null: there is none
};

/// A soft body at rest, whose points are the cloud.
struct SoftPoints {
  Bounds container;
  std::shared_ptr<const SceneBody> body;
};

/// All points of a session that another program serves.
struct JoinedPoints {
  SharedMaker share;                         ///< empty: they cannot be sculpted
  std::shared_ptr<SharedPresence> presence;  ///< of all participants; null: without
};

/// The same, but only the points around the hands are here; the cloud is a sample of all, which is not felt.
struct FarPoints {
  std::shared_ptr<FarCloud> cloud;  ///< fetches them
  PointExtent extent;               ///< of all of them
  std::shared_ptr<SharedPresence> presence;
  SceneRef scene;     ///< whose particles they are; empty: they are of a surface
  FluidPoints fluid;  ///< with a scene
};

struct Model {
  PointCloud cloud;
  ModelScale scale;
  double spacing = 0;                  ///< model units
  double wideSpacing = 0;              ///< of the sparse parts (SpacingRange), model units
  double noise = 0;                    ///< of the positions, off their surface (SpacingRange), spacings
  Upright upright;                     ///< estimated from the shape
  std::optional<Bounds> shown;         ///< the part that a picture shows (coreBoundsOf()); empty: all
  std::vector<CameraFrustum> cameras;  ///< that took pictures of it, in file coordinates, if known
  std::variant<StillPoints, CameraPoints, FluidPoints, SoftPoints, JoinedPoints, FarPoints> source;

  /// Null if the points come from elsewhere.
  template <class Source>
  const Source* as() const {
    return std::get_if<Source>(&source);
  }
  /// Water or sand, simulated here or in the program that serves it; null: the points are of a surface.
  const FluidPoints* fluid() const;
  std::size_t standing() const { return fluid() ? fluid()->standing : 0; }
  const Bounds* container() const;
  /// Empty if the model was not joined, or cannot be sculpted.
  SharedMaker share() const { return as<JoinedPoints>() ? as<JoinedPoints>()->share : SharedMaker(); }
  SharedPresence* presence() const;
  PlayedStream* stream() const { return as<CameraPoints>() ? as<CameraPoints>()->stream.get() : nullptr; }
  FarCloud* far() const { return as<FarPoints>() ? as<FarPoints>()->cloud.get() : nullptr; }
  /// Extent of all points, also of those that are not here; empty: all are here.
  std::optional<PointExtent> extent() const {
    return as<FarPoints>() ? std::optional(as<FarPoints>()->extent) : std::nullopt;
  }
  /// Radius of all discs in a picture, model units; 0: each disc is as wide as the surface around it requires.
  double discRadius() const { return fluid() ? fluid()->discRadius : 0; }
  /// Radius of the ball that a hand holds in water and sand, model units; 0: no ball.
  double ballRadius() const { return fluid() ? fluid()->ballRadius : 0; }
  /// Spacing from which disc radii are computed, model units; 0: they are not.
  double spacingOfDiscs() const { return discRadius() > 0 ? 0 : spacing; }
  /// Of the points without a few far outliers: what a hand's scale and workspace, paths and pictures are fitted to.
  Bounds shownBounds() const { return shown ? *shown : boundsOf(cloud); }
};

/// Estimates normals of a cloud from its points; `up`: of the user, or empty. Returns a description of the cost.
using NormalEstimator = std::function<std::string(PointCloud& cloud, unsigned threads, std::optional<UpAxis> up)>;
/// The same on the CPU.
std::string estimateNormalsOnCpu(PointCloud& cloud, unsigned threads, std::optional<UpAxis> up);

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
  /// MemoryLimit::exceeded: called before a file is read whose session needs more memory than is free.
  std::function<void(const MemoryNeed&)> exceeds = {};
};
/// Makes a model of a cloud in memory, with normals as configured; the configuration's file is only its name.
Model modelOf(PointCloud cloud, const ModelConfig& config, const ModelLoading& loading);
/// Reads, joins or makes the model; the cloud of a stream is that of its first frame. Throws FileError, UsageError.
Model loadModel(const ModelConfig& config, const ModelLoading& loading);

/// Sets the properties that follow from the points: the scale, and their spacing.
void measure(Model& model, const ModelConfig& config, unsigned threads);

/// The given scale, mm per unit; if that is 0, the scale in the cloud's file (scaleSaidIn()), or else a scale that
/// makes the longest side of shownBounds() 100 mm.
ModelScale scaleOf(const Model& model, double mm_per_unit);
/// The same of a cloud, but empty if neither is known.
std::optional<ModelScale> knownScaleOf(const PointCloud& cloud, double mm_per_unit);

/// The checksum of a model as it was loaded, normals included.
std::uint64_t checksumOf(const Model& model);

/// Default support radius, model units: four spacings.
double usualSupportRadius(const Model& model);
/// The surface of this model as configured. `adapts`: unless a radius is given, it may follow the local spacing, and be
/// wider if points are noisy.
SurfaceOptions surfaceOptions(const Model& model, const SurfaceConfig& config, bool adapts);

}  // namespace palpate
