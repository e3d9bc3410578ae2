// SPDX-License-Identifier: BSD-3-Clause
// Options that name what a program writes: they are declared here, so that no input is replaced.
#pragma once

#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

namespace dyslam
{
namespace output_marks
{
// Names of checks that accept everything: CLI11's options have no other place for a mark.
constexpr const char* file = "output file";
constexpr const char* folder = "output folder";
}  // namespace output_marks

inline CLI::Option* markedAsOutput(CLI::Option* option, const char* mark)
{
  return option->check([](const std::string&) { return std::string(); }, "", mark);
}

/** An option that names one or several files to write: none may be an input, too, or be given
 * twice. */
template <typename Value>
CLI::Option* addOutputFile(CLI::App& app,
                           const std::string& names,
                           Value& value,
                           const std::string& help)
{
  return markedAsOutput(app.add_option(names, value, help), output_marks::file);
}

/** An option that names a folder to write into, which may be that of others. */
template <typename Value>
CLI::Option* addOutputFolder(CLI::App& app,
                             const std::string& names,
                             Value& value,
                             const std::string& help)
{
  return markedAsOutput(app.add_option(names, value, help), output_marks::folder);
}

inline bool hasOutputMark(CLI::Option& option, const char* mark)
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
inline bool namesFile(const std::string& word, const std::string& file)
{
  const auto equals = word.find('=');
  return isSamePath(word, file) ||
         (equals != std::string::npos && isSamePath(word.substr(equals + 1), file));
}

/** \throws UserError if one of the inputs is the file `output`. */
inline void requireNotAmong(const std::vector<CLI::Option*>& inputs,
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
inline void requireDifferent(const std::vector<OutputFile>& files)
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

/** \throws UserError if a file that the program is to write is given as an input, too, or given
 * twice. */
inline void requireOutputsApart(CLI::App& app)
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
