// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/Bag.h>

#include <cstddef>
#include <functional>
#include <string>

#include "conversion/ScanSink.h"

namespace dyslam
{
/** Names of a bag's topics that `wanted` takes: "/a, /b". */
[[nodiscard]] std::string namesOf(const Bag& bag,
                                  const std::function<bool(const BagTopic&)>& wanted);

/** Position of the topic that an option names.
 * \throws UserError if the bag has none of this name that `wanted` takes; it names those it has. */
[[nodiscard]] std::size_t topicNamed(const std::string& input,
                                     const Bag& bag,
                                     const std::string& option,
                                     const std::string& name,
                                     const std::function<bool(const BagTopic&)>& wanted);

/** Position of the topic of the scans: the one that is asked for, or the most likely lidar, with a
 * note or warning of other topics of scans.
 * \throws UserError if the bag has no such topic. */
[[nodiscard]] std::size_t scanTopic(const std::string& input,
                                    Bag& bag,
                                    const ScanConverterOptions& options,
                                    ScanSink& sink);
}  // namespace dyslam
