// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/system/COutputLogger.h>

#include <string>

namespace dyslam
{
/** Names a decider or optimiser, and records its messages for the engine's report instead of
 * printing them. */
template <typename Plugin>
void setUp(Plugin& plugin, const std::string& name)
{
  plugin.logging_enable_console_output = false;
  plugin.logging_enable_keep_record = true;
  plugin.setClassName(name);
}
}  // namespace dyslam
