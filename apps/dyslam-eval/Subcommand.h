// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace dyslam
{
/** One word of `dyslam-eval <word>`: its parser and what it does once parsed. Every command stands
 * in a file of its own and is listed in main.cpp. */
struct Subcommand
{
  CLI::App* parser = nullptr;
  std::function<void()> run;
};
}  // namespace dyslam
