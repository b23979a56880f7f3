#include "client/cli/stop_signals.h"

#include <atomic>
#include <csignal>
#include <initializer_list>

namespace maploc {
namespace {

std::atomic<bool> stop_requested = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

void RequestStop(int) { stop_requested = true; }

}  // namespace

void CatchStopSignals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    // nohup and shells that put a job into the background ignore signals on its behalf.
    if (sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = RequestStop;
    // RESETHAND: a second signal kills a program that hangs. RESTART: reads and writes under way do
    // not fail with EINTR.
    action.sa_flags = SA_RESETHAND | SA_RESTART;
    sigaction(signal, &action, nullptr);
  }
}

bool StopRequested() { return stop_requested; }

}  // namespace maploc
