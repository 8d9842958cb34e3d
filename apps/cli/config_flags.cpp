#include "apps/cli/config_flags.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <utility>

#include "apps/cli/options.hpp"

namespace palpate {

namespace {

// Flags of hands apply to all of them, except those of the second hand.
constexpr std::array<std::pair<std::string_view, std::string_view>, 62> kFlags{{
    {"model.mm_per_unit", "--mm-per-unit"},
    {"model.normals", "--normals"},
    {"model.all_points", "--all-points"},
    {"backend.name", "--backend"},
    {"backend.method", "--method"},
    {"backend.deterministic", "--deterministic"},
    {"backend.wait", "--wait"},
    {"backend.ahead", "--ahead"},
    {"backend.times_passes", "--print-tick"},
    {"index.follow", "--index"},
    {"index.bucket_key", "--bucket-key"},
    {"index.sort", "--sort"},
    {"index.cell_mm", "--cell"},
    {"index.cells_along_side", "--grid"},
    {"index.spare_slots", "--spare"},
    {"surface.kind", "--surface"},
    {"surface.friction", "--friction"},
    {"surface.radius_mm", "--radius"},
    {"tool.kind", "--tool"},
    {"tool.points", "--tool-points"},
    {"tool.size_mm", "--tool-size"},
    {"tool.axis", "--tool-axis"},
    {"brush.kind", "--edit"},
    {"brush.tau_mm", "--tau"},
    {"brush.beta", "--beta"},
    {"brush.radius_mm", "--tool-radius"},
    {"brush.strength", "--strength"},
    {"brush.falloff", "--falloff"},
    {"brush.color", "--paint-color"},
    {"brush.keeps_density", "--keep-points"},
    {"motion.kind", "--motion"},
    {"motion.axis", "--motion-axis"},
    {"motion.amplitude_mm", "--motion-amplitude"},
    {"motion.frequency_Hz", "--motion-frequency"},
    {"motion.speed_mm_per_s", "--motion-speed"},
    {"stream.live", "--live"},
    {"stream.speed", "--speed"},
    {"stream.loop", "--loop"},
    {"stream.depth_scale", "--depth-scale"},
    {"stream.intrinsics", "--intrinsics"},
    {"force.stiffness_N_per_mm", "--stiffness"},
    {"force.damping_N_s_per_mm", "--damping"},
    {"force.max_N", "--max-force"},
    {"force.max_surface_power_W", "--max-surface-power"},
    {"undo.undo", "--undo"},
    {"undo.redo", "--redo"},
    {"undo.memory_MiB", "--undo-memory"},
    {"hands", "--second-device"},
    {"hands[1].device", "--second-device"},
    {"hands[1].path", "--second-path"},
    {"hands.device", "--device"},
    {"hands.path", "--path"},
    {"hands.penetration_mm", "--penetration"},
    {"hands.fit", "--map"},
    {"hands.passivity", "--passivity"},
    {"hands.stiffness_N_per_mm", "--hand-stiffness"},
    {"hands.damping_N_s_per_mm", "--hand-damping"},
    {"hands.own_scheduler", "--scheduler"},
    {"hands.rumbles", "--rumble"},
    {"rate_Hz", "--rate"},
    {"duration_s", "--duration"},
    {"realtime", "--realtime"},
}};

bool isOfName(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.' || c == '[' || c == ']';
}

// "hands[0].path" as "hands.path".
std::string ofAnyHand(std::string_view field) {
  const std::size_t open = field.find('['), close = field.find(']');
  if (open == field.npos || close == field.npos) return std::string(field);
  return std::string(field.substr(0, open)) + std::string(field.substr(close + 1));
}

// Empty if no flag sets the field.
std::string_view flagOf(std::string_view field) {
  for (const std::string& name : {std::string(field), ofAnyHand(field)})
    for (const auto& [known, flag] : kFlags)
      if (known == name) return flag;
  return {};
}

}  // namespace

std::string inFlags(const ConfigError& error, const Options& command) {
  const std::vector<Option> options = command.all();
  const auto has = [&](std::string_view flag) {
    return std::ranges::any_of(options, [&](const Option& option) { return option.name() == flag; });
  };
  const std::string_view text = error.what();
  std::string said;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = at;
    while (end < text.size() && isOfName(text[end])) ++end;
    // After the field at its beginning, a sentence names others by their paths; a plain "hands" in it is a word.
    const std::string_view word = text.substr(at, end - at);
    const bool isField = at == 0 || word.find('.') != word.npos;
    const std::string_view flag = isField ? flagOf(word) : std::string_view{};
    said += !flag.empty() && has(flag) ? flag : word;
    if (end < text.size()) said += text[end];
    at = end + 1;
  }
  return said;
}

}  // namespace palpate
