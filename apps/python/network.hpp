// Networks and joined sessions, as given in Python.
#pragma once

#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "apps/python/interruption.hpp"

namespace palpate::python {

/// Interface, peers, domain and security, as in palpate.Network.
using NetworkTuple =
    std::tuple<std::optional<std::string>, std::vector<std::string>, std::uint32_t, std::optional<std::string>>;

/// Owns the strings that its pp_network points to.
class Network {
 public:
  explicit Network(NetworkTuple given);
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;
  const pp_network* get() const { return &network_; }
  /// Runs a call that waits on the network: Interruption::during().
  template <class Call>
  auto waiting(Call&& call) {
    return interruption_.during(std::forward<Call>(call));
  }

 private:
  NetworkTuple given_;
  std::vector<const char*> peers_;
  pp_network network_ = pp_default_network();
  Interruption interruption_;
};

/// Name, network, hand_name, read_only, timeout_s and partial, as for Session.join().
using JoinTuple = std::tuple<std::string, NetworkTuple, std::optional<std::string>, bool, double, bool>;
/// Requires that Python's lock is not held.
pp::Session join(const JoinTuple& how, const pp_session_options& options);

}  // namespace palpate::python
