// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

namespace dyslam
{
/** The text as one line for a terminal: control characters, which could move the cursor, are
 * replaced by `?`, and long texts are cut. */
[[nodiscard]] std::string printable(std::string text);

/** The text with ASCII capitals in lower case. */
[[nodiscard]] std::string lowered(std::string text);

/** Length of the common prefix of two texts. */
[[nodiscard]] inline std::size_t commonPrefix(std::string_view a, std::string_view b)
{
  std::size_t length = 0;
  while (length < std::min(a.size(), b.size()) && a[length] == b[length])
  {
    ++length;
  }
  return length;
}

/** Text with numbers, as of std::printf. */
[[nodiscard, gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

/** Number and noun for messages: "1 pose", "2 poses". */
[[nodiscard]] inline std::string counted(std::size_t count, const std::string& noun)
{
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

/** The text escaped for HTML, also for attributes in double quotes. */
[[nodiscard]] std::string escapedHtml(const std::string& text);

/** Whether brackets in this JSON text are nested deeper than `limit`: recursion over the parsed
 * value would overflow the stack. Does not check that the text is JSON. */
[[nodiscard]] bool isNestedDeeper(std::string_view json, std::size_t limit = 64);

/** The text as one word of a shell command: in single quotes where needed. */
[[nodiscard]] std::string shellWord(const std::string& text);

/** A field of a CSV file, in quotes where needed (RFC 4180). */
[[nodiscard]] std::string csvField(const std::string& text);
}  // namespace dyslam
