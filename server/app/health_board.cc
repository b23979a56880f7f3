#include "server/app/health_board.h"

#include <utility>

#include "server/service/services.h"

namespace maploc {

void HealthBoard::Open(grpc::HealthCheckServiceInterface* service) {
  const std::lock_guard lock(mutex_);
  service_ = service;
  Tell();
}

void HealthBoard::Close() {
  const std::lock_guard lock(mutex_);
  // Cleared first, so that a later SetHealthy does not turn the server SERVING again.
  grpc::HealthCheckServiceInterface* const service = std::exchange(service_, nullptr);
  if (service != nullptr) service->SetServingStatus(false);
}

void HealthBoard::SetHealthy(bool healthy) {
  const std::lock_guard lock(mutex_);
  healthy_ = healthy;
  Tell();
}

void HealthBoard::SetMaps(const std::map<std::string, bool>& maps) {
  const std::lock_guard lock(mutex_);
  for (auto& [name, usable] : maps_) usable = false;
  for (const auto& [name, usable] : maps) {
    if (maps_.size() < kMaxMapsWithHealth || maps_.contains(name)) maps_[name] = usable;
  }
  Tell();
}

void HealthBoard::Tell() {
  if (service_ == nullptr) return;
  TellChange("", healthy_);
  for (const std::string& name : Services::Names()) TellChange(name, healthy_);
  for (const auto& [name, usable] : maps_) TellChange("map/" + name, healthy_ && usable);
}

void HealthBoard::TellChange(const std::string& name, bool serving) {
  const auto [told, first] = told_.try_emplace(name, serving);
  if (!first && told->second == serving) return;
  told->second = serving;
  service_->SetServingStatus(name, serving);
}

}  // namespace maploc
