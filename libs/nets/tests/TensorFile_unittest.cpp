// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/nets/TensorFile.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

namespace dyslam
{
namespace
{
class TensorFileTest : public testing::Test
{
 protected:
  void write(const std::string& bytes) const
  {
    std::ofstream(path_, std::ios::binary | std::ios::trunc) << bytes;
  }
  /** Writes a file with a header and values. */
  void write(const std::string& header, const std::string& values) const
  {
    const std::uint64_t length = header.size();
    std::string bytes(8, '\0');
    std::memcpy(&bytes[0], &length, 8);
    write(bytes + header + values);
  }
  [[nodiscard]] std::string bytes() const
  {
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  /** Error message of reading the file; empty if it is accepted. */
  [[nodiscard]] std::string refusal() const
  {
    try
    {
      const TensorFile file(path_);
      return "";
    }
    catch (const UserError& error)
    {
      return error.what();
    }
  }

  const std::string path_ = testing::TempDir() + "weights.safetensors";
};

TEST_F(TensorFileTest, RoundTrip)
{
  TensorFile file;
  file.setText("kind", "some \"kind\"\n");
  const torch::Tensor matrix = torch::rand({3, 4});
  file.set("a.matrix", matrix.t());
  file.set("half", torch::ones({2}, torch::kFloat16));
  file.set("step", torch::tensor(std::int64_t{7}, torch::kInt64));
  file.write(path_);
  const TensorFile back(path_);
  EXPECT_EQ(back.text("kind"), "some \"kind\"\n");
  EXPECT_EQ(back.text("other"), "");
  EXPECT_TRUE(torch::equal(back.tensor("a.matrix"), matrix.t()));
  EXPECT_EQ(back.tensor("half").scalar_type(), torch::kFloat16);
  EXPECT_EQ(back.tensor("step").item<std::int64_t>(), 7);
  EXPECT_FALSE(back.has("b"));
  EXPECT_THROW((void)back.tensor("b"), UserError);
  const std::string first = bytes();
  back.write(path_);
  EXPECT_EQ(bytes(), first);
}

TEST_F(TensorFileTest, WeightsOfANetwork)
{
  torch::nn::Linear layer(3, 2);
  TensorFile file;
  file.setWeights("net.", *layer);
  file.write(path_);
  torch::nn::Linear other(3, 2);
  TensorFile(path_).loadWeights("net.", *other);
  EXPECT_TRUE(torch::equal(other->weight, layer->weight));
  EXPECT_THROW(TensorFile(path_).loadWeights("other.", *other), UserError);
  torch::nn::Linear wider(4, 2);
  EXPECT_THROW(TensorFile(path_).loadWeights("net.", *wider), UserError);
  torch::nn::Linear without_bias(torch::nn::LinearOptions(3, 2).bias(false));
  EXPECT_THROW(TensorFile(path_).loadWeights("net.", *without_bias), UserError) << "a part of it";
  {
    const torch::NoGradGuard no_grad;
    layer->bias[0] = std::numeric_limits<float>::quiet_NaN();
  }
  file.setWeights("net.", *layer);
  EXPECT_THROW(file.loadWeights("net.", *other), UserError);
}

TEST_F(TensorFileTest, AFlippedBitOrAMissingEndIsNoticed)
{
  TensorFile file;
  file.set("values", torch::rand({100}));
  file.write(path_);
  const std::string whole = bytes();
  EXPECT_EQ(refusal(), "");
  std::string damaged = whole;
  damaged[damaged.size() - 50] = static_cast<char>(damaged[damaged.size() - 50] ^ 0x10);
  write(damaged);
  EXPECT_NE(refusal().find("damaged"), std::string::npos) << refusal();
  for (const std::size_t size : {std::size_t{0}, std::size_t{7}, std::size_t{40}, whole.size() - 1})
  {
    write(whole.substr(0, size));
    EXPECT_NE(refusal().find(path_), std::string::npos) << size;
  }
}

TEST_F(TensorFileTest, HeadersThatDoNotFitTheFileAreRefusedBeforeAnythingIsAllocated)
{
  const std::string values(16, 'x');
  for (const char* header :
       {"{", "[]", "{\"a\":1}", "{\"a\":{\"dtype\":\"F32\",\"shape\":[4]}}",
        R"({"a":{"dtype":"F32","shape":[5],"data_offsets":[0,16]}})",
        R"({"a":{"dtype":"F32","shape":[4],"data_offsets":[4,20]}})",
        R"({"a":{"dtype":"F32","shape":[-4],"data_offsets":[0,16]}})",
        R"({"a":{"dtype":"F32","shape":[4294967296,4294967296],"data_offsets":[0,16]}})",
        R"({"a":{"dtype":"F32","shape":[0,4],"data_offsets":[0,0]}})",
        R"({"a":{"dtype":"BOOL","shape":[16],"data_offsets":[0,16]}})",
        R"({"a":{"dtype":"F32","shape":[4],"data_offsets":[0]}})", R"({"__metadata__":{"b":1}})"})
  {
    write(header, values);
    EXPECT_NE(refusal(), "") << header;
  }
  write(R"({"a":{"dtype":"F32","shape":[2,2],"data_offsets":[0,16]}})", values);
  EXPECT_EQ(refusal(), "");
  // The header claims to be larger than the file.
  std::string bytes("\xff\xff\xff\xff\xff\xff\xff\x7f{}", 10);
  write(bytes);
  EXPECT_NE(refusal(), "");
}

/** Archives of torch can hold code that runs when they are loaded. */
TEST_F(TensorFileTest, ArchivesOfTorchAreRefused)
{
  torch::save(torch::rand({4}), path_);
  EXPECT_NE(refusal().find("safetensors"), std::string::npos) << refusal();
}

TEST_F(TensorFileTest, CannotBeWritten)
{
  EXPECT_THROW(TensorFile().write("/nowhere/weights.safetensors"), UserError);
}
}  // namespace
}  // namespace dyslam
