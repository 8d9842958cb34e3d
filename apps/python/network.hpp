// Networks and sessions of others, as Python names them.
#pragma once

#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "apps/python/interruption.hpp"

namespace palpate::python {

/// Interface, peers and domain, as palpate.Network has them.
using NetworkTuple =
    std::tuple<std::optional<std::string>, std::vector<std::string>, std::uint32_t, std::optional<std::string>>;

/// Keeps the words that it points to.
class Network {
 public:
  explicit Network(NetworkTuple given);
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;
  const pp_network* get() const { return &network_; }
  /// What waits on it: Interruption::during().
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

/// Name, network, hand, read_only and patience_s, as palpate.Join has them.
using JoinTuple = std::tuple<std::string, NetworkTuple, std::optional<std::string>, bool, double, bool>;
/// Without Python's lock.
pp::Session join(const JoinTuple& how, const pp_session_options& options);

}  // namespace palpate::python
