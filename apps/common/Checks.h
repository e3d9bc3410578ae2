// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Words.h>

#include <CLI/CLI.hpp>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace dyslam
{
/** A finite number for which `good` holds. CLI11's own checks name the whole range of doubles.
 * \param name as --help shows it. \param wanted for the message: "0 or more". */
CLI::Validator numberThatIs(const std::string& name,
                            const std::string& wanted,
                            bool (*good)(double));

CLI::Validator notNegative();

CLI::Validator positive();

/** \throws UserError unless a flag has one value for all files, or one for each. \param things what
 * the files are, for the message: "trajectories" */
void requireOneOrEach(const std::string& flag,
                      std::size_t values,
                      std::size_t files,
                      const std::string& things);

/** The value of a flag for one of several files: the only one, or that of the file. */
template <typename Value>
const Value& oneOrEach(const std::vector<Value>& values, std::size_t file)
{
  return values.at(values.size() == 1 ? 0 : file);
}

/** \throws UserError if a word is given twice to an option whose words are averaged over */
void requireDifferent(const std::string& option, std::vector<std::string> words);

/** Maps an option's word to its enumerator; no other word is accepted. */
template <typename Enum>
CLI::Validator wordFor(const std::map<std::string, Enum>& words)
{
  return {[words](std::string& text) -> std::string
          {
            const auto found = words.find(text);
            if (found != words.end())
            {
              text = std::to_string(static_cast<int>(found->second));
              return "";
            }
            std::vector<std::string> known;
            for (const auto& [word, value] : words)
            {
              known.push_back(word);
            }
            return unknownWord("word", text, known);
          },
          ""};
}

/** \throws UserError unless a file of that name could be written, as far as its folder shows. */
void requireWritable(const std::string& file);

/** \param force an earlier recording and its ground truth may be replaced
 * \throws UserError unless the recording to be written is a .rawlog and, without `force`, not there
 * yet. */
void requireNewRecording(const std::string& rawlog, bool force);

/** \throws UserError for a recording that the converters would make a rawlog of. */
void requireConverted(const std::string& input);
}  // namespace dyslam
