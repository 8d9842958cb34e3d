#include "haptics/session/recorded_contacts.hpp"

#include <cstring>

#include "engine/core/error.hpp"
#include "engine/touch/touch_backend.hpp"
#include "haptics/state_numbers.hpp"

namespace palpate {
namespace {

constexpr std::size_t kContactNumbers = 17;

void visitContact(StateNumbers& visit, ProxyTracker::State& state) {
  visit(state.started, state.touching, state.sticks, state.face, state.facing, state.lastHip, state.proxy,
        state.velocity, state.time_s);
}

}  // namespace

std::string contentOf(std::span<const double> numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()};
}

std::vector<double> recordContacts(TouchBackend& backend) {
  const std::vector<ProxyTracker::State> contacts = backend.contacts();
  std::vector<double> numbers(kContactNumbers * contacts.size());
  StateNumbers to = StateNumbers::to(numbers);
  for (ProxyTracker::State contact : contacts) visitContact(to, contact);
  backend.restoreContacts(contacts);
  return numbers;
}

std::vector<double> restoreContacts(std::string_view content, TouchBackend& backend) {
  std::vector<double> numbers(content.size() / sizeof(double));
  std::memcpy(numbers.data(), content.data(), numbers.size() * sizeof(double));
  std::vector<ProxyTracker::State> contacts(backend.contacts().size());
  const std::size_t own = kContactNumbers * contacts.size();
  if (numbers.size() <= own) throw Error("the beginning of the recording does not fit this session");
  StateNumbers from = StateNumbers::from(std::span(numbers).last(own));
  for (ProxyTracker::State& contact : contacts) visitContact(from, contact);
  backend.restoreContacts(contacts);
  numbers.resize(numbers.size() - own);
  return numbers;
}

}  // namespace palpate
