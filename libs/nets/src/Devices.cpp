// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/nets/Devices.h>
#include <torch/torch.h>

namespace dyslam
{
torch::Device deviceNamed(const std::string& name, const std::string& setting)
{
  if (name != "cpu" && name != "cuda")
  {
    throw UserError(setting + " " + name + ": choose cpu or cuda");
  }
  if (name == "cuda" && !torch::cuda::is_available())
  {
    throw UserError(setting + " cuda: this machine or this libtorch has no CUDA; use cpu");
  }
  if (name == "cpu")
  {
    return torch::kCPU;
  }
  // CUDA's linear algebra is loaded at its first use, which two threads must not do at a time.
  torch::linalg_eigh(torch::eye(2, torch::kCUDA));
  return torch::kCUDA;
}
}  // namespace dyslam
