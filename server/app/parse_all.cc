#include "server/app/parse_all.h"

#include <algorithm>
#include <set>

namespace maploc {
namespace {

using Words = std::vector<std::string>;

std::string NameOf(const CLI::Option& option) { return "--" + option.get_single_name(); }

bool IsIn(const Words& words, const std::string& flag) {
  return std::ranges::any_of(words, [&flag](const std::string& word) {
    return word == flag || word.starts_with(flag + "=");
  });
}

Words Without(const Words& words, const std::string& flag) {
  Words kept;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == flag) {
      ++i;  // its value
    } else if (!words[i].starts_with(flag + "=")) {
      kept.push_back(words[i]);
    }
  }
  return kept;
}

CLI::Validator* ValidatorAt(CLI::Option* option, int index) {
  try {
    return option->get_validator(index);
  } catch (const CLI::OptionNotFound&) {
    return nullptr;
  }
}

// A value that is refused is told, and the default takes its place.
void Collect(CLI::Option* option, Words* faults) {
  for (int i = 0; CLI::Validator* const validator = ValidatorAt(option, i); ++i) {
    // A copy, because its operation is replaced below.
    const CLI::Validator strict = *validator;
    validator->operation([strict, option, faults](std::string& value) {
      const std::string fault = strict(value);
      if (!fault.empty()) {
        faults->push_back(NameOf(*option) + ": " + fault);
        value = option->get_default_str();
      }
      return std::string();
    });
    // Else CLI11 gives it a copy of the value, and the default would be lost.
    validator->non_modifying(false);
  }
}

// What an option asks for; CLI11 stops at the first that is missing.
struct Demand {
  const CLI::Option* option;
  bool required = false;
  std::set<CLI::Option*> needs;
};

Demand TakeDemand(CLI::Option* option) {
  Demand demand{option, option->get_required(), option->get_needs()};
  option->required(false);
  for (CLI::Option* needed : demand.needs) option->remove_needs(needed);
  return demand;
}

void CheckDemand(const Demand& demand, Words* faults) {
  const std::string name = NameOf(*demand.option);
  if (demand.option->count() == 0) {
    if (demand.required) faults->push_back(name + " is required");
    return;
  }
  for (const CLI::Option* needed : demand.needs) {
    if (needed->count() == 0) faults->push_back(name + " requires " + NameOf(*needed));
  }
}

// What a parse throws; "" where it does not.
std::string Parse(CLI::App& app, Words words, bool* of_the_file) {
  std::reverse(words.begin(), words.end());  // CLI11 takes them from the back
  try {
    app.parse(words);
  } catch (const CLI::FileError& error) {
    *of_the_file = true;
    return error.what();
  } catch (const CLI::ConfigError& error) {
    *of_the_file = true;
    return error.what();
  } catch (const CLI::ParseError& error) {
    return error.what();
  }
  return "";
}

std::string ValueOf(const CLI::Option& option) {
  if (option.count() > 0) return option.as<std::string>();
  const bool is_flag = option.get_expected_max() == 0;
  return is_flag ? "false" : option.get_default_str();
}

// A file that cannot be read is told, and the rest is parsed without it.
void ParseOn(CLI::App& app, const Words& words, Words* faults) {
  bool of_the_file = false;
  std::string fault = Parse(app, words, &of_the_file);
  if (!fault.empty()) faults->push_back(fault);
  if (!of_the_file) return;
  fault = Parse(app, Without(words, NameOf(*app.get_config_ptr())), &of_the_file);
  if (!fault.empty()) faults->push_back(fault);
}

// In their order, each once: of what was parsed twice both parses tell.
Words Unique(const Words& faults) {
  Words unique;
  for (const std::string& fault : faults) {
    if (std::ranges::count(unique, fault) == 0) unique.push_back(fault);
  }
  return unique;
}

std::string SourceOf(const CLI::Option& option, const Words& environment, const Words& flags) {
  if (IsIn(flags, NameOf(option))) return "flag";
  if (IsIn(environment, NameOf(option))) return "environment";
  return option.count() > 0 ? "file" : "default";
}

}  // namespace

ParsedOptions ParseAll(CLI::App& app, const Words& environment, const Words& flags) {
  Words faults;
  // What is unknown is collected, and does not end the parse.
  app.allow_extras();
  app.allow_config_extras(CLI::config_extras_mode::capture);
  std::vector<Demand> demands;
  for (CLI::Option* option : app.get_options()) {
    Collect(option, &faults);
    demands.push_back(TakeDemand(option));
  }
  Words words = environment;
  words.insert(words.end(), flags.begin(), flags.end());
  ParseOn(app, words, &faults);
  for (const Demand& demand : demands) CheckDemand(demand, &faults);
  for (const std::string& unknown : app.remaining()) faults.push_back("unknown option: " + unknown);

  ParsedOptions parsed{{}, Unique(faults)};
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_configurable()) continue;
    parsed.values.push_back(
        {NameOf(*option), ValueOf(*option), SourceOf(*option, environment, flags)});
  }
  return parsed;
}

}  // namespace maploc
