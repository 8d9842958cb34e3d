// A session where the system starts only so many threads.
#include "tests/few_threads_linux.hpp"

#include "tests/library/ball.hpp"

namespace palpate::few_threads_test {

TEST_CASE("a session that cannot have its threads is refused in words, and does not hang") {
  if (!kThreadsCanBeFew) {
    MESSAGE("skipped: a sanitizer starts the threads");
    return;
  }
  const BallCloud ball;
  const pp_brush brush = pp_default_brush();
  pp_session_options options = cpuOptions();
  options.threads = 4;
  bool opens = false;
  int refused = 0;
  for (int more = 0; !opens && more < 100; ++more) {
    CAPTURE(more);
    pp_session session{};
    pp_status status = PP_OK;
    {
      const FewThreads few(more);
      status = pp_session_open(ball.cloud, &options, &session);
      if (status == PP_OK) status = pp_session_set_brush(session, &brush);
    }
    opens = status == PP_OK;
    if (!opens) {
      ++refused;
      CHECK(status == PP_ERROR_FAILED);
      CHECK_MESSAGE(lastErrorSays("the system does not start another thread"), std::string(pp_last_error()));
    }
    if (session.id != 0) PP_CHECK_OK(pp_session_close(session));
  }
  CHECK(opens);
  CHECK(refused >= 3);
}

TEST_CASE("more threads than any machine has are refused") {
  const BallCloud ball(100);
  pp_session_options options = cpuOptions();
  pp_session session{};
  for (const std::uint32_t threads : {1025u, 4'000'000'000u}) {
    options.threads = threads;
    PP_CHECK_FAILS(pp_session_open(ball.cloud, &options, &session), PP_ERROR_ARGUMENT, "is above the maximum, 1024");
  }
}

TEST_CASE("a struct whose size ends within a number is refused") {
  const BallCloud ball(100);
  pp_session_options options = cpuOptions();
  pp_session session{};
  for (const std::uint32_t size : {9u, 12u, 20u, static_cast<std::uint32_t>(sizeof options - 1)}) {
    options.size = size;
    PP_CHECK_FAILS(pp_session_open(ball.cloud, &options, &session), PP_ERROR_ARGUMENT, "its size is");
  }
}

}  // namespace palpate::few_threads_test
