#include "haptics/library/contact_events.hpp"

#include <algorithm>
#include <cstdint>

#include "haptics/library/callbacks.hpp"

namespace palpate::library {

namespace {

// The event that a pp_contact or a pp_tick reports.
template <class Felt>
pp_contact_event eventOf(std::size_t hand, double t_s, const Felt& felt) {
  pp_contact_event event{};
  event.t_s = t_s;
  std::ranges::copy(felt.proxy, event.proxy);
  std::ranges::copy(felt.normal, event.normal);
  std::ranges::copy(felt.force_N, event.force_N);
  event.hand = static_cast<std::uint32_t>(hand);
  event.begins = 1;
  return event;
}

}  // namespace

void ContactEvents::listen(pp_contact_function function, void* user) {
  function_ = function;
  user_ = user;
  last_ = {};
}

void ContactEvents::felt(std::size_t hand, double t_s, const pp_contact& contact) {
  if (function_) tell(hand, contact.contact && contact.valid, eventOf(hand, t_s, contact));
}

void ContactEvents::felt(std::size_t hand, const pp_tick& tick) {
  if (function_) tell(hand, tick.contact && tick.valid, eventOf(hand, tick.t_s, tick));
}

void ContactEvents::tell(std::size_t hand, bool touches, const pp_contact_event& now) {
  last_s_ = now.t_s;
  pp_contact_event& last = last_[hand];
  const bool touched = last.begins != 0;
  if (touches) last = now;
  if (touches == touched) return;
  last.begins = touches;
  pp_contact_event event = last;
  event.t_s = now.t_s;
  const InCallback inside;
  function_(user_, &event);
}

void ContactEvents::endAll() {
  for (std::size_t hand = 0; hand < last_.size(); ++hand)
    if (function_ && last_[hand].begins) tell(hand, false, {.t_s = last_s_});
}

}  // namespace palpate::library
