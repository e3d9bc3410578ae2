// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace dyslam
{
/** One subcommand of dyslam-eval: its parser and the function to run once it was parsed. Each one
 * has its own file and is listed in main.cpp. */
struct Subcommand
{
  CLI::App* parser = nullptr;
  std::function<void()> run;
};
}  // namespace dyslam
