#include <algorithm>
#include <atomic>
#include <cstring>
#include <utility>

#include "engine/cloud/grid_normals.hpp"
#include "engine/cloud/normals.hpp"
#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/ros_images.hpp"
#include "haptics/sharing/ros_intake.hpp"
#include "haptics/sharing/ros_tf.hpp"

namespace palpate {

using namespace sharing;

namespace {

constexpr double kStaysTrue_s = 3;  // as for edits of others in a session

/// Requires the frame of the first message for all others.
class OneFrame {
 public:
  void require(const RosHeader& header) {
    const std::string frame = printable(header.frame_id ? header.frame_id : "");
    if (!frame_) frame_ = frame;
    if (frame != *frame_) throw NetworkError("is in the frame '{}', and the first one was in '{}'", frame, *frame_);
  }

 private:
  std::optional<std::string> frame_;
};

RosPicture pictureOf(const RosImage& image) {
  return {.height = image.height,
          .width = image.width,
          .encoding = image.encoding ? image.encoding : "",
          .isBigEndian = image.is_bigendian != 0,
          .step = image.step,
          .data = {image.data._buffer, image.data._length}};
}

/// The last colour images, by stamp, for depth images.
class ColorsBeside {
 public:
  ColorsBeside(dds_entity_t participant, const std::string& topic)
      : topic_(topic), intake_(participant, rosName(topic)) {}

  /// Colours of the pixels of a depth image of that time. Waits a moment for a colour image that is sent after it.
  /// Throws NetworkError if there is none or it is invalid.
  void take(std::int64_t stamp_ns, const DepthCamera& camera, std::vector<std::array<std::uint8_t, 3>>& colors) {
    constexpr double kPatience_s = 0.1;
    for (const Stopwatch since; true;) {
      intake_.take(kLook_s, [&](const RosImage& image) { keep(image, camera); });
      const Kept* const nearest = nearestTo(stamp_ns);
      const bool isOver = since.elapsed_s() > kPatience_s;
      // After an image that is not older, no closer one follows.
      if (nearest && (hasNotOlder(stamp_ns) || isOver)) {
        colors = nearest->colors;
        return;
      }
      if (!isOver) continue;
      throw NetworkError("has no colour image of its time beside it, on ros:{}{}", topic_,
                         why_.empty() ? why_ : ": " + why_);
    }
  }

 private:
  static constexpr double kLook_s = 0.005;
  static constexpr std::int64_t kApart_ns = 50'000'000;  // maximum difference of the stamps of two images of one time
  static constexpr std::size_t kMax = 8;
  struct Kept {
    std::int64_t stamp_ns = 0;
    std::vector<std::array<std::uint8_t, 3>> colors;
  };

  void keep(const RosImage& image, const DepthCamera& camera) {
    Kept& kept = kept_[next_ % kMax];
    try {
      takeRosColors(pictureOf(image), camera, kept.colors);
      kept.stamp_ns = stampOf(image.header);
      ++next_;
    } catch (const NetworkError& error) {
      kept.colors.clear();
      why_ = error.what();
    }
  }
  bool hasNotOlder(std::int64_t stamp_ns) const {
    return std::ranges::any_of(kept_,
                               [&](const Kept& kept) { return !kept.colors.empty() && kept.stamp_ns >= stamp_ns; });
  }
  const Kept* nearestTo(std::int64_t stamp_ns) const {
    const auto apart = [&](const Kept& kept) {
      return std::abs(static_cast<double>(kept.stamp_ns) - static_cast<double>(stamp_ns));
    };
    const Kept* nearest = nullptr;
    for (const Kept& kept : kept_)
      if (!kept.colors.empty() && apart(kept) <= kApart_ns && (!nearest || apart(kept) < apart(*nearest)))
        nearest = &kept;
    return nearest;
  }

  std::string topic_;
  RosIntake<RosImage> intake_;
  std::array<Kept, kMax> kept_;
  std::size_t next_ = 0;
  std::string why_;  // why the last one was invalid
};

/// Depths from the images of one camera.
class FromPictures {
 public:
  using Message = RosImage;
  FromPictures(const DepthCamera& camera, double depthScale, std::unique_ptr<ColorsBeside> colors)
      : camera_(camera), depthScale_(depthScale), colors_(std::move(colors)) {}
  const DepthCamera& camera() const { return camera_; }

  void make(const RosImage& image, DepthFrame& frame) {
    frame.points.reset();
    takeRosDepths(pictureOf(image), camera_, depthScale_, frame.depth_m);
    if (colors_) colors_->take(stampOf(image.header), camera_, frame.colors);
  }

 private:
  DepthCamera camera_;
  double depthScale_;
  std::unique_ptr<ColorsBeside> colors_;
};

/// Points with normals, up to a maximum that the first message defines.
class FromPoints {
 public:
  using Message = RosPointCloud2;
  explicit FromPoints(unsigned threads) : threads_(threads) {}
  const DepthCamera& camera() const { return camera_; }

