// SPDX-License-Identifier: BSD-3-Clause
#include "OutputOptions.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>

#include <filesystem>
#include <vector>

namespace dyslam
{
namespace
{
namespace output_marks
{
// Names of checks that accept everything: CLI11's options have no other place for a mark.
constexpr const char* file = "output file";
constexpr const char* folder = "output folder";
}  // namespace output_marks

CLI::Option* markedAsOutput(CLI::Option* option, const char* mark)
{
  return option->check([](const std::string&) { return std::string(); }, "", mark);
}

bool hasOutputMark(CLI::Option& option, const char* mark)
{
  try
  {
    return option.get_validator(mark) != nullptr;
  }
  catch (const CLI::OptionNotFound&)
  {
    return false;
  }
}

/** \param word FILE or NAME=FILE */
bool namesFile(const std::string& word, const std::string& file)
{
  const auto equals = word.find('=');
  return isSamePath(word, file) ||
         (equals != std::string::npos && isSamePath(word.substr(equals + 1), file));
}

/** \throws UserError if one of the inputs is the file `output`. */
void requireNotAmong(const std::vector<CLI::Option*>& inputs,
                     const std::string& output,
                     const CLI::Option& output_option)
{
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(output, ignored))
  {
    return;
  }
  for (const CLI::Option* input : inputs)
  {
    for (const std::string& word : input->results())
    {
      if (namesFile(word, output))
      {
        throw UserError(output + ": is an input, too (" + input->get_name() + "); choose another " +
                        output_option.get_name());
      }
    }
  }
}

/** A file to write. */
struct OutputFile
{
  std::string path;
  std::string option;
};

/** \throws UserError if two of them are the same. */
void requireDifferent(const std::vector<OutputFile>& files)
{
  for (std::size_t i = 0; i < files.size(); ++i)
  {
    std::error_code ignored;
    const auto status = std::filesystem::status(files[i].path, ignored);
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    {
      continue;  // such as /dev/null
    }
    for (std::size_t j = 0; j < i; ++j)
    {
      if (isSamePath(files[i].path, files[j].path))
      {
        throw UserError(files[i].path + ": is given twice as a file to write (" + files[j].option +
                        (files[j].option == files[i].option ? "" : " and " + files[i].option) +
                        "); choose another for one of them");
      }
    }
  }
}
}  // namespace

CLI::Option* markedAsOutputFile(CLI::Option* option)
{
  return markedAsOutput(option, output_marks::file);
}

CLI::Option* markedAsOutputFolder(CLI::Option* option)
{
  return markedAsOutput(option, output_marks::folder);
}

void requireOutputsApart(CLI::App& app)
{
  std::vector<CLI::Option*> inputs;
  std::vector<CLI::Option*> outputs;
  std::vector<OutputFile> files;
  for (CLI::Option* option : app.get_options([](CLI::Option* o) { return o->count() > 0; }))
  {
    const bool is_file = hasOutputMark(*option, output_marks::file);
    const bool is_output = is_file || hasOutputMark(*option, output_marks::folder);
    (is_output ? outputs : inputs).push_back(option);
    for (const std::string& path : is_file ? option->results() : std::vector<std::string>())
    {
      files.push_back({path, option->get_name()});
    }
  }
  for (const CLI::Option* output : outputs)
  {
    for (const std::string& path : output->results())
    {
      requireNotAmong(inputs, path, *output);
    }
  }
  requireDifferent(files);
  for (CLI::App* command : app.get_subcommands())
  {
    requireOutputsApart(*command);
  }
}
}  // namespace dyslam
