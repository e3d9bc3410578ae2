// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <torch/serialize.h>
#include <torch/torch.h>

#include <string>

namespace dyslam
{
/** Checksum (FNV-1a, 16 hexadecimal digits) of the names and values of all weights.
 * \param stored_as type in which the values are stored. */
[[nodiscard]] std::string checksumOf(const torch::nn::Module& network,
                                     torch::Dtype stored_as = torch::kFloat);

/** Stores a checksum in the archive. */
void writeChecksum(const std::string& checksum, torch::serialize::OutputArchive& archive);

/** Detects damaged weights, which torch loads silently. \param network with the weights of the
 * archive \throws UserError naming the file if the checksum differs or a weight is not finite.
 * Archives without a checksum are accepted. */
void verifyChecksum(const torch::nn::Module& network,
                    torch::serialize::InputArchive& archive,
                    const std::string& file);
}  // namespace dyslam
