// Depth cameras by Video4Linux: capture into memory shared with the driver (V4L2, sections 1 and 3).
#include "engine/io/depth_camera.hpp"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/io/video_node.hpp"

namespace palpate {

namespace {

constexpr std::uint32_t kBuffers = 4;

class SystemVideoNode final : public VideoNode {
 public:
  explicit SystemVideoNode(const std::string& device)
      : file_(::open(device.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC)),
        wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (file_ >= 0 && wake_ >= 0) return;
    const int error = errno;
    close();
    throw Error("{}: cannot be opened: {}{}", device, std::strerror(error),
                error == EACCES ? "; run: sudo usermod -aG video $USER, then log in again" : "");
  }
  ~SystemVideoNode() override { close(); }

  int control(unsigned long request, void* argument) noexcept override {
    int result;
    do result = ::ioctl(file_, request, argument);
    while (result < 0 && errno == EINTR);
    return result < 0 ? errno : 0;
  }
  int map(std::size_t bytes, std::int64_t offset, std::span<const std::byte>& memory) noexcept override {
    void* const at = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file_, static_cast<off_t>(offset));
    if (at == MAP_FAILED) return errno;
    memory = {static_cast<const std::byte*>(at), bytes};
    return 0;
  }
  void unmap(std::span<const std::byte> memory) noexcept override {
    ::munmap(const_cast<std::byte*>(memory.data()), memory.size());
  }
  int wait() noexcept override {
    std::array<pollfd, 2> waits{
        {{.fd = file_, .events = POLLIN, .revents = 0}, {.fd = wake_, .events = POLLIN, .revents = 0}}};
    return ::poll(waits.data(), waits.size(), -1) < 0 && errno != EINTR ? errno : 0;
  }
  void wake() noexcept override {
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto written = ::write(wake_, &one, sizeof one);
  }

 private:
  void close() const noexcept {
    if (file_ >= 0) ::close(file_);
    if (wake_ >= 0) ::close(wake_);
  }
  int file_, wake_;
};

/// "YUYV", as drivers name their formats.
std::string nameOfFormat(std::uint32_t format) {
  std::string name;
  for (unsigned shift = 0; shift < 32; shift += 8) {
    const char c = static_cast<char>(format >> shift & 0x7f);
    if (c > ' ') name += c;
  }
  return name;
}

class VideoDepthStream final : public DepthStream {
 public:
  VideoDepthStream(std::unique_ptr<VideoNode> node, std::string name, const CameraText& camera)
      : node_(std::move(node)),
        name_(std::move(name)),
        camera_(camera.camera),
        metres_(static_cast<float>(1 / camera.depthScale.value_or(kMillimetreDepth))) {
    requireCapture();
    setFormat();
    try {
      mapBuffers();
    } catch (...) {
      unmapBuffers();
      throw;
    }
  }
  ~VideoDepthStream() override {
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    node_->control(VIDIOC_STREAMOFF, &type);
    unmapBuffers();
  }
  VideoDepthStream(const VideoDepthStream&) = delete;
  VideoDepthStream& operator=(const VideoDepthStream&) = delete;

  const DepthCamera& camera() const override { return camera_; }
  bool next(DepthFrame& frame) override {
    if (ended_) return false;
    std::optional<v4l2_buffer> buffer = takeBuffer();
    if (!buffer) return false;
    struct GiveBack {
      VideoNode& node;
      v4l2_buffer& buffer;
      ~GiveBack() { node.control(VIDIOC_QBUF, &buffer); }
    } const giveBack{*node_, *buffer};
    take(*buffer, frame);
    return true;
  }

  void stop() noexcept override {
    stopped_ = true;
    node_->wake();
  }
  bool isRecorded() const override { return false; }
  void rewind() override { throw Error("{}: a live camera cannot be rewound", name_); }