  void make(const RosPointCloud2& message, DepthFrame& frame) {
    TakenRosPoints taken = takeMessage(message, nullptr);
    requireRoom(taken.cloud.size(), message);
    PointCloud& cloud = taken.cloud;
    if (!cloud.hasNormals()) estimate(taken, message);
    frame.depth_m.clear(), frame.colors.clear();
    SensedPoints& points = frame.points.emplace();
    const bool hasRays = !taken.cells.empty() && taken.cells.back() < camera_.width;
    if (hasRays) points.rowLength = message.width;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (cloud.normals[i] == Vec3(0)) continue;
      points.places.push_back(cloud.fileCoordinates(i));
      points.normals.push_back(cloud.normals[i]);
      if (hasRays) points.rays.push_back(taken.cells[i]);
      if (cloud.hasColors()) frame.colors.push_back({cloud.colors[i][0], cloud.colors[i][1], cloud.colors[i][2]});
    }
  }

 private:
  // A sensor without rows sends only rays that hit something, so a later message may have more points.
  void requireRoom(std::size_t points, const RosPointCloud2& message) {
    constexpr std::uint64_t kMin = 65'536, kMax = 100'000'000;
    if (camera_.width == 0 && points > 0) {
      const std::uint64_t first = std::uint64_t{message.width} * message.height;
      camera_.width =
          static_cast<std::uint32_t>(std::min(message.height > 1 ? first : std::max(kMin, 2 * first), kMax));
      camera_.height = 1;
    }
    if (points > camera_.width) throw NetworkError("has {} points, and there is room for {}", points, camera_.width);
  }

  void estimate(TakenRosPoints& taken, const RosPointCloud2& message) const {
    PointCloud& cloud = taken.cloud;
    if (cloud.empty()) return;
    if (message.height > 1) {
      cloud.normals = gridNormals(
          cloud.positions,
          {.width = message.width, .height = message.height, .cells = taken.cells, .sensor = -cloud.origin});
      return;
    }
    constexpr unsigned kNeighbours = 16;
    estimateNormals(cloud, kNeighbours, threads_, UpAxis::z);  // the sensor decides the signs
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if (glm::dot(DVec3(cloud.normals[i]), cloud.fileCoordinates(i)) > 0) cloud.normals[i] = -cloud.normals[i];
  }

  unsigned threads_;
  DepthCamera camera_{};
};

template <class Maker>
class RosFrames final : public DepthStream {
 public:
  RosFrames(Participant participant, std::string topic, const std::string& frame, Maker maker)
      : participant_(std::move(participant)),
        topic_(std::move(topic)),
        maker_(std::move(maker)),
        intake_(participant_, rosName(topic_)),
        transforms_(participant_, frame) {}

  /// Waits for the first valid frame, which next() returns again.
  void begin(const RosListening& listening) {
    std::string why = "none was received";
    const bool came = waitFor(listening, topic_, [&] {
      try {
        if (!look(first_.emplace())) return false;
        why = "they are empty";
        return hasSeen(*first_);
      } catch (const NetworkError& error) {
        why = error.what();
        return false;
      }
    });
    if (!came) throw NetworkError("ros:{}: no frame with points in {:g} s: {}", topic_, listening.timeout_s, why);
  }

  const DepthCamera& camera() const override { return maker_.camera(); }
  bool next(DepthFrame& frame) override {
    if (first_) {
      frame = *std::exchange(first_, std::nullopt);
      return true;
    }
    while (!stops_)
      if (look(frame)) return true;
    return false;
  }
  void stop() noexcept override { stops_ = true; }
  bool isRecorded() const override { return false; }
  double staysTrue_s() const override { return kStaysTrue_s; }
  void rewind() override { throw NetworkError("ros:{}: a live topic cannot be rewound", topic_); }

 private:
  // Whether a frame was received. Of several pending ones the last is taken.
  bool look(DepthFrame& frame) {
    std::optional<std::string> why;
    bool isThere = false;
    intake_.take(kRosLook_s, [&](const typename Maker::Message& message) {
      frame.number = count_++;
      try {
        where_.require(message.header);
        maker_.make(message, frame);
        if (transforms_.isNeeded()) frame.pose = transforms_.poseOf(message.header);
        frame.time_s = times_.timeOf(stampOf(message.header), clock_.elapsed_s());
        isThere = true;
      } catch (const NetworkError& error) {
        why = error.what();
      }
    });
    if (why) throw NetworkError("ros:{}: message {}: {}", topic_, count_ - 1, *why);
    return isThere;
  }
  static bool hasSeen(const DepthFrame& frame) {
    if (frame.points) return !frame.points->places.empty();
    return std::ranges::any_of(frame.depth_m, [](float depth) { return depth > 0; });
  }

