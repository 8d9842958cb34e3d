#include "apps/view/screen.hpp"

#include <cstring>
#include <utility>

#include "apps/view/gui.hpp"
#include "apps/view/messages.hpp"
#include "apps/view/model_picture.hpp"
#include "engine/core/checksum.hpp"
#include "engine/core/thread_priority.hpp"
#include "engine/render/image.hpp"

namespace palpate {

namespace {

constexpr std::uint32_t kDark = 0xff241f1cu, kLight = 0xfff2f0eeu;  // RGBA8, red lowest

}  // namespace

Screen::Screen(Window& window, Device& sight, const Gui& gui, std::optional<Presentation> presentation)
    : sight_(sight),
      gui_(gui),
      fontVersion_(gui.fontVersion()),
      panelPass_(sight, gui.texture(), gui.texture_px()),
      presenter_(makePresenter(window, sight, presentation, true)),
      list_(sight, sight.window(), "picture", CommandList::Timing::passes),
      shown_(sight, 0, Memory::device, "shown") {}

void Screen::fit(const UVec2& window_px, bool waitsForDisplay) {
  if (window_px != presenter_->size_px() || waitsForDisplay != presenter_->waitsForDisplay())
    presenter_->change(window_px, waitsForDisplay), forget();
  wasShown_ = true;
}

std::uint64_t Screen::contentOf(const Layers& layers) const {
  Checksum sum;
  sum.addValue(std::uint64_t{layers.model != nullptr} << 1 | std::uint64_t{layers.dark});
  sum.addValue(std::uint64_t{size_px().x} << 32 | std::uint64_t{size_px().y});
  sum.addValue(gui_.fontVersion());
  sum.add(std::as_bytes(layers.panels.vertices));
  sum.add(std::as_bytes(layers.panels.triangles));
  sum.add(std::as_bytes(layers.panels.clips));
  return sum.value();
}

bool Screen::show(const Layers& layers) {
  const std::uint64_t content = contentOf(layers);
  if (!layers.modelDiffers && content_ == content) return false;
  if (std::exchange(fontVersion_, gui_.fontVersion()) != gui_.fontVersion())
    panelPass_.setTexture(gui_.texture(), gui_.texture_px());
  const UVec2 size_px = presenter_->size_px();
  const std::uint64_t bytes = std::uint64_t{4} * size_px.x * size_px.y;
  if (shown_.bytes() != bytes) shown_ = Buffer(sight_, bytes, Memory::device, "shown");
  shown_px_ = size_px;
  // A software driver hands the picture to the display in one long call; the servo thread may need its core meanwhile.
  const AwayFromCore away(sight_.isCpu() ? layers.servoCore : -1);
  wasShown_ = presenter_->show(list_, shown_, [&] {
    if (layers.drawModel) layers.drawModel(list_);
    panelPass_.record(list_, layers.model ? &layers.model->frame().image() : nullptr,
                      layers.model ? layers.model->shrink() : 1, layers.panels, presenter_->size_px(), shown_,
                      layers.dark ? kDark : kLight, presenter_->blueFirst());
  });
  content_ = wasShown_ ? std::optional(content) : std::nullopt;
  return true;
}

void Screen::writeKept(Messages& messages) {
  if (const auto kept = std::exchange(kept_, std::nullopt)) messages.tryTo([&] { write(*kept); });
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
