// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace dyslam::fuzz
{
/** Something that reads a file which others wrote. */
struct Parser
{
  const char* name;                       //!< of the fuzzer, and of its folder in corpus/
  const char* file;                       //!< what the input is called: readers go by the ending
  void (*read)(const std::string& path);  //!< \throws UserError for a bad file, and nothing else
};

[[nodiscard]] const std::vector<Parser>& parsers();
/** \throws std::out_of_range. */
[[nodiscard]] const Parser& parserNamed(const std::string& name);
}  // namespace dyslam::fuzz
