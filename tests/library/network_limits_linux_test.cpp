// The network in a forked process, and where the system opens only so many files.
// ctest: waits
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>

#include "engine/core/clock.hpp"
#include "tests/library/serving.hpp"

namespace palpate::network_limits_test {

namespace {

/// The exit status of a child that has 20 s.
int statusOf(const std::function<int()>& child) {
  const pid_t number = ::fork();
  REQUIRE(number >= 0);
  if (number == 0) {
    ::alarm(20);
    ::_exit(child());
  }
  int status = 0;
  REQUIRE(::waitpid(number, &status, 0) == number);
  return status;
}

/// While it lives, this program can open that many more files, or a few more.
class FewFiles {
 public:
  explicit FewFiles(int more) {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    const int next = ::dup(STDERR_FILENO);
    ::close(next);
    const rlimit few{.rlim_cur = static_cast<rlim_t>(next + more), .rlim_max = before_.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &few);
  }
  ~FewFiles() { ::setrlimit(RLIMIT_NOFILE, &before_); }
  FewFiles(const FewFiles&) = delete;
  FewFiles& operator=(const FewFiles&) = delete;

 private:
  rlimit before_{};
};

}  // namespace

TEST_CASE("a process that was forked while its parent serves is refused the network at once") {
  if (!isBuilt()) return;
  const Serving serving("forked");
  const OpenBall ball;
  const pp_network network = ownNetwork();
  const int status = statusOf([&] {
    const Stopwatch since;
    const auto isRefused = [](pp_status given) { return given == PP_ERROR_NETWORK && lastErrorSays("was forked"); };
    std::uint64_t count = 0;
    int wrong = isRefused(pp_network_discover(&network, 3, nullptr, 0, &count)) ? 0 : 1;
    pp_join_options join = pp_default_join_options();
    join.network = &network;
    const pp_session_options options = cpuOptions();
    pp_session session{};
    wrong |= isRefused(pp_session_join("forked", &join, &options, &session)) ? 0 : 2;
    pp_serve_options serve = pp_default_serve_options();
    serve.network = &network;
    pp_server server{};
    wrong |= isRefused(pp_serve(serving.cloud.cloud, "child", &serve, &server)) ? 0 : 4;
    wrong |= pp_live_set_forces(ball.session, 0) == PP_ERROR_STATE ? 0 : 8;
    wrong |= since.elapsed_s() < 1 ? 0 : 16;
    return wrong;
  });
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
  CHECK(serving.info().serving == 1);
}

TEST_CASE("the network where too few files can be opened is refused in words") {
  if (!isBuilt()) return;
  const BallCloud ball(1'000);
  const pp_network network = ownNetwork();
  pp_serve_options options = pp_default_serve_options();
  options.network = &network;
  int refused = 0;
  bool opens = false;
  for (int more = 0; !opens && more < 40; ++more) {
    CAPTURE(more);
    pp_server server{};
    pp_status status = PP_OK;
    {
      const FewFiles few(more);
      status = pp_serve(ball.cloud, "few files", &options, &server);
    }
    opens = status == PP_OK;
    if (opens) {
      PP_CHECK_OK(pp_server_close(server));
    } else {
      ++refused;
      CHECK(status == PP_ERROR_NETWORK);
      CHECK_MESSAGE(lastErrorSays("open files"), std::string(pp_last_error()));
    }
  }
  CHECK(opens);
  CHECK(refused >= 8);
}

}  // namespace palpate::network_limits_test
