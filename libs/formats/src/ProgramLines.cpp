// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <dyslam/formats/ProgramLines.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

namespace dyslam
{
namespace
{
constexpr const char* behind_name = ": ";
constexpr const char* stopped_word = "stopped ";
constexpr const char* complete_later =
    "once there is room, complete them with: dyslam --resume -o ";
constexpr const char* percent_sign = "% ";
constexpr double longest = 1e6;  // largest time left [s]

bool isDigitAt(const std::string& text, std::size_t at)
{
  return at < text.size() && std::isdigit(static_cast<unsigned char>(text[at])) != 0;
}
}  // namespace

std::string errorLine(const std::string& program, const std::string& message)
{
  return program + behind_name + printable(message);
}

std::optional<std::string> messageOfErrorLine(const std::string& program, const std::string& line)
{
  const std::string begin = program + behind_name;
  return line.rfind(begin, 0) == 0 ? std::make_optional(line.substr(begin.size())) : std::nullopt;
}

std::string stopReason(const std::string& when)
{
  return stopped_word + when;
}

std::string stoppedMessage(const std::string& input, const std::string& reason)
{
  return input + behind_name + reason;
}

bool isStoppedLine(const std::string& program, const std::string& input, const std::string& line)
{
  const auto message = messageOfErrorLine(program, line);
  return message && message->rfind(stoppedMessage(printable(input), stopped_word), 0) == 0;
}

std::string completeLaterAdvice(const std::string& folder)
{
  return complete_later + shellWord(folder);
}

bool canBeCompletedLine(const std::string& program, const std::string& line)
{
  const auto message = messageOfErrorLine(program, line);
  return message && message->find(complete_later) != std::string::npos;
}

std::string progressTitle(const std::string& program, const std::string& part)
{
  return program + (part.empty() ? "" : ", " + part);
}

std::string progressText(double fraction,
                         std::size_t count,
                         const std::string& unit,
                         double seconds,
                         const EarlierWork& earlier)
{
  const std::size_t now = count - std::min(count, earlier.count);
  const double rate = seconds > 0 ? static_cast<double>(now) / seconds : 0;
  const std::string units =
      (count == 1 ? unit.substr(0, unit.size() - 1) : unit) +
      (fraction >= 1 && earlier.count > 0 ? ", " + std::to_string(now) + " of them" : "");
  constexpr double least_rate = 0.05;  // printed as 0.1
  const std::string rate_text = rate < least_rate ? "" : formatted(", %.1f/s", rate);
  if (fraction >= 1)
  {
    return formatted("100%s%zu %s in %.1f s%s", percent_sign, count, units.c_str(), seconds,
                     rate_text.c_str());
  }
  if (fraction > earlier.fraction)
  {
    const double left_share = (1 - fraction) / (fraction - earlier.fraction);
    const long left = std::lround(std::min(seconds * left_share, longest));
    return formatted("%3.0f%s%zu %s%s, %ld:%02ld left", 100 * fraction, percent_sign, count,
                     units.c_str(), rate_text.c_str(), left / 60, left % 60);
  }
  return formatted("%zu %s%s", count, units.c_str(), rate_text.c_str());
}

ProgressState lastProgressIn(const std::string& log)
{
  for (std::size_t sign = log.rfind(percent_sign); sign != std::string::npos && sign > 0;
       sign = log.rfind(percent_sign, sign - 1))
  {
    if (isDigitAt(log, sign - 1) && isDigitAt(log, sign + 2))  // not "17 % of the points"
    {
      const auto before = log.find_last_not_of("0123456789", sign - 1);
      const std::size_t number = before == std::string::npos ? 0 : before + 1;
      const auto end_of_line = log.rfind('\n', sign);
      const std::size_t line = end_of_line == std::string::npos ? 0 : end_of_line + 1;
      const std::size_t name = log.rfind(behind_name, number);
      const bool has_name = name != std::string::npos && name >= line;
      return {has_name ? log.substr(line, name - line) : "",
              std::atof(log.substr(number).c_str()) / 100};
    }
  }
  return {};
}
}  // namespace dyslam
