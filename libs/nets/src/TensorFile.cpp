// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/Printable.h>
#include <dyslam/nets/TensorFile.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>
#include <utility>
#include <vector>

namespace dyslam
{
namespace
{
using Json = nlohmann::json;

constexpr const char* metadata = "__metadata__";
constexpr const char* checksum = "checksum";
constexpr std::size_t length_bytes = 8;  // bytes of the header's length, little-endian
constexpr std::uint64_t max_header = 16U << 20U;

const std::array<std::pair<const char*, torch::Dtype>, 4> types{{{"F16", torch::kFloat16},
                                                                 {"F32", torch::kFloat32},
                                                                 {"F64", torch::kFloat64},
                                                                 {"I64", torch::kInt64}}};

std::string nameOf(torch::Dtype type)
{
  for (const auto& [name, known] : types)
  {
    if (known == type)
    {
      return name;
    }
  }
  throw std::invalid_argument("TensorFile: unsupported type of tensor");
}

bool typeOf(const std::string& name, torch::Dtype& type)
{
  for (const auto& [known, known_type] : types)
  {
    if (name == known)
    {
      type = known_type;
      return true;
    }
  }
  return false;
}

/** FNV-1a, 64 bits. */
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
  void add(const std::string& text) { add(text.c_str(), text.size() + 1); }
  [[nodiscard]] std::string text() const
  {
    return formatted("%016llx", static_cast<unsigned long long>(state_));
  }

 private:
  std::uint64_t state_ = 0xCBF29CE484222325ULL;
};

std::string checksumOf(const std::map<std::string, std::string>& texts,
                       const std::map<std::string, torch::Tensor>& tensors)
{
  Fnv1a sum;
  for (const auto& [name, text] : texts)
  {
    sum.add(name);
    sum.add(text);
  }
  for (const auto& [name, tensor] : tensors)
  {
    sum.add(name);
    sum.add(tensor.data_ptr(), tensor.nbytes());
  }
  return sum.text();
}

/** Reads a tensor by its entry in the header. \return false if the entry is invalid or exceeds the
 * values */
bool readTensor(const Json& entry, const std::string& values, torch::Tensor& tensor)
{
  torch::Dtype type = torch::kFloat;
  if (!typeOf(entry.at("dtype").get<std::string>(), type))
  {
    return false;
  }
  const auto shape = entry.at("shape").get<std::vector<std::int64_t>>();
  const auto range = entry.at("data_offsets").get<std::vector<std::uint64_t>>();
  if (range.size() != 2 || range[0] > range[1] || range[1] > values.size())
  {
    return false;
  }
  const std::uint64_t bytes = range[1] - range[0];
  std::uint64_t expected = torch::elementSize(type);
  for (const std::int64_t size : shape)
  {
    if (size < 1 || expected > bytes / static_cast<std::uint64_t>(size))
    {
      return false;
    }
    expected *= static_cast<std::uint64_t>(size);
  }
  if (expected != bytes)
  {
    return false;
  }
  tensor = torch::empty(shape, type);
  std::memcpy(tensor.data_ptr(), values.data() + range[0], bytes);
  return true;
}
}  // namespace

TensorFile::TensorFile(const std::string& path) : path_(path)
{
  const std::string content = readWhole(path, "give a file of weights");
  std::uint64_t length = 0;
  if (content.size() >= length_bytes)
  {
    std::memcpy(&length, content.data(), length_bytes);
  }
  const UserError foreign(path + ": is no file of weights in the safetensors format");
  if (length < 2 || length > max_header || length > content.size() - length_bytes)
  {
    throw foreign;
  }
  const std::string values = content.substr(length_bytes + length);
  try
  {
    const Json header = Json::parse(content.begin() + length_bytes,
                                    content.begin() + static_cast<std::ptrdiff_t>(length_bytes) +
                                        static_cast<std::ptrdiff_t>(length));
    if (!header.is_object())
    {
      throw foreign;
    }
    for (const auto& [name, entry] : header.items())
    {
      if (name == metadata)
      {
        texts_ = entry.get<std::map<std::string, std::string>>();
      }
      else if (!readTensor(entry, values, tensors_[name]))
      {
        throw UserError(path + ": " + name + " is damaged; copy the file again");
      }
    }
  }
  catch (const Json::exception&)
  {
    throw foreign;
  }
  const std::string stored = text(checksum);
  texts_.erase(checksum);
  if (!stored.empty() && stored != checksumOf(texts_, tensors_))
  {
    throw UserError(path + ": is damaged; copy the file again or train it again");
  }
}

void TensorFile::write(const std::string& path) const
{
  Json header = Json::object();
  header[metadata] = texts_;
  header[metadata][checksum] = checksumOf(texts_, tensors_);
  std::uint64_t offset = 0;
  for (const auto& [name, tensor] : tensors_)
  {
    header[name] = {{"dtype", nameOf(tensor.scalar_type())},
                    {"shape", tensor.sizes().vec()},
                    {"data_offsets", {offset, offset + tensor.nbytes()}}};
    offset += tensor.nbytes();
  }
  std::string text = header.dump();
  text.resize((text.size() + length_bytes - 1) / length_bytes * length_bytes, ' ');
  const std::uint64_t length = text.size();
  writeWhole(path,
             [&](std::ostream& out)
             {
               out.write(reinterpret_cast<const char*>(&length), length_bytes);
               out << text;
               for (const auto& [name, tensor] : tensors_)
               {
                 out.write(static_cast<const char*>(tensor.data_ptr()),
                           static_cast<std::streamsize>(tensor.nbytes()));
               }
             });
}

std::string TensorFile::text(const std::string& name) const
{
  const auto found = texts_.find(name);
  return found != texts_.end() ? found->second : std::string();
}

void TensorFile::set(const std::string& name, const torch::Tensor& tensor)
{
  const torch::NoGradGuard no_grad;
  (void)nameOf(tensor.scalar_type());
  tensors_[name] = tensor.detach().to(torch::kCPU, tensor.scalar_type(), false, true).contiguous();
}

const torch::Tensor& TensorFile::tensor(const std::string& name) const
{
  const auto found = tensors_.find(name);
  if (found == tensors_.end())
  {
    throw UserError(path_ + ": lacks " + name + "; it is of another network or version");
  }
  return found->second;
}

void TensorFile::setWeights(const std::string& prefix,
                            const torch::nn::Module& network,
                            torch::Dtype stored_as)
{
  for (const auto& weight : network.named_parameters())
  {
    set(prefix + weight.key(), weight.value().detach().to(stored_as));
  }
}

void TensorFile::loadWeights(const std::string& prefix, torch::nn::Module& network) const
{
  const torch::NoGradGuard no_grad;
  auto weights = network.named_parameters();
  for (const auto& [name, stored] : tensors_)
  {
    if (name.rfind(prefix, 0) == 0 && weights.find(name.substr(prefix.size())) == nullptr)
    {
      throw UserError(path_ + ": has " + name +
                      ", which the network has not; it is of another network or version");
    }
  }
  for (auto& weight : weights)
  {
    const torch::Tensor& stored = tensor(prefix + weight.key());
    if (stored.sizes() != weight.value().sizes())
    {
      throw UserError(path_ + ": " + prefix + weight.key() + " is of a network of another size");
    }
    if (!stored.isfinite().all().item<bool>())
    {
      throw UserError(path_ + ": " + prefix + weight.key() +
                      " holds values that are not finite; train it again");
    }
    weight.value().copy_(stored);
  }
}
}  // namespace dyslam
