// SPDX-License-Identifier: BSD-3-Clause
// Options that name what a program writes: they are declared here, so that no input is replaced.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace dyslam
{
CLI::Option* markedAsOutputFile(CLI::Option* option);
CLI::Option* markedAsOutputFolder(CLI::Option* option);

/** An option that names one or several files to write: none may be an input, too, or be given
 * twice. */
template <typename Value>
CLI::Option* addOutputFile(CLI::App& app,
                           const std::string& names,
                           Value& value,
                           const std::string& help)
{
  return markedAsOutputFile(app.add_option(names, value, help));
}

/** An option that names a folder to write into, which may be that of others. */
template <typename Value>
CLI::Option* addOutputFolder(CLI::App& app,
                             const std::string& names,
                             Value& value,
                             const std::string& help)
{
  return markedAsOutputFolder(app.add_option(names, value, help));
}

/** \throws UserError if a file that the program is to write is given as an input, too, or given
 * twice. */
void requireOutputsApart(CLI::App& app);
}  // namespace dyslam
