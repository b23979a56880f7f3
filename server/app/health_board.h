// What grpc.health.v1 answers: of the server as a whole (""), of each of its services, and of each
// map ("map/NAME"). Thread-safe.
#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <string>

#include <grpcpp/health_check_service_interface.h>

namespace maploc {

// Maps beyond these have no health of their own (NOT_FOUND): gRPC forgets no name.
inline constexpr std::size_t kMaxMapsWithHealth = 1000;

class HealthBoard {
 public:
  // From now on `service` tells what is known, and what becomes known, until Close.
  void Open(grpc::HealthCheckServiceInterface* service);
  // Everything is NOT_SERVING for good. Idempotent.
  void Close();

  void SetHealthy(bool healthy);
  // The store's maps, and of each whether it can be opened. One that is missing where it was before
  // is NOT_SERVING.
  void SetMaps(const std::map<std::string, bool>& maps);

 private:
  // REQUIRES of these: mutex_ is held.
  void Tell();
  // gRPC writes to every watcher, also what it has written before.
  void TellChange(const std::string& name, bool serving);

  std::mutex mutex_;                                      // guards all below
  grpc::HealthCheckServiceInterface* service_ = nullptr;  // null: not open
  bool healthy_ = true;
  std::map<std::string, bool> maps_;
  std::map<std::string, bool> told_;  // what gRPC has heard, by its names
};

}  // namespace maploc
