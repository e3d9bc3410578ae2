// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for train only.
#pragma once

#include <dyslam/base/Parallel.h>
#include <torch/torch.h>

#include <cstddef>
#include <functional>
#include <mutex>
#include <vector>

namespace dyslam
{
/** Gradients of the pairs of a step, computed by several threads at a time.
 *
 * Each thread works with a copy of the network, whose parameters share their values with the
 * network in training but have gradients of their own. The gradients of the pairs are added in the
 * order of the pairs: the sums are the same for any number of threads.
 */
class PairGradients
{
 public:
  /** \param parameters parameters of the network in training, which are changed in place from here
   * on \param copies parameters of copies of the network, in the same order: one copy for each
   * thread */
  PairGradients(std::vector<torch::Tensor> parameters,
                std::vector<std::vector<torch::Tensor>> copies);

  /** Begins a step: forgets the gradients of the last step. \param pairs number of pairs of the new
   * step */
  void begin(std::size_t pairs);
  /** Calls `backward` with the number of a copy that no other thread is using, and keeps the
   * gradients that it adds to this copy. Threads may call it at the same time, for different pairs.
   * \throws std::logic_error if more threads than there are copies call it. */
  void compute(std::size_t pair, const std::function<void(std::size_t copy)>& backward);
  /** Sets the gradients of the network in training to the sums. */
  void finish();
  /** A whole step: begin(), compute() of each of `pairs` with `backward(pair, copy)`, finish().
   * Threads of the pool without a pair of this step call `prepare(pair)` for pairs of the next
   * step. */
  void computeStep(ThreadPool& pool,
                   std::size_t pairs,
                   const std::function<void(std::size_t pair, std::size_t copy)>& backward,
                   const std::function<void(std::size_t pair)>& prepare);

 private:
  std::vector<torch::Tensor> parameters_;
  std::vector<std::vector<torch::Tensor>> copies_;
  std::vector<std::vector<torch::Tensor>>
      gradients_;  //!< gradients of each pair; undefined if none
  std::mutex mutex_;
  std::vector<std::size_t> free_;  //!< numbers of the copies that no thread is using
};
}  // namespace dyslam
