// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Config.h>
#include <dyslam/core/Error.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace dyslam
{
namespace
{
std::string trimmed(const std::string& text)
{
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string::npos)
  {
    return {};
  }
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/** Cuts what follows " //" (or a line that opens with it). */
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

Config Config::fromFile(const std::string& path)
{
  if (!std::filesystem::is_regular_file(path))
  {
    throw UserError(path + ": no such config file; give an existing .ini with --config");
  }
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  if (!file)
  {
    throw UserError(path + ": the config file cannot be read; check its permissions");
  }
  return fromText(text.str(), std::filesystem::path(path).filename().string());
}

Config Config::fromText(const std::string& text, const std::string& name)
{
  Config config;
  const std::string mark = "\xEF\xBB\xBF";  // that some editors begin a file with
  std::istringstream lines(text.rfind(mark, 0) == 0 ? text.substr(mark.size()) : text);
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
      if (line.back() != ']' || line.size() < 3)
      {
        throw UserError(origin + ": '" + line + "' is not a section; write [name]");
      }
      section = trimmed(line.substr(1, line.size() - 2));
      config.section_origin_.emplace(section, origin);
      continue;
    }
    const auto equals = line.find('=');
    const std::string key = trimmed(line.substr(0, equals));
    if (equals == std::string::npos || key.empty())
    {
      throw UserError(origin + ": '" + line + "' is not a setting; write key = value");
    }
    if (section.empty())
    {
      throw UserError(origin + ": key '" + key + "' stands before the first [section]");
    }
    if (config.has(section, key))
    {
      throw UserError(origin + ": [" + section + "] " + key + " is given twice; the first is at " +
                      config.section(section).at(key).origin);
    }
    config.set(section, key, {trimmed(line.substr(equals + 1)), origin, {}});
  }
  return config;
}

void Config::set(const std::string& assignment)
{
  const auto equals = assignment.find('=');
  const auto dot = assignment.find('.');
  if (equals == std::string::npos || dot == std::string::npos || dot > equals || dot == 0 ||
      dot + 1 == equals)
  {
    throw UserError("--set " + assignment + ": write --set section.key=value");
  }
  const std::string section = trimmed(assignment.substr(0, dot));
  const std::string key = trimmed(assignment.substr(dot + 1, equals - dot - 1));
  set(section, key, {trimmed(assignment.substr(equals + 1)), "--set " + section + "." + key, {}});
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
      const std::string near = nearestWord(name, known);
      throw UserError(origin + ": unknown section [" + name + "]" +
                      (near.empty() ? "" : "; did you mean [" + near + "]?"));
    }
  }
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
}  // namespace dyslam
