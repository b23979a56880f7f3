// LocalizationService and MapService as gRPC serves them. Localizations have a pool of their own,
// so that a flood of them does not keep a session from starting or ending, nor a slow disk a query.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <grpcpp/grpcpp.h>

#include "server/service/service_context.h"

namespace maploc {

struct ServicesOptions {
  int localize_threads = 1;      // at least 1; the number of cores is a good choice
  int max_waiting_localize = 8;  // beside those that run; more are RESOURCE_EXHAUSTED
};

class Services {
 public:
  Services(const ServiceContext& context, const ServicesOptions& options);
  // REQUIRES: the gRPC server is shut down.
  ~Services();

  // The services' full names, by which their health is asked for.
  static std::vector<std::string> Names();

  // Localizations that run or wait.
  std::size_t localizations();

  // Registers the services and the size limit of a message.
  void Register(grpc::ServerBuilder* builder);
  // New calls are UNAVAILABLE (SHUTTING_DOWN); waits for the running ones. False when the deadline
  // came first.
  bool Drain(Deadline deadline);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace maploc
