// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/nets/WeightsChecksum.h>

#include <cstdint>
#include <cstdio>

namespace dyslam
{
namespace
{
constexpr const char* key = "checksum";

class Fnv1a
{
 public:
  void add(const void* bytes, std::size_t count)
  {
    const auto* b = static_cast<const std::uint8_t*>(bytes);
    for (std::size_t i = 0; i < count; ++i)
    {
      state_ = (state_ ^ b[i]) * 0x100000001B3ULL;
    }
  }
  [[nodiscard]] std::string text() const
  {
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(state_));
    return digits;
  }

 private:
  std::uint64_t state_ = 0xCBF29CE484222325ULL;
};
}  // namespace

std::string checksumOf(const torch::nn::Module& network, torch::Dtype stored_as)
{
  const torch::NoGradGuard no_grad;
  Fnv1a sum;
  for (const auto& weight : network.named_parameters())
  {
    sum.add(weight.key().data(), weight.key().size());
    const torch::Tensor value = weight.value().cpu().to(stored_as).to(torch::kFloat).contiguous();
    sum.add(value.data_ptr<float>(), static_cast<std::size_t>(value.numel()) * sizeof(float));
  }
  return sum.text();
}

void writeChecksum(const std::string& checksum, torch::serialize::OutputArchive& archive)
{
  archive.write(key, c10::IValue(checksum));
}

void verifyChecksum(const torch::nn::Module& network,
                    torch::serialize::InputArchive& archive,
                    const std::string& file)
{
  c10::IValue stored;
  bool intact = !archive.try_read(key, stored) || stored.toStringRef() == checksumOf(network);
  for (const auto& weight : network.named_parameters())
  {
    intact = intact && weight.value().isfinite().all().item<bool>();
  }
  if (!intact)
  {
    throw UserError(file + ": its weights are damaged; copy the file again or train it again");
  }
}
}  // namespace dyslam
