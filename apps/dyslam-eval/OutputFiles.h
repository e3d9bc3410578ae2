// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/eval/Table.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** Output files of a command, in addition to the printed table. */
struct OutputFlags
{
  std::string json;
  std::string csv;
  std::string markdown;

  void declare(CLI::App& app);
  /** Prints the table and writes the requested files. */
  void write(const Table& table, const std::string& json_text) const;
};

/** Prints "note: " and the text on stderr. */
void printNote(const std::string& text);

/** Writes an encoded picture. \throws UserError. */
void writePng(const std::string& path, const std::vector<std::uint8_t>& png);

/** Shortest unambiguous names of files, without extension, and of folders for a table. */
[[nodiscard]] std::vector<std::string> shortNames(const std::vector<std::string>& paths);
}  // namespace dyslam
