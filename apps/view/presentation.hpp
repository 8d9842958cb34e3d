#pragma once

#include <optional>
#include <string_view>

#include "apps/view/window.hpp"
#include "engine/gpu/presenter.hpp"

namespace palpate {

/// How pictures come to the display: the GPU presents them itself, or they are copied there through the host.
enum class Presentation { swapchain, copy };
inline constexpr std::array<std::pair<std::string_view, Presentation>, 2> kPresentations{
    {{"swapchain", Presentation::swapchain}, {"copy", Presentation::copy}}};

struct PresentationFound {
  Presentation presentation = Presentation::swapchain;
  std::string why;  ///< of a copy, in words
};

/// What a GPU can do for a window. Asks the X server before the driver, which may not survive the question: NVIDIA's
/// (580) crashes in the queries of a surface on a server without its own extension. `instance` has the window's
/// extensions.
PresentationFound findPresentation(const Window& window, const Instance& instance, VkPhysicalDevice gpu);

/// The one that is wanted, or that is found. Throws Error where the window cannot be served that way.
std::unique_ptr<Presenter> makePresenter(const Window& window, Device& device, std::optional<Presentation> wanted,
                                         bool waitsForDisplay);

}  // namespace palpate
