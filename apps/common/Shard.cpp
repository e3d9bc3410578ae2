// SPDX-License-Identifier: BSD-3-Clause
#include "Shard.h"

#include <dyslam/base/Error.h>

#include <regex>

namespace dyslam
{
Shard Shard::fromText(const std::string& text)
{
  std::smatch found;
  Shard shard;
  if (std::regex_match(text, found, std::regex("([0-9]{1,9})/([0-9]{1,9})")))
  {
    shard.number = std::stoul(found.str(1));
    shard.count = std::stoul(found.str(2));
  }
  if (found.empty() || shard.number < 1 || shard.number > shard.count)
  {
    throw UserError("--shard: '" + text + "' is not K/N with K from 1 to N, as 3/20");
  }
  return shard;
}
}  // namespace dyslam
