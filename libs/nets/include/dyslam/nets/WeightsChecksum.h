// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <torch/serialize.h>
#include <torch/torch.h>

#include <string>

namespace dyslam
{
/** Of the names and values of all weights, as 16 hexadecimal digits (FNV-1a).
 * \param stored_as the type whose precision the values have once they are stored. */
[[nodiscard]] std::string checksumOf(const torch::nn::Module& network,
                                     torch::Dtype stored_as = torch::kFloat);

/** Stores a checksum beside the weights. */
void writeChecksum(const std::string& checksum, torch::serialize::OutputArchive& archive);

/** Torch reads over flipped bits. \param network with the weights of the archive
 * \throws UserError naming the file if they are not those that were stored, or are no numbers.
 * Archives without a checksum are taken as they are. */
void requireUndamaged(const torch::nn::Module& network,
                      torch::serialize::InputArchive& archive,
                      const std::string& file);
}  // namespace dyslam
