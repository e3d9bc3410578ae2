// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace dyslam::batch
{
/** Memory that the control groups (version 2) of this process leave it: the smallest rest of its
 * group and of all groups above it, such as those of a Slurm job or a systemd slice [bytes]. File
 * cache that the kernel drops when memory is short is not counted as used. Nothing if no group has
 * a limit.
 * \param root folder that has `proc` and `sys`: `/`, except in tests */
[[nodiscard]] std::optional<std::uint64_t> memoryLeftByGroups(const std::string& root);
}  // namespace dyslam::batch
