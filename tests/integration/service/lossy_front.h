// A service in front of the real one that loses answers: the call is made and done, and the client
// hears UNAVAILABLE; refuses calls before they begin, as a server with a full queue does; or is
// slow.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include <grpcpp/grpcpp.h>

#include "maploc/v1/localization_service.grpc.pb.h"

namespace maploc::testing {

class LossyFront final : public v1::LocalizationService::Service {
 public:
  // `server` is the real one's HOST:PORT.
  explicit LossyFront(const std::string& server)
      : real_(v1::LocalizationService::NewStub(
            grpc::CreateChannel(server, grpc::InsecureChannelCredentials()))) {
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port_);
    builder.RegisterService(this);
    front_ = builder.BuildAndStart();
  }
  ~LossyFront() override { front_->Shutdown(); }

  std::string Address() const { return "127.0.0.1:" + std::to_string(port_); }

  grpc::Status StartSession(grpc::ServerContext* context, const v1::StartSessionRequest* request,
                            v1::StartSessionResponse* response) override {
    return Forward(context, &v1::LocalizationService::Stub::StartSession, *request, response);
  }
  grpc::Status Localize(grpc::ServerContext* context, const v1::LocalizeRequest* request,
                        v1::LocalizeResponse* response) override {
    return Forward(context, &v1::LocalizationService::Stub::Localize, *request, response);
  }
  grpc::Status EndSession(grpc::ServerContext* context, const v1::EndSessionRequest* request,
                          v1::EndSessionResponse* response) override {
    return Forward(context, &v1::LocalizationService::Stub::EndSession, *request, response);
  }

  std::atomic<int> calls = 0;          // that came in
  std::atomic<int> to_lose = 0;        // of the next answers
  std::atomic<int> to_refuse = 0;      // of the next calls
  std::atomic<int> pushback_ms = 100;  // that a refusal asks for
  std::atomic<int> to_delay = 0;       // of the next calls
  std::atomic<int> delay_ms = 1000;

 private:
  template <class Method, class Request, class Response>
  grpc::Status Forward(grpc::ServerContext* context, Method method, const Request& request,
                       Response* response) {
    ++calls;
    if (to_refuse > 0) {
      --to_refuse;
      context->AddTrailingMetadata("maploc-reason", "QUEUE_FULL");
      context->AddTrailingMetadata("grpc-retry-pushback-ms", std::to_string(pushback_ms));
      return {grpc::StatusCode::RESOURCE_EXHAUSTED, "too many requests wait (QUEUE_FULL)"};
    }
    if (to_delay > 0) {
      --to_delay;
      std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
    }
    grpc::ClientContext onward;
    const grpc::Status status = (*real_.*method)(&onward, request, response);
    if (to_lose == 0) return status;
    --to_lose;
    return {grpc::StatusCode::UNAVAILABLE, "the answer is lost"};
  }

  const std::unique_ptr<v1::LocalizationService::Stub> real_;
  int port_ = 0;
  std::unique_ptr<grpc::Server> front_;
};

}  // namespace maploc::testing
