// Ctrl-C while a session is open: the session must be ended, and its id told, before the process
// goes.
#pragma once

namespace maploc {

// From here on the first SIGINT, SIGTERM or SIGHUP only asks for a stop, and a second one of its
// kind ends the process. One that is ignored (nohup, a job in a script's background) stays so. Of
// the whole process; idempotent.
void CatchStopSignals();

// Whether such a signal has come. Thread-safe.
bool StopRequested();

}  // namespace maploc
