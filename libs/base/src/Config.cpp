// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Config.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/SharedFiles.h>
#include <dyslam/base/Words.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <sstream>
#include <utility>

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
/** Those of sectionsOfRun(), for programs that are built without it. */
constexpr const char* sections_of_dyslam =
    "backend boxes detection_noise detector dylo dyseg dyseg_network fusion gicp gnss gravity "
    "icp_po2pl icp_po2po input labels loam loam_no_mapping loop map memory motion "
    "motion_sensors objects odometry output pipeline preprocess prior_map refine replay "
    "report residual sensor solver start track_smoothing tracker uncertainty";

constexpr const char* set_flag = "--set ";  // prefix of Value::origin for values of --set

/** Removes a comment: " //" and all after it, or the whole line if it begins with "//". */
std::string withoutComment(const std::string& line)
{
  for (std::size_t at = line.find("//"); at != std::string::npos; at = line.find("//", at + 1))
  {
    if (at == 0 || line[at - 1] == ' ' || line[at - 1] == '\t')
    {
      return line.substr(0, at);
    }
  }
  return line;
}
}  // namespace

/** Reads an ini and those that it includes. */
struct Config::Parser
{
  Config readFile(const std::string& path)
  {
    if (!fs::is_regular_file(path))
    {
      throw UserError(path + ": no such config file; give an existing .ini with --config");
    }
    const std::string text = readWhole(path);
    if (text.find_first_not_of(std::string(" \t\r\n\0", 5)) == std::string::npos)
    {
      // As a power cut may leave it; it would be read as all defaults.
      throw UserError(path + ": is empty; restore it, or give another .ini");
    }
    chain.push_back(path);
    Config config = read(text, fs::path(path).filename().string());
    chain.pop_back();
    return config;
  }

  Config read(const std::string& text, const std::string& name)
  {
    const std::string byte_order_mark = "\xEF\xBB\xBF";  // some editors begin a file with it
    std::istringstream lines(
        text.rfind(byte_order_mark, 0) == 0 ? text.substr(byte_order_mark.size()) : text);
    Config included;
    Config own;
    std::string section;
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number)
    {
      const std::string origin = name + ":" + std::to_string(number);
      line = trimmed(withoutComment(line));
      if (line.empty() || line[0] == '#' || line[0] == ';')
      {
        continue;
      }
      if (line.front() == '[')
      {
        section = sectionOf(line, origin);
        own.section_origin_.emplace(section, origin);
        continue;
      }
      const auto equals = line.find('=');
      const std::string key = trimmed(line.substr(0, equals));
      if (equals == std::string::npos || key.empty())
      {
        throw UserError(origin + ": '" + line + "' is not a setting; write key = value");
      }
      const Value value{trimmed(line.substr(equals + 1)), origin, {}};
      if (section.empty())
      {
        readHeader(key, value, included, own);
        continue;
      }
      if (own.has(section, key))
      {
        throw UserError(origin + ": [" + section + "] " + key +
                        " is given twice; the first is at " + own.section(section).at(key).origin);
      }
      own.set(section, key, value);
    }
    included.merge(own);
    return included;
  }

 private:
  static std::string sectionOf(const std::string& line, const std::string& origin)
  {
    if (line.back() != ']' || line.size() < 3)
    {
      throw UserError(origin + ": '" + line + "' is not a section; write [name]");
    }
    return trimmed(line.substr(1, line.size() - 2));
  }

  /** A key before the first section. */
  void readHeader(const std::string& key, const Value& value, Config& included, Config& own)
  {
    if (key == "include")
    {
      included.merge(readIncluded(value));
    }
    else if (key == "program")
    {
      own.program_ = value;
    }
    else
    {
      throw UserError(value.origin + ": key '" + key +
                      "' stands before the first [section], where only include and program may");
    }
  }

  Config readIncluded(const Value& value)
  {
    const std::string what = value.origin + ": include";
    std::string path = value.text;
    if (!chain.empty() && fs::path(path).is_relative())
    {
      const fs::path beside = fs::path(chain.back()).parent_path() / path;
      path = fs::is_regular_file(beside) ? beside.string() : path;
    }
    path = findGivenOrShared(path, "config_files", ".ini", what);
    for (const std::string& open : chain)
    {
      std::error_code ignored;
      if (fs::equivalent(open, path, ignored))
      {
        throw UserError(what + " = " + value.text +
                        ": that file includes this one; remove one of the two lines");
      }
    }
    return readFile(path);
  }

  std::vector<std::string> chain;  //!< files being read, each included by the previous one
};

Config Config::fromFile(const std::string& path)
{
  return Parser().readFile(path);
}

Config Config::fromText(const std::string& text, const std::string& name)
{
  return Parser().read(text, name);
}

void Config::merge(const Config& other)
{
  for (const auto& [section, origin] : other.section_origin_)
  {
    section_origin_.emplace(section, origin);
  }
  for (const std::string& section : other.section_order_)
  {
    for (const std::string& key : other.key_order_.at(section))
    {
      set(section, key, other.sections_.at(section).at(key));
    }
  }
  program_ = other.program_.text.empty() ? program_ : other.program_;
}

void Config::requireFor(const std::string& program) const
{
  // "dyslam-train" is for all of its commands.
  const bool fits = (program + " ").rfind(program_.text + " ", 0) == 0;
  if (!program_.text.empty() && !fits)
  {
    throw UserError(program_.origin + ": these settings are for " + program_.text + ", not for " +
                    program);
  }
}

