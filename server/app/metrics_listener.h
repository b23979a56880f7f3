// HTTP for those who watch: `/metrics` (Prometheus' text) and `/healthz` (200 while the server is
// healthy, else 503). Reads alone, by threads of its own, so that a scrape never waits for a
// query. Its end takes two seconds (civetweb's). Not encrypted, and without credentials: meant for
// loopback or an operator's network.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "mapstore/base/status.h"

namespace maploc {

class MetricsListener {
 public:
  // What it answers with; called by its threads, at the same time.
  struct Content {
    std::function<std::string()> metrics;
    std::function<bool()> healthy;
  };

  // Listens on HOST:PORT; port 0 lets the system choose. UNAVAILABLE (CANNOT_LISTEN) where nobody
  // can listen there.
  static Result<std::unique_ptr<MetricsListener>> Start(const std::string& address,
                                                        Content content);
  ~MetricsListener();
  MetricsListener(const MetricsListener&) = delete;
  MetricsListener& operator=(const MetricsListener&) = delete;

  int port() const;

 private:
  struct Impl;
  explicit MetricsListener(std::unique_ptr<Impl> impl);
  const std::unique_ptr<Impl> impl_;
};

}  // namespace maploc
