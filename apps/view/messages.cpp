#include "apps/view/messages.hpp"

#include <utility>

#include "engine/core/log.hpp"
#include "engine/gpu/vulkan.hpp"

namespace palpate {

void Messages::say(const std::string& text) {
  constexpr std::size_t kMax = 5;
  add(text);
  if (remarks_.size() > kMax) remarks_.pop_front();
  log_.say("{}", text);
}

void Messages::sayNow(const std::string& text) {
  std::erase_if(remarks_, [](const Remark& remark) { return remark.isOfNow; });
  say(text);
  remarks_.back().isOfNow = true;
}

void Messages::sayError(const std::string& text) {
  constexpr std::size_t kMax = 3;
  last_ = text;
  std::erase(errors_, text);
  errors_.push_back(text);
  if (errors_.size() > kMax) errors_.erase(errors_.begin());
  log_.say("{}", text);
}

void Messages::tryTo(const std::function<void()>& act) {
  try {
    act();
  } catch (const DeviceLost&) {
    throw;
  } catch (const std::exception& error) {
    sayError(error.what());
  }
}

void Messages::add(const std::string& text) {
  last_ = text;
  std::erase_if(remarks_, [&](const Remark& remark) { return remark.text == text; });
  remarks_.push_back({text, {}, false});
}

void Messages::dropOld() {
  constexpr double kShown_s = 6;
  while (!remarks_.empty() && remarks_.front().since.elapsed_s() > kShown_s) remarks_.pop_front();
}

void Messages::forget() {
  remarks_.clear();
  errors_.clear();
}

bool Messages::closeErrors() { return !std::exchange(errors_, {}).empty(); }

std::vector<std::string> Messages::remarks() const {
  std::vector<std::string> texts;
  for (const Remark& remark : remarks_) texts.push_back(remark.text);
  return texts;
}

}  // namespace palpate
