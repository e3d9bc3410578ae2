// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <torch/torch.h>

#include <map>
#include <string>

namespace dyslam
{
/** Named tensors and texts in a file of the safetensors format: a JSON header and plain values.
 *
 * Unlike an archive of torch it holds nothing that could run, and everything is checked against
 * the size of the file before memory is allocated. A checksum of the content is stored with it.
 * Equal content gives equal bytes.
 */
class TensorFile
{
 public:
  TensorFile() = default;
  /** \throws UserError for a file that cannot be read, is of another format or is damaged. */
  explicit TensorFile(const std::string& path);

  /** Replaces an existing file once the new one is complete. \throws UserError if it cannot be
   * written. */
  void write(const std::string& path) const;

  /** Path of the file that this was read from; empty if none. */
  [[nodiscard]] const std::string& path() const { return path_; }

  void setText(const std::string& name, const std::string& text) { texts_[name] = text; }
  /** Text of that name; empty if there is none. */
  [[nodiscard]] std::string text(const std::string& name) const;

  /** Stores a copy of a tensor on the CPU. \param tensor float16, float32, float64 or int64 */
  void set(const std::string& name, const torch::Tensor& tensor);
  [[nodiscard]] bool has(const std::string& name) const { return tensors_.count(name) != 0; }
  /** Tensor of that name. \throws UserError if there is none. */
  [[nodiscard]] const torch::Tensor& tensor(const std::string& name) const;

  /** Stores the parameters of a network, each under `prefix` and its name. */
  void setWeights(const std::string& prefix,
                  const torch::nn::Module& network,
                  torch::Dtype stored_as = torch::kFloat);
  /** Sets the parameters of a network. \throws UserError if one is missing, of another shape or not
   * finite, and if there are others with this prefix: the file is of another network. */
  void loadWeights(const std::string& prefix, torch::nn::Module& network) const;

 private:
  std::string path_;  // file that this was read from, for messages
  std::map<std::string, std::string> texts_;
  std::map<std::string, torch::Tensor> tensors_;
};
}  // namespace dyslam
