// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/RawlogSource.h>

#include <optional>
#include <string>
#include <vector>

#include "MapBuilder.h"

namespace CLI
{
class App;
}

namespace dyslam
{
/** What dyslam-map is asked to do. */
struct Arguments
{
  std::string rawlog;
  std::string trajectory;
  std::string config;
  std::vector<std::string> assignments;
  std::vector<std::string> outputs;
  MapBuilderOptions builder;
  RawlogSourceOptions source;
  MapExportOptions exports;
  std::string labelled_map;
  std::optional<double> keyframe_distance;
  bool quiet = false;
};

void declare(CLI::App& app, Arguments& a);
/** Reads our sections of the ini; an ini of a whole run may hold others. \throws UserError. */
void loadConfig(Arguments& a);
/** Finds bad endings, folders and flags before the work starts. \throws UserError. */
void checkOutputs(const Arguments& a);
}  // namespace dyslam
