#include "apps/view/kept_settings.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>

#include "apps/view/recent_files.hpp"
#include "apps/view/theme.hpp"
#include "engine/core/atomic_file.hpp"
#include "engine/core/named_values.hpp"

namespace palpate {

namespace {

constexpr std::array<std::pair<std::string_view, int DesktopPlace::*>, 4> kPlace{{{"left", &DesktopPlace::left},
                                                                                  {"top", &DesktopPlace::top},
                                                                                  {"width", &DesktopPlace::width},
                                                                                  {"height", &DesktopPlace::height}}};

}  // namespace

std::optional<KeptSettings> KeptSettings::read() {
  std::ifstream in(stateFile("window"));
  if (!in) return std::nullopt;
  KeptSettings kept;
  DesktopPlace place;
  for (std::string name, value; in >> name >> value;) {
    if (name == "theme") kept.dark = valueNamed(kThemes, value).value_or(kept.dark);
    if (name == "text_size") kept.text_percent = valueNamed(kTextSizes, value).value_or(kept.text_percent);
    if (name == "first_steps") kept.firstSteps = value == "yes";
    for (const auto& [side, member] : kPlace)
      if (name == side) std::from_chars(value.data(), value.data() + value.size(), place.*member);
  }
  if (place.width > 0 && place.height > 0) kept.place = place;
  return kept;
}

void KeptSettings::write() const {
  const std::filesystem::path file = stateFile("window");
  if (file.empty()) return;
  try {
    std::filesystem::create_directories(file.parent_path());
    AtomicFile out(file);
    std::string where;
    for (const auto& [side, member] : kPlace)
      if (place) where += fmt::format("{} {}\n", side, (*place).*member);
    out.write(fmt::format("theme {}\ntext_size {}\nfirst_steps {}\n{}", nameOf(kThemes, dark), text_percent,
                          firstSteps ? "yes" : "no", where));
    out.commit();
  } catch (const std::exception&) {  // not important enough for an error
  }
}

}  // namespace palpate
