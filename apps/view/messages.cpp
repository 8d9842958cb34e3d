#include "apps/view/messages.hpp"

#include "engine/core/log.hpp"
#include "engine/gpu/vulkan.hpp"

namespace palpate {

void Messages::say(const std::string& text) {
  constexpr std::size_t kMost = 5;
  add(text);
  if (shown_.size() > kMost) shown_.pop_front();
  log_.say("{}", text);
}

void Messages::tryTo(const std::function<void()>& act) {
  try {
    act();
  } catch (const DeviceLost&) {
    throw;
  } catch (const std::exception& error) {
    say(error.what());
  }
}

void Messages::add(const std::string& text) {
  last_ = text;
  shown_.push_back({text, {}});
}

void Messages::dropOld() {
  constexpr double kShown_s = 6;
  while (!shown_.empty() && shown_.front().since.elapsed_s() > kShown_s) shown_.pop_front();
}

std::vector<std::string> Messages::texts() const {
  std::vector<std::string> texts;
  for (const Message& message : shown_) texts.push_back(message.text);
  return texts;
}

}  // namespace palpate
