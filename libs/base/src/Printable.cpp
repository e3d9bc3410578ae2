// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>

#include <algorithm>
#include <cctype>
#include <cstdarg>
#include <cstdio>

namespace dyslam
{
std::string printable(std::string text)
{
  constexpr std::size_t longest = 500;
  if (text.size() > longest)
  {
    text = text.substr(0, longest) + "...";
  }
  for (std::size_t i = 0; i < text.size(); ++i)
  {
    const auto byte = static_cast<unsigned char>(text[i]);
    // In UTF-8, C2 80 to C2 9F are control characters, too: C2 9B does what ESC [ does.
    const bool high = byte == 0xC2U && i + 1 < text.size() &&
                      (static_cast<unsigned char>(text[i + 1]) & 0xE0U) == 0x80U;
    if (byte < 0x20U || byte == 0x7FU || high)
    {
      text[i] = '?';
    }
    if (high)
    {
      text.erase(i + 1, 1);
    }
  }
  return text;
}

std::string formatted(const char* format, ...)
{
  std::va_list values;
  va_start(values, format);
  std::va_list again;
  va_copy(again, values);
  const int size = std::vsnprintf(nullptr, 0, format, values);
  va_end(values);
  std::string text(static_cast<std::size_t>(std::max(0, size)), '\0');
  std::vsnprintf(text.data(), text.size() + 1, format, again);
  va_end(again);
  return text;
}

std::string lowered(std::string text)
{
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string escapedHtml(const std::string& text)
{
  std::string result;
  for (const char c : text)
  {
    switch (c)
    {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

bool isNestedDeeper(std::string_view json, std::size_t limit)
{
  std::size_t depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < json.size(); ++i)
  {
    const char c = json[i];
    if (quoted)
    {
      i += c == '\\' ? 1 : 0;
      quoted = c != '"';
    }
    else if (c == '"')
    {
      quoted = true;
    }
    else if ((c == '[' || c == '{') && ++depth > limit)
    {
      return true;
    }
    else if ((c == ']' || c == '}') && depth > 0)
    {
      --depth;
    }
  }
  return false;
}

std::string shellWord(const std::string& text)
{
  constexpr const char* special = " \t\n\"'$`\\!*?[](){}<>|&;#~^";
  if (!text.empty() && text.find_first_of(special) == std::string::npos)
  {
    return text;
  }
  std::string quoted = "'";
  for (const char c : text)
  {
    quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return quoted + "'";
}

std::string csvField(const std::string& text)
{
  if (text.find_first_of(",\"\r\n") == std::string::npos)
  {
    return text;
  }
  std::string quoted = "\"";
  for (const char c : text)
  {
    quoted += c;
    if (c == '"')
    {
      quoted += c;
    }
  }
  return quoted + '"';
}
}  // namespace dyslam
