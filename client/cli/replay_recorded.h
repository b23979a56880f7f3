// The part of `replay` that runs again what a server has recorded.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "client/cli/commands.h"
#include "proto/recording/recording.h"

namespace maploc {

struct RecordedFlags {
  std::string path;  // empty: nothing recorded is asked for
  RecordingFilter filter;
  int last = 1000;
};

// --recorded, --last, --outcome; returns the first.
CLI::Option* AddRecordedFlags(CLI::App& command, RecordedFlags& flags);

// The queries go outside of any session, so that they teach the map nothing.
Status ReplayRecorded(const CommandContext& context, const RecordedFlags& flags);

}  // namespace maploc
