// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace dyslam::fuzz
{
/** A function that reads a file of others. */
struct Parser
{
  const char* name;                       //!< name of the fuzzer, and of its folder in corpus/
  const char* file;                       //!< file name of the input: readers go by the extension
  void (*read)(const std::string& path);  //!< \throws UserError for a bad file, and nothing else
};

[[nodiscard]] const std::vector<Parser>& parsers();
/** The parser of that name. \throws std::out_of_range. */
[[nodiscard]] const Parser& parserNamed(const std::string& name);
}  // namespace dyslam::fuzz
