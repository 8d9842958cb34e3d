// A session, and the claim of this thread on it while a call of the C interface lasts.
#pragma once

#include "haptics/library/objects.hpp"
#include "haptics/library/open_session.hpp"

namespace palpate::library {

template <class Do>
pp_status with(pp_session session, Claim claim, Do&& act) {
  return guarded([&] {
    const auto found = objectOf<OpenSession>(session.id);
    const Claims::Held held(found->claims(), claim);
    act(*found);
  });
}

template <class Do>
pp_status looking(pp_session session, Do&& act) {
  return guarded([&] {
    const auto found = objectOf<OpenSession>(session.id);
    const Claims::Held held(found->claims(), found->looking());
    act(*found);
  });
}

}  // namespace palpate::library
