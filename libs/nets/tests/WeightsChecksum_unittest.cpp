// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/nets/DysegFile.h>
#include <dyslam/nets/WeightsChecksum.h>
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <sstream>

namespace dyslam
{
namespace
{
TEST(WeightsChecksum, DependsOnNamesAndValues)
{
  torch::manual_seed(1);
  torch::nn::Linear layer(3, 2);
  const std::string sum = checksumOf(*layer);
  EXPECT_EQ(sum.size(), 16U);
  EXPECT_EQ(checksumOf(*layer), sum);
  EXPECT_NE(checksumOf(*layer, torch::kFloat16), sum);
  torch::NoGradGuard no_grad;
  layer->weight[0][0] += 1e-3;
  EXPECT_NE(checksumOf(*layer), sum);
}

/** A flipped bit in the weights of a file is detected, and so are weights that are not finite. */
TEST(WeightsChecksum, RejectsDamagedFiles)
{
  torch::manual_seed(1);
  DysegNetwork network;
  network.net = DysegNet(DysegNetworkOptions());
  const std::string file = testing::TempDir() + "checksum.pt";
  saveDyseg(network, file);
  EXPECT_NO_THROW((void)loadDyseg(file));
  std::string bytes;
  {
    std::ifstream in(file, std::ios::binary);
    std::stringstream text;
    text << in.rdbuf();
    bytes = text.str();
  }
  // The largest weights fill most of the file.
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x10);
  std::ofstream(file, std::ios::binary) << bytes;
  try
  {
    (void)loadDyseg(file);
    FAIL() << "a damaged file was accepted";
  }
  catch (const UserError& error)
  {
    EXPECT_NE(std::string(error.what()).find("checksum.pt"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("damaged"), std::string::npos) << error.what();
  }
  {
    torch::NoGradGuard no_grad;
    network.net->parameters()[3].fill_(std::numeric_limits<float>::quiet_NaN());
  }
  saveDyseg(network, file);
  EXPECT_THROW((void)loadDyseg(file), UserError);
}
}  // namespace
}  // namespace dyslam
