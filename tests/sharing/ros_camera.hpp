// Messages of ROS sensors, for tests: depth images with their camera, and organised points, frame by frame.
#pragma once

#include <array>
#include <bit>
#include <chrono>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "engine/core/depth_stream.hpp"
#include "haptics/sharing/ros_messages.hpp"

namespace palpate {

/// An image message of the camera's size that owns its memory.
struct SentPicture {
  std::string encoding = "32FC1", frame = "camera";
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> data;
  std::int64_t stamp_ns = 0;

  sharing::RosImage message() {
    sharing::RosImage image{};
    sharing::setStamp(image.header, stamp_ns);
    image.header.frame_id = frame.data();
    image.width = width, image.height = height;
    image.encoding = encoding.data();
    image.step = height > 0 ? static_cast<std::uint32_t>(data.size() / height) : 0;
    sharing::give(image.data, data);
    return image;
  }
};

/// Depth along each ray of a camera, by row; 0: no hit.
using DepthAlong = std::function<double(const DVec3& ray)>;

inline SentPicture pictureOf(const DepthCamera& camera, const DepthAlong& depth_m) {
  SentPicture picture{.width = camera.width, .height = camera.height};
  for (std::uint32_t row = 0; row < camera.height; ++row)
    for (std::uint32_t column = 0; column < camera.width; ++column) {
      const auto depth = static_cast<float>(depth_m(camera.placeAt(column, row, 1)));
      const auto bytes = std::bit_cast<std::array<std::uint8_t, 4>>(depth);
      picture.data.insert(picture.data.end(), bytes.begin(), bytes.end());
    }
  return picture;
}

/// The same as points, row by row, NaN for rays without a hit; positions only.
struct SentPoints {
  std::uint32_t width = 0, height = 0;
  std::string frame = "camera";
  std::vector<Vec3> places;
  std::int64_t stamp_ns = 0;

  void write(const sharing::RosPublisher<sharing::RosPointCloud2>& publisher) {
    std::string names[] = {"x", "y", "z"};
    sharing::RosPointField fields[3];
    for (std::uint32_t k = 0; k < 3; ++k)
      fields[k] = {.name = names[k].data(), .offset = 4 * k, .datatype = 7, .count = 1};
    sharing::RosPointCloud2 cloud{};
    sharing::setStamp(cloud.header, stamp_ns);
    cloud.header.frame_id = frame.data();
    cloud.width = width, cloud.height = height;
    sharing::give(cloud.fields, fields);
    cloud.point_step = sizeof(Vec3);
    cloud.row_step = width * cloud.point_step;
    sharing::give(cloud.data, std::span(reinterpret_cast<std::uint8_t*>(places.data()), places.size() * sizeof(Vec3)));
    publisher.write(cloud);
  }
};

inline SentPoints pointsOf(const DepthCamera& camera, const DepthAlong& depth_m) {
  SentPoints points{.width = camera.width, .height = camera.height};
  for (std::uint32_t row = 0; row < camera.height; ++row)
    for (std::uint32_t column = 0; column < camera.width; ++column) {
      const DVec3 ray = camera.placeAt(column, row, 1);
      const double depth = depth_m(ray);
      points.places.push_back(depth > 0 ? Vec3(depth * ray) : Vec3(std::nanf("")));
    }
  return points;
}

inline sharing::RosCameraInfo infoOf(const DepthCamera& camera) {
  static char none[] = "", model[] = "plumb_bob";
  sharing::RosCameraInfo info{};
  info.header.frame_id = none;
  info.width = camera.width, info.height = camera.height;
  info.distortion_model = model;
  info.k[0] = camera.fx, info.k[2] = camera.cx, info.k[4] = camera.fy, info.k[5] = camera.cy, info.k[8] = 1;
  return info;
}

/// Calls `send` 30 times a second with the frame's number and stamp, on its own thread.
class Sending {
 public:
  explicit Sending(std::function<void(int frame, std::int64_t stamp_ns)> send)
      : thread_([send = std::move(send)](const std::stop_token& stops) {
          auto due = std::chrono::steady_clock::now();
          for (int frame = 0; !stops.stop_requested(); ++frame) {
            send(frame, std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count());
            std::this_thread::sleep_until(due += std::chrono::milliseconds(33));
          }
        }) {}

 private:
  std::jthread thread_;
};

/// A camera that sends `picture`'s result for each frame, at TOPIC's image_raw and camera_info, as sensors do.
class SendingCamera {
 public:
  SendingCamera(const NetworkConfig& network, const std::string& topic, const sharing::RosCameraInfo& info,
                std::function<SentPicture(int frame)> picture)
      : participant_(sharing::rosParticipant(network)),
        images_(participant_, sharing::kRosTopics + topic + "/image_raw", sharing::RosDelivery::bestEffort),
        infos_(participant_, sharing::kRosTopics + topic + "/camera_info", sharing::RosDelivery::reliable),
        sending_([this, info, picture = std::move(picture)](int frame, std::int64_t stamp_ns) {
          SentPicture sent = picture(frame);
          sent.stamp_ns = stamp_ns;
          infos_.write(info);
          images_.write(sent.message());
        }) {}

 private:
  sharing::Participant participant_;
  sharing::RosPublisher<sharing::RosImage> images_;
  sharing::RosPublisher<sharing::RosCameraInfo> infos_;
  Sending sending_;
};

}  // namespace palpate