  Participant participant_;
  std::string topic_;
  Maker maker_;
  RosIntake<typename Maker::Message> intake_;
  RosTransformIntake transforms_;
  OneFrame where_;
  RosFrameTimes times_;
  Stopwatch clock_;
  std::optional<DepthFrame> first_;
  std::uint64_t count_ = 0;
  std::atomic<bool> stops_ = false;
};

// An empty region, or one of the whole image, is not a part.
bool isPart(const RosCameraInfo& info) {
  if (info.roi.width == 0 && info.roi.height == 0) return false;
  return info.roi.x_offset != 0 || info.roi.y_offset != 0 || info.roi.width != info.width ||
         info.roi.height != info.height;
}

RosCalibration calibrationOf(const RosCameraInfo& info) {
  RosCalibration calibration{.height = info.height,
                             .width = info.width,
                             .distortion = info.distortion_model ? info.distortion_model : "",
                             .d = {info.d._buffer, info.d._length},
                             .binningX = info.binning_x,
                             .binningY = info.binning_y,
                             .isPart = isPart(info)};
  std::memcpy(calibration.k.data(), info.k, sizeof(info.k));
  std::memcpy(calibration.p.data(), info.p, sizeof(info.p));
  return calibration;
}

DepthCamera hearCamera(dds_entity_t participant, const std::string& pictures, const RosListening& listening) {
  const std::string topic = rosCameraTopic(rosName(pictures));
  RosIntake<RosCameraInfo> infos(participant, topic);
  std::optional<DepthCamera> camera;
  const bool came = waitFor(listening, pictures, [&] {
    try {
      infos.take(kRosLook_s,
                 [&](const RosCameraInfo& info) { camera = rosCamera(calibrationOf(info), isRectified(pictures)); });
    } catch (const NetworkError& error) {
      throw NetworkError("ros:{}: {}", topic, error.what());
    }
    return camera.has_value();
  });
  if (!came)
    throw NetworkError("ros:{}: no CameraInfo was received on {} in {:g} s; give the camera's intrinsics", pictures,
                       topic, listening.timeout_s);
  return *camera;
}

RosContent discover(dds_entity_t participant, const std::string& topic, const RosListening& listening) {
  RosWriters writers(participant, rosName(topic));
  const char* const pictures = rosTypeOf<RosImage>().name();
  std::optional<std::string> sent;
  if (listening.log) listening.log->say("ros:{}: waiting for a sender", topic);
  const bool came = waitFor(listening, topic, [&] {
    sent = requireSent(topic, writers, {rosTypeOf<RosPointCloud2>().name(), pictures});
    if (!sent) std::this_thread::sleep_for(std::chrono::duration<double>(kRosLook_s));
    return sent.has_value();
  });
  if (!came)
    throw NetworkError("ros:{}: no sender was found in {:g} s; is the topic sent on domain {}, and on this network?",
                       topic, listening.timeout_s, listening.network.domain);
  return *sent == pictures ? RosContent::pictures : RosContent::points;
}

template <class Maker>
std::shared_ptr<DepthStream> begun(Participant participant, const std::string& topic, Maker maker,
                                   const RosListening& listening) {
  auto frames = std::make_shared<RosFrames<Maker>>(std::move(participant), topic, listening.frame, std::move(maker));
  frames->begin(listening);
  return frames;
}

}  // namespace

RosContent whatRosSends(const std::string& topic, const RosListening& listening) {
  rosName(topic);
  return discover(rosParticipant(listening.network), topic, listening);
}

std::shared_ptr<DepthStream> watchRosFrames(const std::string& topic, const RosWatching& watching) {
  rosName(topic);
  if (!watching.colorTopic.empty()) rosName(watching.colorTopic);
  const RosListening& listening = watching.listening;
  Participant participant = rosParticipant(listening.network);
  if (discover(participant, topic, listening) == RosContent::points) {
    if (watching.needsPictures || watching.camera || watching.depthScale > 0 || !watching.colorTopic.empty())
      throw NetworkError(
          "ros:{}: the topic has points, not depth images; only those have intrinsics, a depth scale and colour "
          "images, and become a map",
          topic);
    return begun(std::move(participant), topic, FromPoints(watching.threads), listening);
  }
  const DepthCamera camera = watching.camera ? *watching.camera : hearCamera(participant, topic, listening);
  if (listening.log)
    listening.log->say("ros:{}: a depth camera of {} x {} pixels, focal lengths {:g} and {:g}", topic, camera.width,
                       camera.height, camera.fx, camera.fy);
  auto colors =
      watching.colorTopic.empty() ? nullptr : std::make_unique<ColorsBeside>(participant, watching.colorTopic);
  return begun(std::move(participant), topic, FromPictures(camera, watching.depthScale, std::move(colors)), listening);
}

}  // namespace palpate
