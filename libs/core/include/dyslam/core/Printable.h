// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

namespace dyslam
{
/** The text for a terminal, on one line: `?` for control characters, whose codes would move the
 * cursor or worse, and cut at a limit. */
[[nodiscard]] std::string printable(std::string text);

/** With small ASCII letters for capitals. */
[[nodiscard]] std::string lowered(std::string text);

/** Number of characters that both begin with. */
[[nodiscard]] inline std::size_t commonPrefix(std::string_view a, std::string_view b)
{
  std::size_t length = 0;
  while (length < std::min(a.size(), b.size()) && a[length] == b[length])
  {
    ++length;
  }
  return length;
}

/** For messages: "1 pose", "2 poses". */
[[nodiscard]] inline std::string counted(std::size_t count, const std::string& noun)
{
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

/** The text for a page or an attribute of HTML in double quotes. */
[[nodiscard]] std::string escapedHtml(const std::string& text);

/** Whether brackets in this JSON text are nested deeper than `limit`: recursion over the parsed
 * value would overflow the stack. Does not check that the text is JSON. */
[[nodiscard]] bool isNestedDeeper(std::string_view json, std::size_t limit = 64);

/** A field of a CSV file, in quotes where needed (RFC 4180). */
[[nodiscard]] std::string csvField(const std::string& text);
}  // namespace dyslam
