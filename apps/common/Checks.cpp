// SPDX-License-Identifier: BSD-3-Clause
#include "Checks.h"

#include <dyslam/base/Error.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/formats/RecordingKind.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace dyslam
{
CLI::Validator numberThatIs(const std::string& name,
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

CLI::Validator notNegative()
{
  return numberThatIs("NONNEGATIVE", "of 0 or more", [](double v) { return v >= 0; });
}

CLI::Validator positive()
{
  return numberThatIs("POSITIVE", "above 0", [](double v) { return v > 0; });
}

void requireWritable(const std::string& file)
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

void requireNewRecording(const std::string& rawlog, bool force)
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

void requireConverted(const std::string& input)
{
  const std::string advice = conversionAdvice(input);
  if (!advice.empty())
  {
    throw UserError(input + ": " + advice);
  }
}

void requireOneOrEach(const std::string& flag,
                      std::size_t values,
                      std::size_t files,
                      const std::string& things)
{
  if (values != 1 && values != files)
  {
    throw UserError(flag + " has " + std::to_string(values) + " values; give one for all " +
                    things + ", or one for each of the " + std::to_string(files));
  }
}

void requireDifferent(const std::string& option, std::vector<std::string> words)
{
  std::sort(words.begin(), words.end());
  const auto twice = std::adjacent_find(words.begin(), words.end());
  if (twice != words.end())
  {
    throw UserError(option + ": '" + *twice + "' is given twice");
  }
}
}  // namespace dyslam
