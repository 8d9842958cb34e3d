#include "apps/view/layer_commands.hpp"

#include <fmt/format.h>

#include <optional>

#include "engine/core/error.hpp"

namespace palpate {

namespace {

std::string freeName(const StrokeLayers& layers) {
  for (std::size_t k = 1;; ++k)
    if (std::string name = fmt::format("layer {}", k); !layers.named(name)) return name;
}

// Without a name the open layer, else the newest one.
std::uint32_t numberOf(const StrokeLayers& layers, const std::string& name) {
  std::optional<std::uint32_t> number = name.empty() ? layers.open() : layers.named(name);
  for (auto k = static_cast<std::uint32_t>(layers.size()); name.empty() && !number && k-- > 0;)
    if (!layers[k].isMerged) number = k;
  if (number) return *number;
  throw Error(name.empty() ? "no layer of strokes exists: press L, then make strokes"
                           : fmt::format("there is no layer of strokes named {}", name));
}

std::string add(const std::string& wanted, WindowSession& session) {
  const StrokeLayers& layers = session.attributes().strokeLayers();
  if (layers.named(wanted)) throw Error("there is a layer of strokes named {} already", wanted);
  const std::string name = wanted.empty() ? freeName(layers) : wanted;
  session.setStrokeLayer(static_cast<std::uint32_t>(layers.size()), {.name = name}, true);
  return fmt::format("strokes go into {}; L ends that", name);
}

}  // namespace

std::string carryOut(const LayerCommand& command, WindowSession& session) {
  using What = LayerCommand::What;
  const StrokeLayers& layers = session.attributes().strokeLayers();
  const bool adds = command.what == What::add || (command.what == What::addOrClose && !layers.open());
  if (adds) return add(command.name, session);
  const std::uint32_t number = numberOf(layers, command.name);
  StrokeLayer set = layers[number];
  bool isOpen = layers.open() == number;
  switch (command.what) {
    case What::open:
      isOpen = true;
      break;
    case What::slide:
    case What::slideFurther:
      set.strength = command.strength;
      set.isHidden = false;
      isOpen = isOpen && command.strength == 1;
      break;
    case What::hide:
    case What::show:
      set.isHidden = command.what == What::hide;
      isOpen = isOpen && !set.isHidden;
      break;
    case What::merge:
      set.isMerged = true;
      isOpen = false;
      break;
    case What::add:
    case What::addOrClose:
    case What::close:
      isOpen = false;
  }
  const std::string name = set.name;
  const bool ends = layers.open() == number && !isOpen;
  session.setStrokeLayer(number, std::move(set), isOpen, command.what == What::slideFurther);
  if (command.what == What::merge) return fmt::format("{} is part of the model now", name);
  return ends ? fmt::format("strokes no longer go into {}", name) : "";
}

}  // namespace palpate
