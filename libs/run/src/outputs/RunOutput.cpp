// SPDX-License-Identifier: BSD-3-Clause
#include "RunOutput.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Words.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <utility>

namespace dyslam
{
RunOutput::RunOutput(const RunOutputContext& context, std::vector<OutputName> names)
    : folder_(context.settings.output_folder), names_(std::move(names))
{
}

RunOutput::~RunOutput() = default;

std::string RunOutput::path(const std::string& name) const
{
  if (std::none_of(names_.begin(), names_.end(),
                   [&](const OutputName& known) { return known.name == name; }))
  {
    throw std::logic_error(name + ": is not among the names of its output");
  }
  return (std::filesystem::path(folder_) / name).string();
}

void RunOutput::eachByItself(const std::vector<std::function<void()>>& writers)
{
  std::string failures;
  for (const auto& write : writers)
  {
    try
    {
      write();
    }
    catch (const std::exception& error)
    {
      appendWord(failures, error.what(), "; ");
    }
  }
  if (!failures.empty())
  {
    throw UserError(failures);
  }
}
}  // namespace dyslam
