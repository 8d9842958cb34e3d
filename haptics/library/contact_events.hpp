// Beginning and end of contacts, for the program's function.
#pragma once

#include <palpate/palpate.h>

#include <array>

namespace palpate::library {

/// Calls the program's function where a hand comes into contact or leaves it. Allocates nothing. Throws what the
/// function throws.
class ContactEvents {
 public:
  /// From the next tick on; null: no function.
  void listen(pp_contact_function function, void* user);
  /// One tick of a hand.
  void felt(std::size_t hand, double t_s, const pp_contact& contact);
  void felt(std::size_t hand, const pp_tick& tick);
  /// Ends all contacts, at the time of the last tick.
  void endAll();

 private:
  void tell(std::size_t hand, bool touches, const pp_contact_event& now);

  pp_contact_function function_ = nullptr;
  void* user_ = nullptr;
  double last_s_ = 0;
  std::array<pp_contact_event, PP_MAX_HANDS> last_{};  // last tick in contact; begins is 1 while that lasts
};

}  // namespace palpate::library
