// A cloud that the program serves, on a thread of its own.
#pragma once

#include <palpate/palpate.h>

#include <string>

#include "haptics/library/claims.hpp"
#include "haptics/library/messages.hpp"
#include "haptics/library/objects.hpp"
#include "haptics/session/model.hpp"
#include "haptics/sharing/server_thread.hpp"

namespace palpate::library {

/// Thread-safe but for end().
class OpenServer {
 public:
  /// Throws Error.
  OpenServer(const CloudObject& cloud, const std::string& name, const pp_serve_options& options,
             std::shared_ptr<Watch> watch);
  ~OpenServer() { end(); }
  OpenServer(const OpenServer&) = delete;
  OpenServer& operator=(const OpenServer&) = delete;

  const HomeProcess& home() const { return home_; }

  /// Stops serving and calling the program's functions. For one thread.
  void end();
  pp_server_info info();
  PointCloud points();

 private:
  HomeProcess home_;
  std::shared_ptr<Watch> watch_;
  Messages messages_;
  NetworkConfig network_;
  Model model_;
  ServerThread thread_;  // destroyed first
};

}  // namespace palpate::library