void Config::set(const std::string& assignment)
{
  const auto equals = assignment.find('=');
  const auto dot = assignment.find('.');
  if (equals == std::string::npos || dot == std::string::npos || dot > equals || dot == 0 ||
      dot + 1 == equals)
  {
    throw UserError(set_flag + assignment + ": write --set section.key=value");
  }
  const std::string section = trimmed(assignment.substr(0, dot));
  const std::string key = trimmed(assignment.substr(dot + 1, equals - dot - 1));
  set(section, key, {trimmed(assignment.substr(equals + 1)), set_flag + section + "." + key, {}});
}

void Config::set(const std::string& section, const std::string& key, Value value)
{
  section_origin_.emplace(section, value.origin);
  const auto [values, new_section] = sections_.emplace(section, Section{});
  if (new_section)
  {
    section_order_.push_back(section);
  }
  const bool new_key = values->second.insert_or_assign(key, std::move(value)).second;
  if (new_key)
  {
    key_order_[section].push_back(key);
  }
}

bool Config::has(const std::string& section, const std::string& key) const
{
  return this->section(section).count(key) != 0;
}

std::optional<std::string> Config::text(const std::string& section, const std::string& key) const
{
  const Section& values = this->section(section);
  const auto found = values.find(key);
  return found == values.end() ? std::nullopt : std::optional<std::string>(found->second.text);
}

const Config::Section& Config::section(const std::string& name) const
{
  static const Section none;
  const auto found = sections_.find(name);
  return found == sections_.end() ? none : found->second;
}

std::vector<std::string> Config::sectionNames() const
{
  std::vector<std::string> names;
  for (const auto& [name, origin] : section_origin_)
  {
    names.push_back(name);
  }
  return names;
}

void Config::requireKnownSections(const std::vector<std::string>& known) const
{
  for (const auto& [name, origin] : section_origin_)
  {
    if (std::find(known.begin(), known.end(), name) == known.end())
    {
      const Section& keys = section(name);
      const bool has_one_key = keys.size() == 1;
      // Several programs share sections with dyslam: there the known ones say more than its name.
      const std::string program = programOfSection(name);
      const std::string owner = program == "dyslam" ? "" : program;
      const std::string what = owner.empty() ? "unknown section '" + name + "'"
                                             : "the section [" + name + "] belongs to " + owner;
      throw UnknownSetting(origin + ": " + what, owner.empty() ? meantWord(name, known) : "",
                           {name, has_one_key ? keys.begin()->first : "",
                            has_one_key ? keys.begin()->second : Value{}});
    }
  }
}

void Config::requireSectionsFor(const std::string& program) const
{
  for (const auto& [name, origin] : section_origin_)
  {
    const std::string owner = programOfSection(name);
    // "dyslam-train" has what all of its commands have.
    if (!owner.empty() && (program + " ").rfind(owner + " ", 0) != 0)
    {
      throw UserError(origin + ": the section [" + name + "] belongs to " + owner + ", not to " +
                      program);
    }
  }
}

std::string programOfSection(const std::string& section)
{
  std::istringstream of_dyslam(sections_of_dyslam);
  const std::istream_iterator<std::string> end;
  if (std::find(std::istream_iterator<std::string>(of_dyslam), end, section) != end)
  {
    return "dyslam";
  }
  constexpr std::array<std::pair<const char*, const char*>, 8> programs = {
      {{"augmentation", "dyslam-train"},
       {"data", "dyslam-train dylo"},
       {"grid", "dyslam-train dyseg"},
       {"loss", "dyslam-train"},
       {"map_export", "dyslam-map"},
       {"merge", "dyslam-map"},
       {"network", "dyslam-train"},
       {"train", "dyslam-train"}}};
  const auto* found = std::find_if(programs.begin(), programs.end(),
                                   [&](const auto& program) { return section == program.first; });
  return found == programs.end() ? "" : found->second;
}

std::string Config::toIni() const
{
  std::ostringstream out;
  for (const auto& section : section_order_)
  {
    out << (out.tellp() > 0 ? "\n" : "") << "[" << section << "]\n";
    for (const auto& key : key_order_.at(section))
    {
      const Value& value = sections_.at(section).at(key);
      out << key << " = " << value.text;
      if (!value.comment.empty())
      {
        out << "  // " << value.comment;
      }
      out << "\n";
    }
  }
  return out.str();
}

UnknownSetting::UnknownSetting(const std::string& what, const std::string& advice, Unknown unknown)
    : UserError(what + advice), what_(what), unknown_(std::move(unknown))
{
}

UserError UnknownSetting::withSectionsOf(const Config& known) const
{
  const auto& [unknown_section, key, value] = unknown_;
  std::vector<std::string> sections;
  for (const std::string& name : known.sectionNames())
  {
    if (known.has(name, key))
    {
      sections.push_back(name);
    }
  }
  const bool is_mistyped = !unknown_section.empty() &&
                           known.has(nearestWord(unknown_section, known.sectionNames()), key);
  if (sections.empty() || is_mistyped)
  {
    return UserError(what());
  }
  const bool is_assigned = value.origin.rfind(set_flag, 0) == 0;
  return UserError(what_ + "; '" + key + "' is a key of [" + joined(sections, "], [") + "]" +
                   (is_assigned && sections.size() == 1
                        ? ": " + (set_flag + sections.front()) + "." + key + "=" + value.text
                        : ""));
}

bool isAboutSettings(const std::string& message, const std::string& ini)
{
  return message.rfind(set_flag, 0) == 0 ||
         (!ini.empty() && message.rfind(nameOfFile(ini) + ":", 0) == 0);
}
}  // namespace dyslam
