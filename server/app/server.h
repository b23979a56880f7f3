// The server's life in one object: store, sessions, maps, services and the listening port. main()
// runs one; tests run it in their own process.
//
// Thread-safe, construction and destruction apart.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include <grpcpp/grpcpp.h>

#include "mapstore/base/status.h"
#include "mapstore/store/map_store.h"
#include "mapstore/store/serve_lock.h"
#include "server/access/token_book.h"
#include "server/app/acceptor.h"
#include "server/app/connections.h"
#include "server/app/health_board.h"
#include "server/app/memory_return.h"
#include "server/app/metrics_listener.h"
#include "server/app/options.h"
#include "server/app/tls_credentials.h"
#include "server/app/transport_limits.h"
#include "server/recorder/query_recorder.h"
#include "server/service/services.h"
#include "server/sessions/health.h"
#include "server/sessions/map_cache.h"
#include "server/sessions/session_manager.h"

namespace maploc {

// How long running requests may go on after the end was asked for, and until when what was learned
// must be on disk; a store that another process holds so long ends without it.
inline constexpr std::chrono::seconds kDrainTime{7};
inline constexpr std::chrono::seconds kWriteOutTime{9};

class Server {
 public:
  // Refuses to listen beyond loopback without TLS unless `insecure` (INVALID_ARGUMENT, INSECURE).
  // There, without certificates of clients, it asks for tokens; elsewhere where the store has some.
  // Takes the store's lock (refused, it has touched nothing), opens the store (or makes it, where
  // the address is free), sweeps abandoned imports, takes up open sessions, listens, and writes the
  // port file: when it returns ok, the server answers. Errors name the cause and the cure. From
  // then on health is SERVING while statistics can be written and the store is the one that was
  // opened. `on_lost` is called by a thread of the server's when no connection can be accepted any
  // more; it asks for the end, whose Status then is UNAVAILABLE (LISTENER_LOST).
  static Result<std::unique_ptr<Server>> Start(const ServerOptions& options,
                                               std::function<void()> on_lost = {});
  // Shuts down.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  int port() const { return port_; }
  // Of --metrics-listen; 0 where that is not given.
  int metrics_port() const { return metrics_listener_ ? metrics_listener_->port() : 0; }

  // Health turns NOT_SERVING, new requests are refused, running ones finish (kDrainTime at most),
  // observations reach the disk. Sessions stay open for the next start. Idempotent; returns the
  // store's last word ("statistics are not on disk: ..."), which the caller tells; what nobody
  // asked for the destructor logs.
  Status Shutdown();
  // Until somebody calls Shutdown, and that is done.
  void WaitForShutdown();

 private:
  struct Credentials {
    std::unique_ptr<TlsCredentials> tls;  // null: plain text
    std::unique_ptr<TokenBook> tokens;
  };
  static Result<Credentials> OpenCredentials(const ServerOptions& options);
  Server(const ServerOptions& options, std::unique_ptr<MapStore> store,
         std::optional<ServeLock> lock, Credentials credentials, std::function<void()> on_lost);
  Status StartDomain();
  Status Listen();
  Status ListenForScrapes();
  ServerState State();
  grpc_server_credentials* NewTransport();
  // An error where what was learned is not in the file at the store's path.
  Status WriteOut();
  bool IsStopped();
  void LoseListener();
  const ServerOptions options_;
  const std::function<void()> on_lost_;
  int port_ = 0;
  const MemoryReturn memory_return_;
  std::optional<ServeLock> lock_;  // first, so that it is let go last; none: the store is read-only
  std::unique_ptr<MapStore> store_;
  HealthBoard health_board_;
  Health health_{[this] { health_board_.SetHealthy(health_.good()); }};
  ServerMetrics metrics_;
  RequestLog request_log_;
  std::unique_ptr<QueryRecorder> recorder_;  // null: nothing is recorded
  std::unique_ptr<SessionManager> sessions_;
  AnsweredQueries answered_;
  std::unique_ptr<MapCache> maps_;
  const Credentials credentials_;
  std::unique_ptr<Services> services_;
  Connections connections_{MaxConnections()};
  std::unique_ptr<grpc::Server> grpc_server_;
  std::unique_ptr<Acceptor> acceptor_;
  std::unique_ptr<MetricsListener> metrics_listener_;

  std::mutex mutex_;
  std::condition_variable changed_;
  enum class Stage { kServing, kStopping, kStopped } stage_ = Stage::kServing;
  bool listener_lost_ = false;
  Status stopped_;
};

}  // namespace maploc
