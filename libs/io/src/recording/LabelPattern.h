// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <regex>
#include <string>

namespace dyslam
{
/** An option that selects sensors by a regular expression for their label. */
class LabelPattern
{
 public:
  static constexpr std::size_t longest = 256;  //!< of patterns and labels [characters]

  /** \param option its key, for messages \param pattern empty: every label
   * \throws UserError if it is no regular expression, or a very long one. */
  LabelPattern(const std::string& option, const std::string& pattern);

  /** Whether the whole label fits. Very long labels fit the empty pattern only. */
  [[nodiscard]] bool fits(const std::string& label) const;
  [[nodiscard]] const std::string& option() const { return option_; }
  [[nodiscard]] const std::string& pattern() const { return pattern_; }

 private:
  std::string option_;
  std::string pattern_;
  std::regex compiled_;
};

/** Regular expression for one label. */
[[nodiscard]] std::string patternFor(const std::string& label);
}  // namespace dyslam
