#include "server/service/services.h"

#include "maploc/v1/localization_service.grpc.pb.h"
#include "maploc/v1/map_service.grpc.pb.h"
#include "mapstore/model/descriptor.h"
#include "proto/convert/convert.h"
#include "server/service/handlers.h"
#include "server/service/unary_call.h"
#include "server/service/worker_pool.h"

namespace maploc {
namespace {

using Context = grpc::CallbackServerContext;
using Reactor = grpc::ServerUnaryReactor;
using Bytes = grpc::ByteBuffer;

// Raw, so that a request arrives as bytes: it is admitted before it is parsed, and bytes that are
// no message are refused with a reason (unary_call.h).
using RawLocalization = v1::LocalizationService::WithRawCallbackMethod_StartSession<
    v1::LocalizationService::WithRawCallbackMethod_Localize<
        v1::LocalizationService::WithRawCallbackMethod_EndSession<
            v1::LocalizationService::Service>>>;
using RawMaps = v1::MapService::WithRawCallbackMethod_ListMaps<
    v1::MapService::WithRawCallbackMethod_GetMap<v1::MapService::WithRawCallbackMethod_ListSegments<
        v1::MapService::WithRawCallbackMethod_GetSegment<v1::MapService::Service>>>>;

// kMaxFeatures points and as many lines with the largest descriptors, and room for the rest.
constexpr int kMaxMessageBytes =
    kMaxFeatures * (2 * 4 + kMaxDescriptorBytes + 4 * 4 + kMaxDescriptorBytes) + (1 << 20);

// Sessions: transactions that wait for the disk and for each other, not for a core. Maps: short
// reads, which wait for nobody, whoever holds the store.
constexpr int kSessionThreads = 4;
constexpr int kMapThreads = 2;
constexpr int kMaxWaitingStore = 256;

// One of the largest messages, or a hundred usual ones.
constexpr std::size_t kMaxWaitingBytes = 24 << 20;

// Starts a call of one RPC on `pool`.
template <typename Request, typename Response>
Reactor* Run(const ServiceContext& services, WorkerPool& pool,
             Status (*handler)(const ServiceContext&, const Call&, const Request&, Response*),
             Context* context, const Bytes* request, Bytes* response) {
  return UnaryCall<Request, Response>::Start(services, pool, handler, context, request, response);
}

class LocalizationImpl final : public RawLocalization {
 public:
  LocalizationImpl(const ServiceContext& services, WorkerPool& localize, WorkerPool& sessions)
      : services_(services), localize_(localize), sessions_(sessions) {}

  Reactor* StartSession(Context* context, const Bytes* request, Bytes* response) override {
    return Run(services_, sessions_, HandleStartSession, context, request, response);
  }
  Reactor* Localize(Context* context, const Bytes* request, Bytes* response) override {
    return Run(services_, localize_, HandleLocalize, context, request, response);
  }
  Reactor* EndSession(Context* context, const Bytes* request, Bytes* response) override {
    return Run(services_, sessions_, HandleEndSession, context, request, response);
  }

 private:
  const ServiceContext& services_;
  WorkerPool& localize_;
  WorkerPool& sessions_;
};

class MapImpl final : public RawMaps {
 public:
  MapImpl(const ServiceContext& services, WorkerPool& pool) : services_(services), pool_(pool) {}

  Reactor* ListMaps(Context* context, const Bytes* request, Bytes* response) override {
    return Run(services_, pool_, HandleListMaps, context, request, response);
  }
  Reactor* GetMap(Context* context, const Bytes* request, Bytes* response) override {
    return Run(services_, pool_, HandleGetMap, context, request, response);
  }
  Reactor* ListSegments(Context* context, const Bytes* request, Bytes* response) override {
    return Run(services_, pool_, HandleListSegments, context, request, response);
  }
  Reactor* GetSegment(Context* context, const Bytes* request, Bytes* response) override {
    return Run(services_, pool_, HandleGetSegment, context, request, response);
  }

 private:
  const ServiceContext& services_;
  WorkerPool& pool_;
};

}  // namespace

struct Services::Impl {
  Impl(const ServiceContext& services, const ServicesOptions& options)
      : context(services),
        localize(options.localize_threads, options.max_waiting_localize, kMaxWaitingBytes),
        sessions(kSessionThreads, kMaxWaitingStore, kMaxWaitingBytes),
        reads(kMapThreads, kMaxWaitingStore, kMaxWaitingBytes),
        localization(context, localize, sessions),
        maps(context, reads) {}

  // First, so that it is destroyed last: at their end the pools finish jobs that use it.
  const ServiceContext context;
  WorkerPool localize;
  WorkerPool sessions;
  WorkerPool reads;
  LocalizationImpl localization;
  MapImpl maps;
};

Services::Services(const ServiceContext& context, const ServicesOptions& options)
    : impl_(std::make_unique<Impl>(context, options)) {}

Services::~Services() = default;

std::vector<std::string> Services::Names() {
  return {v1::LocalizationService::service_full_name(), v1::MapService::service_full_name()};
}

std::size_t Services::localizations() { return impl_->localize.jobs(); }

void Services::Register(grpc::ServerBuilder* builder) {
  builder->SetMaxReceiveMessageSize(kMaxMessageBytes);
  builder->RegisterService(&impl_->localization);
  builder->RegisterService(&impl_->maps);
}

bool Services::Drain(Deadline deadline) {
  const auto pools = {&impl_->localize, &impl_->sessions, &impl_->reads};
  // All of them first: a pool that is still open would take work while another one is waited for.
  for (WorkerPool* pool : pools) pool->Close();
  bool idle = true;
  for (WorkerPool* pool : pools) idle = pool->WaitUntilIdle(deadline) && idle;
  return idle;
}

}  // namespace maploc
