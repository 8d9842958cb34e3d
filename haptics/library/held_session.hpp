// Finds a session and holds this thread's claim on it for the duration of a call of the C interface.
#pragma once

#include "haptics/library/objects.hpp"
#include "haptics/library/open_session.hpp"
#include "haptics/library/options.hpp"

namespace palpate::library {

template <class Do>
pp_status with(pp_session session, Claim claim, Do&& act) {
  return guarded([&] {
    const auto found = objectOf<OpenSession>(session.id);
    const Claims::Held held(found->claims(), claim);
    found->ensureBuilt();
    act(*found);
  });
}

/// The same for calls that take long, which the program may watch.
template <class Do>
pp_status lasting(pp_session session, Do&& act) {
  return with(session, Claim::all, [&](OpenSession& open) { open.watch().run([&] { act(open); }); });
}

/// For commands, which a live session takes while it runs: they wait for the calls of other threads then.
template <class Do>
pp_status commanding(pp_session session, Do&& act) {
  return guarded([&] {
    const auto found = objectOf<OpenSession>(session.id);
    const Claims::Held held(found->claims(), Claim::all, found->goesOn());
    found->ensureBuilt();
    found->watch().run([&] { act(*found); });
  });
}

/// Opens a session of the subject that `modelKindOf` returns, watched by the program.
template <class Give>
void openSession(const pp_session_options* options, pp_session* session, Give&& modelKindOf) {
  required(session, "session");
  const pp_session_options given = optionsFrom(options, "options");
  const auto watch = std::make_shared<Watch>(given.watch);
  std::shared_ptr<OpenSession> made;
  watch->runCut([&] { made = std::make_shared<OpenSession>(modelKindOf(), given, watch); });
  *session = opened<pp_session>(std::move(made));
}

template <class Do>
pp_status looking(pp_session session, Do&& act) {
  return guarded([&] {
    const auto found = objectOf<OpenSession>(session.id);
    const Claims::Held held(found->claims(), found->looking(), found->goesOn());
    found->ensureBuilt();
    act(*found);
  });
}

/// The same for calls that take long, which the program may watch.
template <class Do>
pp_status lookingLong(pp_session session, Do&& act) {
  return looking(session, [&](OpenSession& open) { open.watch().run([&] { act(open); }); });
}

}  // namespace palpate::library
