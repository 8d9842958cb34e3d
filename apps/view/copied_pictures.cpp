#include "apps/view/copied_pictures.hpp"

#include <thread>

namespace palpate {

namespace {

constexpr std::chrono::microseconds kRefresh(16'667);  // assumed: such a display does not report its refresh times

}  // namespace

CopiedPictures::CopiedPictures(Device& device, const X11Window& window, const UVec2& size_px, bool waitsForDisplay)
    : Presenter(size_px, waitsForDisplay),
      device_(device),
      canvas_(window),
      staging_(device, 0, Memory::readback, "picture for the display") {
  blueFirst_ = canvas_.blueFirst();
}

void CopiedPictures::change(const UVec2& size_px, bool waitsForDisplay) {
  size_px_ = size_px;
  waitsForDisplay_ = waitsForDisplay;
}

bool CopiedPictures::show(CommandList& list, const Buffer& picture, const std::function<void()>& record) {
  if (size_px_.x == 0 || size_px_.y == 0) return false;
  const std::uint64_t bytes = std::uint64_t{4} * size_px_.x * size_px_.y;
  if (staging_.bytes() != bytes) staging_ = Buffer(device_, bytes, Memory::readback, "picture for the display");
  list.begin();
  record();
  list.copy(picture, staging_, bytes);
  list.end();
  device_.window().run(list);
  if (waitsForDisplay_) std::this_thread::sleep_until(last_ + kRefresh);
  last_ = std::chrono::steady_clock::now();
  canvas_.put(staging_.mapped<std::uint32_t>(), size_px_);
  return true;
}

}  // namespace palpate
