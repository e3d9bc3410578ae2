// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace dyslam
{
/** Whether a help text can be understood without the help texts before it. */
inline bool readsAlone(const std::string& help)
{
  for (const char* start :
       {"...", "its ", "their ", "the same", "of ", "or ", "and ", "as ", "between ", " ("})
  {
    if (help.rfind(start, 0) == 0)
    {
      return false;
    }
  }
  return !help.empty();
}

/** Lines of an effective ini whose help text cannot be read alone, or equals that of an earlier key
 * of the section. */
inline std::vector<std::string> unclearHelpTexts(const std::string& effective_ini)
{
  const std::string mark = "  // ";
  std::vector<std::string> unclear;
  std::set<std::string> of_section;
  std::string section;
  std::istringstream lines(effective_ini);
  for (std::string line; std::getline(lines, line);)
  {
    if (line.empty() || line.front() == '[')
    {
      section = line.empty() ? section : line;
      of_section.clear();
      continue;
    }
    const auto at = line.find(mark);
    const std::string help = at == std::string::npos ? "" : line.substr(at + mark.size());
    // In "vehicles: ..." the words after the colon are the help text of an option of a class.
    const auto space = help.find(' ');
    const bool has_class = space != std::string::npos && space > 0 && help[space - 1] == ':';
    if (!readsAlone(help) || (has_class && !readsAlone(help.substr(space + 1))) ||
        !of_section.insert(help).second)
    {
      unclear.push_back(section + " " + line);
    }
  }
  return unclear;
}

/** Digits of a decimal number without leading and trailing zeros; 0 for a whole number, such as a
 * seed, and for another text. */
inline int significantDigits(const std::string& value)
{
  double number = 0;
  std::istringstream whole(value);
  if (!(whole >> number) || !whole.eof() || value.find_first_of(".eE") == std::string::npos)
  {
    return 0;
  }
  std::string digits;
  for (const char c : value.substr(0, value.find_first_of("eE")))
  {
    if (c >= '0' && c <= '9')
    {
      digits += c;
    }
  }
  const auto first = digits.find_first_not_of('0');
  return first == std::string::npos ? 0
                                    : static_cast<int>(digits.find_last_not_of('0') - first) + 1;
}

/** Lines of an effective ini whose number has more than four significant digits: a default that was
 * converted from another unit, or rounded in another one. */
inline std::vector<std::string> longNumbers(const std::string& effective_ini)
{
  std::vector<std::string> found;
  std::string section;
  std::istringstream lines(effective_ini);
  for (std::string line; std::getline(lines, line);)
  {
    section = !line.empty() && line.front() == '[' ? line : section;
    const auto equals = line.find(" = ");
    if (equals == std::string::npos)
    {
      continue;
    }
    const auto begin = equals + 3;
    if (significantDigits(line.substr(begin, line.find("  // ") - begin)) > 4)
    {
      found.push_back(section + " " + line);
    }
  }
  return found;
}
}  // namespace dyslam
