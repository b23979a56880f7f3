#include "server/app/server.h"

#include <filesystem>
#include <future>
#include <optional>
#include <thread>

#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <spdlog/spdlog.h>

#include "mapstore/base/wait_limit.h"
#include "mapstore/store/sqlite_store.h"
#include "server/app/call_rate.h"
#include "server/app/exposure.h"
#include "server/app/listening_sockets.h"
#include "server/app/log_sink.h"
#include "server/app/memory_limit.h"
#include "server/app/port_file.h"

namespace maploc {
namespace {

constexpr int kWaitingAWorker = 8;
// NOT_SERVING is on its way to them; they do not end by themselves.
constexpr std::chrono::milliseconds kTimeOfWatchers{200};

int Workers(const ServerOptions& options) {
  if (options.workers > 0) return options.workers;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

int Queue(const ServerOptions& options) {
  return options.queue > 0 ? options.queue : kWaitingAWorker * Workers(options);
}

std::int64_t CacheBytes(const ServerOptions& options) {
  // The other half is for the index of places, queries and gRPC.
  return options.cache_bytes > 0 ? options.cache_bytes : MemoryLimit() / 2;
}

Result<std::unique_ptr<MapStore>> OpenStore(const std::string& path) {
  std::error_code ignored;
  const bool exists = std::filesystem::exists(path, ignored);
  SqliteStoreOptions store_options;
  store_options.sweep_abandoned_imports = true;
  MAPLOC_ASSIGN_OR_RETURN(std::unique_ptr<MapStore> store, OpenSqliteStore(path, store_options));
  if (!exists) spdlog::info("{} did not exist: made a fresh store", path);
  if (store->read_only()) {
    spdlog::warn("{} may only be read: localizing outside of sessions alone, nothing is learned",
                 path);
  }
  return store;
}

// What is only read may be served twice. No lock is left beside a file that is no store.
Result<std::optional<ServeLock>> Lock(const std::string& store) {
  MAPLOC_RETURN_IF_ERROR(CheckStore(store));
  if (!CanWriteStore(store)) return std::optional<ServeLock>();
  MAPLOC_ASSIGN_OR_RETURN(ServeLock lock, ServeLock::Acquire(store));
  return std::optional<ServeLock>(std::move(lock));
}

Status ListenerLost(const std::string& address) {
  return Status(StatusCode::kUnavailable, "LISTENER_LOST",
                "no new robot could connect to " + address +
                    " any more, so the server has ended; start it again");
}

using Handover = grpc::experimental::ExternalConnectionAcceptor;

void HandOver(Handover& handover, int fd) {
  Handover::NewConnectionParameters connection;
  connection.fd = fd;
  handover.HandleNewConnection(&connection);
}

// Before the server is built; once a process.
void EnablePlugins() {
  static const bool done = [] {
    grpc::EnableDefaultHealthCheckService(true);
    grpc::reflection::InitProtoReflectionServerBuilderPlugin();
    return true;
  }();
  (void)done;
}

}  // namespace

Server::Server(const ServerOptions& options, std::unique_ptr<MapStore> store,
               std::optional<ServeLock> lock, Credentials credentials,
               std::function<void()> on_lost)
    : options_(options),
      on_lost_(std::move(on_lost)),
      lock_(std::move(lock)),
      store_(std::move(store)),
      request_log_(options_.request_log, NewLogSink(LogFile::StandardError(), LostLines::kUntold)),
      credentials_(std::move(credentials)) {}

Result<Server::Credentials> Server::OpenCredentials(const ServerOptions& options) {
  Credentials credentials;
  MAPLOC_RETURN_IF_ERROR(CheckExposure(options));
  if (!options.tls.cert.empty()) {
    MAPLOC_ASSIGN_OR_RETURN(credentials.tls, TlsCredentials::Open(options.tls));
  }
  MAPLOC_ASSIGN_OR_RETURN(credentials.tokens, TokenBook::Open(options.store, NeedsTokens(options)));
  if (credentials.tokens->IsAskedInVain()) {
    spdlog::warn(
        "callers are asked for a token, and there is none yet: make one with "
        "maploc-server token create --store {}",
        options.store);
  }
  return credentials;
}

Result<std::unique_ptr<Server>> Server::Start(const ServerOptions& options,
                                              std::function<void()> on_lost) {
  MAPLOC_ASSIGN_OR_RETURN(Credentials credentials, OpenCredentials(options));
  std::error_code none;
  const auto bytes = std::filesystem::file_size(options.store, none);
  // A fresh store is not to be made where nobody will serve it.
  if (none || bytes == 0) MAPLOC_RETURN_IF_ERROR(ListenOn(options.listen).status());
  // First: until it is held, port file and store may be another server's.
  MAPLOC_ASSIGN_OR_RETURN(std::optional<ServeLock> lock, Lock(options.store));
  // A port of an earlier run must not be taken for ours.
  if (!options.port_file.empty()) RemovePortFile(options.port_file);
  MAPLOC_ASSIGN_OR_RETURN(std::unique_ptr<MapStore> store, OpenStore(options.store));
  std::unique_ptr<Server> server(new Server(options, std::move(store), std::move(lock),
                                            std::move(credentials), std::move(on_lost)));
  MAPLOC_RETURN_IF_ERROR(server->StartDomain());
  // Before the port file is written: whoever sees that file finds the metrics, too.
  MAPLOC_RETURN_IF_ERROR(server->ListenForScrapes());
  MAPLOC_RETURN_IF_ERROR(server->Listen());
  if (!options.port_file.empty()) {
    MAPLOC_RETURN_IF_ERROR(WritePortFile(options.port_file, server->port_));
  }
  return server;
}

Status Server::StartDomain() {
  SessionManagerOptions sessions;
  sessions.idle_timeout =
      std::chrono::milliseconds(static_cast<std::int64_t>(options_.idle_timeout_s * 1000));
  sessions.health = &health_;
  MAPLOC_ASSIGN_OR_RETURN(sessions_, SessionManager::Create(store_.get(), sessions));
  MapCacheOptions maps;
  maps.segment_bytes = CacheBytes(options_);
  maps.health = &health_;
  maps.tell_maps = [this](const auto& usable) { health_board_.SetMaps(usable); };
  maps_ = std::make_unique<MapCache>(store_.get(), maps);
  if (!options_.recorder.folder.empty()) {
    MAPLOC_ASSIGN_OR_RETURN(recorder_, QueryRecorder::Start(options_.recorder));
  }
  ServiceContext context;
  context.store = store_.get();
  context.sessions = sessions_.get();
  context.answered = &answered_;
  context.maps = maps_.get();
  context.metrics = &metrics_;
  context.requests = &request_log_;
  context.recorder = recorder_.get();
  context.tokens = credentials_.tokens.get();
  context.localizer = options_.localizer;
  context.store_path = options_.store;
  services_ =
      std::make_unique<Services>(context, ServicesOptions{Workers(options_), Queue(options_)});
  if (sessions_->open_sessions() > 0) {
    spdlog::info("{} open sessions go on", sessions_->open_sessions());
  }
  return Status::Ok();
}

grpc_server_credentials* Server::NewTransport() {
  return credentials_.tls != nullptr ? credentials_.tls->New()
                                     : grpc_insecure_server_credentials_create();
}

Status Server::Listen() {
  MAPLOC_ASSIGN_OR_RETURN(ListeningSockets sockets, ListenOn(options_.listen));
  EnablePlugins();
  grpc::ServerBuilder builder;
  LimitTransport(&connections_, &builder);
  const std::shared_ptr<Handover> handover = builder.experimental().AddExternalConnectionAcceptor(
      grpc::ServerBuilder::experimental_type::ExternalConnectionType::FROM_FD,
      LimitedCredentials(NewTransport()));
  services_->Register(&builder);
  std::unique_ptr<grpc::Server> started = builder.BuildAndStart();
  if (started == nullptr) return Internal("gRPC does not start");
  {
    const std::lock_guard lock(mutex_);
    grpc_server_ = std::move(started);
  }
  port_ = sockets.port;
  // After gRPC has started, which gets the connections. Those that come before wait in the sockets'
  // queues.
  acceptor_ = std::make_unique<Acceptor>(
      std::move(sockets), &connections_,
      AcceptorOptions{[handover](int fd) { HandOver(*handover, fd); }, [this] { LoseListener(); }});
  health_board_.Open(grpc_server_->GetHealthCheckService());
  spdlog::info("serving {} on port {} ({}) with {} workers", options_.store, port_,
               credentials_.tls != nullptr ? "TLS" : "plain text", Workers(options_));
  return Status::Ok();
}

Status Server::ListenForScrapes() {
  if (options_.metrics_listen.empty()) return Status::Ok();
  MAPLOC_ASSIGN_OR_RETURN(
      metrics_listener_,
      MetricsListener::Start(options_.metrics_listen, {[this] { return metrics_.Text(State()); },
                                                       [this] { return State().healthy; }}));
  spdlog::info("metrics on port {}", metrics_listener_->port());
  if (IsBeyondLoopback(options_.metrics_listen)) {
    spdlog::warn("{} can be reached from other machines: they can read the metrics, and map names",
                 options_.metrics_listen);
  }
  return Status::Ok();
}

ServerState Server::State() {
  bool serving = false;
  {
    const std::lock_guard lock(mutex_);
    // Scrapes begin before the server listens, and go on while it stops.
    serving = grpc_server_ != nullptr && stage_ == Stage::kServing;
  }
  ServerState state;
  state.healthy = serving && health_.good();
  state.open_sessions = sessions_->open_sessions();
  state.unsaved_observations = sessions_->unsaved_observations();
  state.store_lag_s = sessions_->unsaved_age_s();
  state.lost_observations = sessions_->lost_observations();
  state.localizations = services_->localizations();
  state.localizations_limit = static_cast<std::size_t>(Workers(options_) + Queue(options_));
  state.cache = maps_->segment_state();
  state.lost_log_lines = request_log_.lost_lines();
  if (recorder_) state.recorder = recorder_->state();
  if (credentials_.tls) state.certificate_end_unix_s = credentials_.tls->certificate_end_unix_s();
  return state;
}

void Server::LoseListener() {
  {
    const std::lock_guard lock(mutex_);
    listener_lost_ = true;
  }
  if (on_lost_) on_lost_();
}

Status Server::Shutdown() {
  {
    std::unique_lock lock(mutex_);
    if (stage_ != Stage::kServing) {
      changed_.wait(lock, [this] { return stage_ == Stage::kStopped; });
      return stopped_;
    }
    stage_ = Stage::kStopping;
  }
  const auto begin = std::chrono::steady_clock::now();
  if (grpc_server_ != nullptr) {
    health_board_.Close();
    if (!services_->Drain(begin + kDrainTime)) spdlog::warn("some requests are cut off unfinished");
    // Only now: until here a robot that connects is told SHUTTING_DOWN, instead of getting no
    // answer.
    acceptor_.reset();
    // Nothing of ours runs any more; what is left are watchers of the health, who are to hear it.
    grpc_server_->Shutdown(std::chrono::system_clock::now() + kTimeOfWatchers);
    grpc_server_->Wait();
  }
  // Nobody is answered any more. Meanwhile, because it takes two seconds.
  const std::future<void> scrapes_end =
      std::async(std::launch::async, [this] { metrics_listener_.reset(); });
  const WaitLimit limit(begin + kWriteOutTime);
  Status status = WriteOut().WithContext("statistics are not on disk");
  if (!options_.port_file.empty()) RemovePortFile(options_.port_file);
  scrapes_end.wait();  // who waits for the stop may destroy the server
  {
    const std::lock_guard lock(mutex_);
    if (status.ok() && listener_lost_) status = ListenerLost(options_.listen);
    stage_ = Stage::kStopped;
    stopped_ = status;
  }
  changed_.notify_all();
  return status;
}

Status Server::WriteOut() {
  if (sessions_ == nullptr) return Status::Ok();
  MAPLOC_RETURN_IF_ERROR(sessions_->Shutdown());
  if (store_->read_only()) return Status::Ok();  // nothing was learned
  static_cast<void>(store_->ChangeCounter());    // a read looks at the file's content, too
  const Status replaced = store_->CheckIdentity();
  if (replaced.ok()) return replaced;
  return Status(replaced.code(), replaced.reason(),
                replaced.message() + "; nothing that was learned since is there");
}

bool Server::IsStopped() {
  const std::lock_guard lock(mutex_);
  return stage_ == Stage::kStopped;
}

void Server::WaitForShutdown() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return stage_ == Stage::kStopped; });
}

Server::~Server() {
  const bool told = IsStopped();  // whoever stopped it has its last word
  if (const Status status = Shutdown(); !status.ok() && !told) {
    spdlog::error("{}", status.ToString());
  }
  // In this order: calls first, then what they use.
  grpc_server_.reset();
  services_.reset();
  maps_.reset();
  sessions_.reset();
}

}  // namespace maploc
