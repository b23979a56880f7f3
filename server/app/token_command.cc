#include "server/app/token_command.h"

#include <cctype>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "mapstore/base/clock.h"
#include "mapstore/base/standard_output.h"
#include "mapstore/base/table.h"
#include "mapstore/base/usage.h"
#include "server/access/token_file.h"
#include "server/sessions/caught.h"

namespace maploc {
namespace {

using Json = nlohmann::json;

constexpr char kFooter[] =
    "Examples:\n"
    "  maploc-server token create --store campus.maploc --role robot --robot rover-1 --map yard "
    "--expires 90d\n"
    "  maploc-server token list --store campus.maploc\n"
    "  maploc-server token revoke --store campus.maploc --id 3f9c0d52b7e841a6\n"
    "\n"
    "Roles: a robot localizes on its maps under its own name; a viewer reads; an operator also "
    "ends "
    "or\n"
    "discards sessions. A change is in force within a second, without a restart.\n";

// A hundred years: what is later has no place in 64 bits of nanoseconds.
constexpr std::int64_t kLongestLifetimeS = 36500ll * 86400;

struct Flags {
  std::string store;
  bool json = false;
  std::string role;
  Grant grant;
  std::int64_t lifetime_s = 0;  // 0: for ever
  std::string id;
};

std::string Time(std::int64_t unix_ns) {
  const std::time_t seconds = unix_ns / 1'000'000'000;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[32];
  std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

std::string JoinMaps(const std::vector<std::string>& maps) {
  std::string text;
  for (const std::string& map : maps) text += (text.empty() ? "" : ", ") + map;
  return maps.empty() ? "all" : text;
}

std::string ExpiryText(const TokenRecord& record) {
  if (!record.expires_unix_ns) return "never";
  const bool is_over = SystemClock().NowUnixNanos() >= *record.expires_unix_ns;
  return Time(*record.expires_unix_ns) + (is_over ? " (over)" : "");
}

Json RecordJson(const std::string& id, const TokenRecord& record) {
  const Grant& grant = record.grant;
  return {{"id", id},
          {"role", RoleName(grant.role)},
          {"robot", grant.robot.empty() ? Json() : Json(grant.robot)},
          {"maps", grant.maps},
          {"created", Time(record.created_unix_ns)},
          {"expires", record.expires_unix_ns ? Json(Time(*record.expires_unix_ns)) : Json()},
          {"revoked", record.revoked_unix_ns ? Json(Time(*record.revoked_unix_ns)) : Json()}};
}

Status Create(const Flags& flags) {
  std::error_code ignored;
  if (!std::filesystem::exists(flags.store, ignored)) {
    std::cerr << "note: " << flags.store << " does not exist yet; the token is for the store that "
              << "will be made there\n";
  }
  Grant grant = flags.grant;
  grant.role = RoleFromName(flags.role).value();
  std::optional<std::chrono::seconds> lifetime;
  if (flags.lifetime_s > 0) lifetime.emplace(flags.lifetime_s);
  MAPLOC_ASSIGN_OR_RETURN(const Token token, TokenFile(flags.store).Create(grant, lifetime));
  if (flags.json) {
    std::cout << Json{{"id", token.id}, {"token", TokenText(token)}}.dump(2) << "\n";
    return Status::Ok();
  }
  // On standard error, so that the token alone is on standard output for a script.
  std::cerr << "token " << token.id << " is shown this once; keep it in a file that its user alone "
            << "may read\n";
  std::cout << TokenText(token) << "\n";
  return Status::Ok();
}

Status List(const Flags& flags) {
  MAPLOC_ASSIGN_OR_RETURN(const std::optional<TokenRecords> found, TokenFile(flags.store).Read());
  const TokenRecords records = found.value_or(TokenRecords());
  Json json = Json::array();
  Table table({"id", "role", "robot", "maps", "created", "expires", "revoked"});
  for (const auto& [id, record] : records) {
    json.push_back(RecordJson(id, record));
    table.AddRow({id, std::string(RoleName(record.grant.role)), record.grant.robot,
                  JoinMaps(record.grant.maps), Time(record.created_unix_ns), ExpiryText(record),
                  record.revoked_unix_ns ? Time(*record.revoked_unix_ns) : ""});
  }
  if (flags.json) {
    std::cout << json.dump(2) << "\n";
  } else {
    table.Print(std::cout);
  }
  return Status::Ok();
}

Status Revoke(const Flags& flags) {
  MAPLOC_RETURN_IF_ERROR(TokenFile(flags.store).Revoke(flags.id));
  if (flags.json) {
    std::cout << Json{{"id", flags.id}, {"revoked", true}}.dump(2) << "\n";
  } else {
    std::cout << "token " << flags.id << " is revoked\n";
  }
  return Status::Ok();
}

// CLI11 takes "d" for one day; a script's "${DAYS}d" without DAYS must not.
std::string RefuseUnitAlone(const std::string& time) {
  return !time.empty() && (std::isdigit(static_cast<unsigned char>(time[0])) != 0)
             ? ""
             : "must be a number with its unit, such as 90d, got '" + time + "'";
}

using Work = std::function<Status(const Flags&)>;

CLI::App* Add(CLI::App& app, Flags& flags, Work* chosen, const char* name, const char* what,
              const Work& work) {
  CLI::App* command = app.add_subcommand(name, what);
  command->add_option("--store", flags.store, "The store's file")
      ->envname("MAPLOC_STORE")
      ->required();
  command->add_flag("--json", flags.json, "One JSON document on standard output");
  command->footer(kFooter);
  command->callback([chosen, work] { *chosen = work; });
  return command;
}

void AddCreate(CLI::App& app, Flags& flags, Work* chosen) {
  CLI::App* create =
      Add(app, flags, chosen, "create", "Make a token, and print it this once", Create);
  create->add_option("--role", flags.role, "robot, operator or viewer")
      ->required()
      ->check(CLI::IsMember({"robot", "operator", "viewer"}));
  create->add_option("--robot", flags.grant.robot, "The name under which the robot works");
  create
      ->add_option("--expires", flags.lifetime_s,
                   "How long the token is good: 90d, 12h, 30m, 45s; left out: for ever")
      ->transform(CLI::AsNumberWithUnit(
          std::map<std::string, std::int64_t>{{"s", 1}, {"m", 60}, {"h", 3600}, {"d", 86400}},
          CLI::AsNumberWithUnit::UNIT_REQUIRED, "TIME"))
      ->transform(CLI::Validator(RefuseUnitAlone, ""))  // runs first
      ->check(CLI::Range(std::int64_t{1}, kLongestLifetimeS));
  create->add_option("--map", flags.grant.maps, "A map that the token is for, repeated; none: all")
      ->take_all();
  create->callback([&flags, chosen] {
    // CLI11 can make an option need another one, but not a value of another one.
    if ((flags.role == "robot") == flags.grant.robot.empty()) {
      throw CLI::ValidationError("--robot", "goes with --role robot, and with no other role");
    }
    *chosen = Create;
  });
}

int Fail(const Status& status) {
  std::cerr << "maploc-server token: " << status.message() << " (" << status.reason() << ")\n";
  return kExitFailed;
}

}  // namespace

bool IsTokenCommand(int argc, const char* const* argv) {
  return argc > 1 && std::string(argv[1]) == "token";
}

int RunTokenCommand(int argc, const char* const* argv) {
  Flags flags;
  Work work;
  CLI::App app("Makes, lists and revokes the tokens of a store.", "maploc-server token");
  app.footer(kFooter);
  app.require_subcommand(1);
  AddUsage(app);
  AddCreate(app, flags, &work);
  Add(app, flags, &work, "list", "The tokens, without their secrets", List);
  Add(app, flags, &work, "revoke", "End a token", Revoke)
      ->add_option("--id", flags.id, "As `list` has it")
      ->required();
  try {
    // The word "token" stands where CLI11 expects the program's name.
    app.parse(argc - 1, argv + 1);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kExitWrongUsage;
  }
  Status status = Caught([&] { return work(flags); });
  if (status.ok()) status = FlushStandardOutput();
  return status.ok() ? 0 : Fail(status);
}

}  // namespace maploc
