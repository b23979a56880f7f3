// What the command lines of all binaries have in common.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace maploc {

// Exit codes: the job failed (also: an unusable file); the command line could not be parsed.
inline constexpr int kExitFailed = 1;
inline constexpr int kExitWrongUsage = 2;

// --version, which prints the project's version, and WrongUsage for app.exit().
void AddUsage(CLI::App& app);

// Asks for a finite number from `least` to `most`. CLI::Range lets NaN pass, which no comparison
// finds.
CLI::Validator NumberIn(double least, double most);

// "maploc localize: unknown --sever; see maploc localize --help" and a line's end. Of `error`,
// unless the words hold one that the command line does not know: CLI11 looks for what is missing
// first, and would not name it.
std::string WrongUsage(const CLI::App* app, const CLI::Error& error);

}  // namespace maploc
