// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/packets/PcapSource.h>

#include <memory>

#include "PacketCapture.h"

namespace dyslam
{
PcapSource::PcapSource(const std::string& path, const PcapSourceOptions& options)
    : PacketSource(std::make_unique<PacketCapture>(path), options)
{
}
}  // namespace dyslam
