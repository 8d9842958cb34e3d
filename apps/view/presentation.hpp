#pragma once

#include <optional>
#include <string_view>

#include "apps/view/window.hpp"
#include "engine/gpu/presenter.hpp"

namespace palpate {

/// How pictures reach the display: the GPU presents them, or they are copied through the host.
enum class Presentation { swapchain, copy };
inline constexpr std::array<std::pair<std::string_view, Presentation>, 2> kPresentations{
    {{"swapchain", Presentation::swapchain}, {"copy", Presentation::copy}}};

struct PresentationFound {
  Presentation presentation = Presentation::swapchain;
  std::string why;  ///< reason for a copy
};

/// Finds the presentation that a GPU supports for a window. Queries the X server before the driver: NVIDIA's driver
/// (580) crashes in surface queries on a server without its own extension. `instance` has the window's extensions.
PresentationFound findPresentation(const Window& window, const Instance& instance, VkPhysicalDevice gpu);

/// Makes the wanted presenter, or the one that is found. Throws Error where it cannot present to the window.
std::unique_ptr<Presenter> makePresenter(const Window& window, Device& device, std::optional<Presentation> wanted,
                                         bool waitsForDisplay);

}  // namespace palpate