 private:
  void requireCapture() {
    v4l2_capability can{};
    if (node_->control(VIDIOC_QUERYCAP, &can) != 0) throw Error("{}: is not a video device", name_);
    const std::uint32_t here = (can.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? can.device_caps : can.capabilities;
    constexpr std::uint32_t kNeeded = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
    if ((here & kNeeded) != kNeeded)
      throw Error("{}: does not stream pictures; a camera has several devices, try the others", name_);
  }

  void setFormat() {
    v4l2_format format{};
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    format.fmt.pix.width = camera_.width;
    format.fmt.pix.height = camera_.height;
    format.fmt.pix.pixelformat = V4L2_PIX_FMT_Z16;
    format.fmt.pix.field = V4L2_FIELD_NONE;
    const int error = node_->control(VIDIOC_S_FMT, &format);
    if (error != EINVAL) require(error, "its format cannot be set");
    const v4l2_pix_format& given = format.fmt.pix;
    if (error == EINVAL || given.pixelformat != V4L2_PIX_FMT_Z16)
      throw Error("{}: does not offer Z16, depth of 16 bits, but {}; a camera has several devices, try the others",
                  name_, formats());
    if (given.width != camera_.width || given.height != camera_.height)
      throw Error("{}: delivers {} x {} pixels, but the intrinsics are for {} x {}", name_, given.width, given.height,
                  camera_.width, camera_.height);
    pitch_ = std::max<std::size_t>(given.bytesperline, sizeof(std::uint16_t) * camera_.width);
  }

  std::string formats() {
    constexpr std::uint32_t kMax = 32;
    std::string names;
    for (std::uint32_t index = 0; index < kMax; ++index) {
      v4l2_fmtdesc format{};
      format.index = index;
      format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
      if (node_->control(VIDIOC_ENUM_FMT, &format) != 0) break;
      names += (names.empty() ? "" : ", ") + nameOfFormat(format.pixelformat);
    }
    return names.empty() ? "no known format" : names;
  }

  void mapBuffers() {
    v4l2_requestbuffers request{};
    request.count = kBuffers;
    request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    request.memory = V4L2_MEMORY_MMAP;
    require(node_->control(VIDIOC_REQBUFS, &request), "has no memory for its frames");
    for (std::uint32_t index = 0; index < request.count; ++index) {
      v4l2_buffer buffer{};
      buffer.index = index;
      buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
      buffer.memory = V4L2_MEMORY_MMAP;
      require(node_->control(VIDIOC_QUERYBUF, &buffer), "does not report where its frames are");
      std::span<const std::byte> memory;
      require(node_->map(buffer.length, buffer.m.offset, memory), "cannot map its frames");
      memory_.push_back(memory);
      require(node_->control(VIDIOC_QBUF, &buffer), "does not accept memory for its frames");
    }
    if (memory_.empty()) throw Error("{}: has no memory for its frames", name_);
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    require(node_->control(VIDIOC_STREAMON, &type), "cannot start");
  }

  void unmapBuffers() noexcept {
    for (const std::span<const std::byte> memory : memory_) node_->unmap(memory);
  }

  // Nothing if stopped.
  std::optional<v4l2_buffer> takeBuffer() {
    while (!stopped_) {
      v4l2_buffer buffer{};
      buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
      buffer.memory = V4L2_MEMORY_MMAP;
      int error = node_->control(VIDIOC_DQBUF, &buffer);
      if (error == 0 && buffer.index < memory_.size()) return buffer;
      if (error == EAGAIN) error = node_->wait();
      if (error == 0) continue;
      ended_ = true;
      if (error == ENODEV) throw Error("{}: is disconnected; plug the camera in again", name_);
      require(error, "delivers no more frames");
    }
    return std::nullopt;
  }

  void take(const v4l2_buffer& buffer, DepthFrame& frame) {
    if (!firstSequence_) firstSequence_ = buffer.sequence;
    frame.number = buffer.sequence - *firstSequence_;
    const double time_s =
        static_cast<double>(buffer.timestamp.tv_sec) + 1e-6 * static_cast<double>(buffer.timestamp.tv_usec);
    const std::size_t row = sizeof(std::uint16_t) * camera_.width, needed = pitch_ * (camera_.height - 1) + row;
    const std::span<const std::byte> memory = memory_[buffer.index];
    if ((buffer.flags & V4L2_BUF_FLAG_ERROR) != 0 || std::min<std::size_t>(buffer.bytesused, memory.size()) < needed)
      throw Error("{}: frame {} has {} of its {} bytes", name_, frame.number, buffer.bytesused, needed);
    if (last_s_ && !(time_s > *last_s_))
      throw Error("{}: frame {} has the time {} s, which is not after {} s", name_, frame.number, time_s, *last_s_);
    if (!first_s_) first_s_ = time_s;
    last_s_ = time_s;
    frame.time_s = time_s - *first_s_;
    frame.pose.reset();
    frame.colors.clear();
    frame.depth_m.resize(std::size_t{camera_.width} * camera_.height);
    for (std::uint32_t y = 0; y < camera_.height; ++y)
      for (std::uint32_t x = 0; x < camera_.width; ++x) {
        std::uint16_t value;
        std::memcpy(&value, memory.data() + y * pitch_ + x * sizeof value, sizeof value);
        frame.depth_m[std::size_t{y} * camera_.width + x] = static_cast<float>(value) * metres_;
      }
  }

  void require(int error, std::string_view what) const {
    if (error == 0) return;
    const bool busy = error == EBUSY;
    throw Error("{}: {}: {}{}", name_, what, std::strerror(error), busy ? "; another program uses the camera" : "");
  }

  const std::unique_ptr<VideoNode> node_;
  const std::string name_;
  const DepthCamera camera_;
  const float metres_;
  std::size_t pitch_ = 0;  // bytes from row to row
  std::vector<std::span<const std::byte>> memory_;
  std::optional<std::uint32_t> firstSequence_;
  std::optional<double> first_s_, last_s_;
  std::atomic<bool> stopped_ = false;
  bool ended_ = false;
};

}  // namespace

std::shared_ptr<DepthStream> streamVideoNode(std::unique_ptr<VideoNode> node, const std::string& name,
                                             const CameraText& camera) {
  return std::make_shared<VideoDepthStream>(std::move(node), name, camera);
}

std::shared_ptr<DepthStream> openDepthCamera(const std::string& device, const CameraText& camera) {
  return streamVideoNode(std::make_unique<SystemVideoNode>(device), device, camera);
}

}  // namespace palpate
