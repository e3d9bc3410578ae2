// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/eval/Table.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace dyslam
{
/** The files every command can write beside what it prints. */
struct OutputFlags
{
  std::string json;
  std::string csv;

  void declare(CLI::App& app);
  /** Prints the table and writes the files that were asked for. */
  void put(const Table& table, const std::string& json_text) const;
};

/** Names for files in a table: as little of each path as tells them apart. */
[[nodiscard]] std::vector<std::string> shortNames(const std::vector<std::string>& paths);
}  // namespace dyslam
