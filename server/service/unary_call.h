// One unary RPC between gRPC's raw callback interface and a handler: admitted to a pool of threads
// or refused, then parsed, bounded in time, told when the client goes. Raw, because gRPC answers
// bytes that it cannot parse with UNIMPLEMENTED and no word. Deletes itself when gRPC is done.
#pragma once

#include <atomic>
#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include <grpcpp/grpcpp.h>

#include "mapstore/base/wait_limit.h"
#include "server/service/grpc_status.h"
#include "server/service/record_query.h"
#include "server/service/service_context.h"
#include "server/service/traceparent.h"
#include "server/service/worker_pool.h"
#include "server/sessions/caught.h"

namespace maploc {

// What a client may ask for at most; also the deadline of those that set none.
inline constexpr std::chrono::seconds kMaxCallTime{60};

// Before its deadline a call gives up waiting for others, so that the client hears why.
inline constexpr std::chrono::milliseconds kAnswerTime{100};

template <typename Request, typename Response>
class UnaryCall final : public grpc::ServerUnaryReactor {
 public:
  using Handler = Status (*)(const ServiceContext&, const Call&, const Request&, Response*);

  // `services` and the buffers outlive the call; gRPC owns the buffers.
  static grpc::ServerUnaryReactor* Start(const ServiceContext& services, WorkerPool& pool,
                                         Handler handler, grpc::CallbackServerContext* context,
                                         const grpc::ByteBuffer* request,
                                         grpc::ByteBuffer* response) {
    auto* call = new UnaryCall(services, handler, context, request, response);
    // Before it waits: who is nobody takes no place in a queue.
    Result<Caller> caller = services.tokens->Authenticate(Header(*context, "authorization"));
    if (!caller.ok()) {
      call->FinishWith(caller.status());
      return call;
    }
    call->caller_ = *std::move(caller);
    call->facts_.robot = call->caller_.robot();
    const WorkerPool::Admission admission = pool.Submit(
        call->Share(),
        {request->Length(), [call] { call->Run(); }, [call] { call->FinishWith(QueueFull()); }});
    if (admission == WorkerPool::Admission::kFull) {
      call->FinishWith(QueueFull());
    } else if (admission == WorkerPool::Admission::kClosed) {
      call->FinishWith(Status(StatusCode::kUnavailable, "SHUTTING_DOWN", "the server is stopping"));
    }
    return call;
  }

 private:
  struct Messages {
    Request request;
    Response response;
  };

  UnaryCall(const ServiceContext& services, Handler handler, grpc::CallbackServerContext* context,
            const grpc::ByteBuffer* request, grpc::ByteBuffer* response)
      : services_(services),
        handler_(handler),
        context_(context),
        request_(request),
        response_(response),
        deadline_(SteadyDeadline(*context)) {}

  // "maploc.v1.LocalizeRequest" -> "Localize".
  static std::string MethodName() {
    const std::string name = Request::descriptor()->name();
    return name.substr(0, name.size() - std::string_view("Request").size());
  }

  static std::optional<std::string_view> Header(const grpc::CallbackServerContext& context,
                                                const char* name) {
    const auto found = context.client_metadata().find(name);
    if (found == context.client_metadata().end()) return std::nullopt;
    return std::string_view(found->second.data(), found->second.size());
  }

  // Whose share of the queue it takes: a robot that names itself by a token has one, on however
  // many connections; anybody else one a connection.
  std::string Share() const {
    const std::string robot = caller_.robot();
    return robot.empty() ? context_->peer() : "robot " + robot;
  }

  static Deadline SteadyDeadline(const grpc::CallbackServerContext& context) {
    const auto left = context.deadline() - std::chrono::system_clock::now();
    return std::chrono::steady_clock::now() +
           (left < kMaxCallTime ? std::chrono::duration_cast<std::chrono::nanoseconds>(left)
                                : kMaxCallTime);
  }

  static Status QueueFull() {
    return ResourceExhausted("QUEUE_FULL", "too many requests wait; try again");
  }

  void Run() {
    wait_s_ = SecondsSinceArrival();
    services_.metrics->ObserveWait(MethodName(), *wait_s_);
    FinishWith(Handle());
  }

  Status Handle() {
    if (cancelled_) return Status(StatusCode::kCancelled, "CANCELLED", "the client has gone");
    if (std::chrono::steady_clock::now() >= deadline_) {
      return Status(StatusCode::kDeadlineExceeded, "DEADLINE_EXCEEDED",
                    "the deadline passed while the request waited");
    }
    // The last line of defence: one request's accident must not take the others along.
    return Caught([this] { return Answer(); });
  }

  Status Answer() {
    Messages& messages = messages_.emplace();
    grpc::ByteBuffer bytes(*request_);  // shares them; parsing empties it
    const bool parsed =
        grpc::SerializationTraits<Request>::Deserialize(&bytes, &messages.request).ok();
    // gRPC does not look at it again; while the call runs it would double the largest messages.
    const_cast<grpc::ByteBuffer*>(request_)->Clear();
    if (!parsed) {
      messages_.reset();
      return NotParsed(Request::descriptor()->full_name());
    }
    const WaitLimit limit(deadline_ - kAnswerTime, &cancelled_);
    MAPLOC_RETURN_IF_ERROR(handler_(services_, {deadline_, &cancelled_, caller_, &facts_},
                                    messages.request, &messages.response));
    bool owned = false;
    return grpc::SerializationTraits<Response>::Serialize(messages.response, response_, &owned).ok()
               ? Status::Ok()
               : Internal("the answer cannot be written");
  }

  void FinishWith(const Status& status) {
    const double taken_s = SecondsSinceArrival();
    services_.metrics->CountCall(MethodName(), status, taken_s);
    const FinishedRequest finished{MethodName(),
                                   status,
                                   ParseTraceparent(Header(*context_, "traceparent").value_or("")),
                                   facts_,
                                   1e3 * wait_s_.value_or(taken_s),
                                   1e3 * taken_s};
    services_.requests->Write(finished);
    // A comparison would take a repeated query for two.
    if (services_.recorder != nullptr && messages_ && !facts_.is_repeat) {
      RecordQuery(*services_.recorder, finished, services_.clock->NowUnixNanos(),
                  messages_->request, messages_->response);
    }
    messages_.reset();  // what is still to be sent are bytes
    Finish(ToGrpc(status, services_.store_path, context_));
  }
  double SecondsSinceArrival() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - arrived_).count();
  }
  void OnCancel() override { cancelled_ = true; }
  void OnDone() override { delete this; }

  const ServiceContext& services_;
  const Handler handler_;
  grpc::CallbackServerContext* const context_;
  const grpc::ByteBuffer* const request_;
  grpc::ByteBuffer* const response_;
  const std::chrono::steady_clock::time_point arrived_ = std::chrono::steady_clock::now();
  const Deadline deadline_;
  Caller caller_;
  RequestFacts facts_;
  std::optional<Messages> messages_;  // once the request was parsed
  std::optional<double> wait_s_;      // none: it never ran
  std::atomic<bool> cancelled_ = false;
};

}  // namespace maploc
