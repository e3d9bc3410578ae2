// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Error.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/formats/RecordingKind.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>

namespace dyslam
{
/** A finite number for which `good` holds. CLI11's own checks name the whole range of doubles.
 * \param name as --help shows it. \param wanted for the message: "0 or more". */
inline CLI::Validator numberThatIs(const std::string& name,
                                   const std::string& wanted,
                                   bool (*good)(double))
{
  return {[wanted, good](std::string& text) -> std::string
          {
            double value = 0;
            const bool fits =
                CLI::detail::lexical_cast(text, value) && std::isfinite(value) && good(value);
            return fits ? "" : "'" + text + "' is not a number " + wanted;
          },
          name};
}

inline CLI::Validator notNegative()
{
  return numberThatIs("NONNEGATIVE", "of 0 or more", [](double v) { return v >= 0; });
}

inline CLI::Validator positive()
{
  return numberThatIs("POSITIVE", "above 0", [](double v) { return v > 0; });
}

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
            std::string known;
            for (const auto& [word, value] : words)
            {
              known += (known.empty() ? "" : ", ") + word;
            }
            return "'" + text + "' is none of " + known;
          },
          ""};
}

/** \throws UserError unless a file of that name could be written, as far as its folder shows. */
inline void requireWritable(const std::string& file)
{
  const auto folder = std::filesystem::path(file).parent_path();
  if (std::filesystem::is_directory(file))
  {
    throw UserError(file + ": is a folder; name the file to write");
  }
  std::error_code ignored;
  if (std::filesystem::exists(folder.empty() ? "." : folder, ignored) &&
      ::access(folder.empty() ? "." : folder.c_str(), W_OK) != 0)
  {
    throw UserError(file + ": the folder may not be written to; choose another");
  }
}

/** \param force an earlier recording and its ground truth may be replaced
 * \throws UserError unless the recording to be written is a .rawlog and, without `force`, not there
 * yet. */
inline void requireNewRecording(const std::string& rawlog, bool force)
{
  const std::filesystem::path path(rawlog);
  if (path.extension() != ".rawlog")
  {
    throw UserError(rawlog + ": name the recording to write *.rawlog (--output)");
  }
  requireWritable(rawlog);
  const std::string truth = groundTruthFolder(rawlog);
  for (const std::string& earlier : {rawlog, truth})
  {
    if (!force && std::filesystem::exists(earlier))
    {
      throw UserError(earlier + ": is there already; choose another --output, or replace " +
                      path.filename().string() + " and its ground truth with --force");
    }
  }
}

/** \throws UserError for a recording that the converters would make a rawlog of. */
inline void requireConverted(const std::string& input)
{
  const std::string advice = conversionAdvice(input);
  if (!advice.empty())
  {
    throw UserError(input + ": " + advice);
  }
}
}  // namespace dyslam
