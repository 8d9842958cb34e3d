#include "apps/view/screen.hpp"

#include <cstring>
#include <utility>

#include "apps/view/gui.hpp"
#include "apps/view/messages.hpp"
#include "apps/view/model_picture.hpp"
#include "engine/core/thread_priority.hpp"
#include "engine/render/image.hpp"

namespace palpate {

namespace {

constexpr std::uint32_t kDark = 0xff241f1cu, kLight = 0xfff2f0eeu;  // RGBA8, red lowest

}  // namespace

Screen::Screen(Window& window, Device& sight, const Gui& gui, std::optional<Presentation> presentation)
    : sight_(sight),
      panelPass_(sight, gui.texture(), gui.texture_px()),
      presenter_(makePresenter(window, sight, presentation, true)),
      list_(sight, sight.window(), "picture", CommandList::Timing::passes),
      shown_(sight, 0, Memory::device, "shown") {}

void Screen::fit(const UVec2& window_px, bool waitsForDisplay) {
  if (window_px != presenter_->size_px() || waitsForDisplay != presenter_->waitsForDisplay())
    presenter_->change(window_px, waitsForDisplay);
  wasShown_ = true;
}

void Screen::show(const Layers& layers) {
  const UVec2 size_px = presenter_->size_px();
  const std::uint64_t bytes = std::uint64_t{4} * size_px.x * size_px.y;
  if (shown_.bytes() != bytes) shown_ = Buffer(sight_, bytes, Memory::device, "shown");
  shown_px_ = size_px;
  // A software driver hands the picture to the display in one long call; the servo thread may need its core meanwhile.
  const AwayFromCore away(sight_.isCpu() ? layers.servoCore : -1);
  wasShown_ = presenter_->show(list_, shown_, [&] {
    if (layers.drawModel) layers.drawModel(list_);
    panelPass_.record(list_, layers.model ? &layers.model->frame().image() : nullptr,
                      layers.model ? layers.model->shrink() : 1, layers.panels, size_px, shown_,
                      layers.dark ? kDark : kLight, presenter_->blueFirst());
  });
}

void Screen::writeKept(Messages& messages) {
  const auto kept = std::exchange(kept_, std::nullopt);
  if (!kept) return;
  messages.tryTo([&] {
    write(kept->file);
    if (kept->says) messages.say("the picture is in " + kept->file);
  });
}

void Screen::write(const std::string& file) {
  presenter_->waitForLast();
  Image image{shown_px_.x, shown_px_.y, {}};
  image.rgba.resize(std::size_t{shown_px_.x} * shown_px_.y);
  const Buffer staging(sight_, shown_.bytes(), Memory::readback, "screenshot");
  CommandList list(sight_, sight_.window(), "screenshot");
  list.begin();
  list.copy(shown_, staging, shown_.bytes());
  list.end();
  sight_.window().run(list);
  std::memcpy(image.rgba.data(), staging.mapped<std::byte>().data(), shown_.bytes());
  if (presenter_->blueFirst())
    for (auto& pixel : image.rgba) std::swap(pixel[0], pixel[2]);
  writeImage(file, image);
}

}  // namespace palpate
