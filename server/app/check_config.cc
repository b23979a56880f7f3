#include "server/app/check_config.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "mapstore/base/standard_output.h"
#include "mapstore/base/table.h"
#include "mapstore/base/usage.h"
#include "mapstore/store/sqlite_store.h"
#include "server/access/token_file.h"
#include "server/app/exposure.h"
#include "server/app/listening_sockets.h"
#include "server/recorder/recording_ring.h"

namespace maploc {
namespace {

using Json = nlohmann::ordered_json;

// Of a file that a start would make.
Status CheckFolder(const std::string& option, const std::string& path) {
  std::error_code none;
  const std::string folder = std::filesystem::absolute(path).parent_path().string();
  if (!std::filesystem::is_directory(folder, none)) {
    return Status(StatusCode::kNotFound, "FOLDER_NOT_FOUND",
                  option + ": the folder " + folder + " does not exist; make it");
  }
  if (faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) == 0) return Status::Ok();
  return Status(StatusCode::kPermissionDenied, "CANNOT_WRITE",
                option + ": this program may not write in the folder " + folder + " (" +
                    std::strerror(errno) + "); run it as the folder's owner, or choose another");
}

Status CheckAddressesDiffer(const ServerOptions& options) {
  if (!IsSameAddress(options.listen, options.metrics_listen)) return Status::Ok();
  return InvalidArgument("--metrics-listen", "is the address of --listen; choose another port",
                         "SAME_ADDRESS");
}

// A fresh one would be made in an existing folder.
Status CheckStoreOpens(const std::string& path) {
  std::error_code none;
  const auto bytes = std::filesystem::file_size(path, none);
  if (none || bytes == 0) {
    MAPLOC_RETURN_IF_ERROR(CheckFolder("--store", path));
    return CheckStore(path);
  }
  SqliteStoreOptions options;
  options.create = false;
  options.read_only = true;
  const Status status = OpenSqliteStore(path, options).status();
  // A server brings it up to date.
  return status.reason() == "STORE_TOO_OLD" && CanWriteStore(path) ? Status::Ok() : status;
}

std::vector<std::string> FindFaults(const ServerOptions& options) {
  std::vector<Status> checks{CheckHost("--listen", options.listen), CheckExposure(options)};
  if (!options.metrics_listen.empty()) {
    checks.push_back(CheckHost("--metrics-listen", options.metrics_listen));
    checks.push_back(CheckAddressesDiffer(options));
  }
  if (!options.port_file.empty()) checks.push_back(CheckFolder("--port-file", options.port_file));
  if (!options.tls.cert.empty() && !options.tls.key.empty()) {
    const std::vector<Status> tls = FindTlsFaults(options.tls);
    checks.insert(checks.end(), tls.begin(), tls.end());
  }
  if (!options.store.empty()) {
    checks.push_back(CheckStoreOpens(options.store));
    checks.push_back(TokenFile(options.store).Read().status());
  }
  if (!options.recorder.folder.empty()) {
    checks.push_back(CheckRecorderFolder(options.recorder.folder));
  }
  std::vector<std::string> faults;
  for (const Status& check : checks) {
    if (!check.ok()) faults.push_back(check.message() + " (" + check.reason() + ")");
  }
  return faults;
}

void PrintJson(const ParsedOptions& parsed) {
  Json options = Json::array();
  for (const OptionValue& value : parsed.values) {
    options.push_back({{"option", value.option}, {"value", value.value}, {"from", value.from}});
  }
  const Json document{{"options", options}, {"faults", parsed.faults}};
  // Values come from an environment whose text need not be UTF-8.
  std::cout << document.dump(2, ' ', false, Json::error_handler_t::replace) << "\n";
}

void PrintTable(const ParsedOptions& parsed) {
  Table table({"option", "value", "from"});
  for (const OptionValue& value : parsed.values) {
    table.AddRow({value.option, value.value, value.from});
  }
  table.Print(std::cout);
}

}  // namespace

int CheckConfig(const ServerOptions& options, ParsedOptions parsed, bool json) {
  for (std::string& fault : FindFaults(options)) parsed.faults.push_back(std::move(fault));
  json ? PrintJson(parsed) : PrintTable(parsed);
  const Status printed = FlushStandardOutput();
  if (!printed.ok()) parsed.faults.push_back(printed.message());
  for (const std::string& fault : parsed.faults) std::cerr << "maploc-server: " << fault << "\n";
  return parsed.faults.empty() ? 0 : kExitFailed;
}

}  // namespace maploc
