// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/pipeline/ReadAhead.h>

#include <exception>
#include <utility>

namespace dyslam
{
ReadAhead::ReadAhead(std::function<std::optional<Frame>()> next, std::size_t depth)
    : frames_(depth),
      thread_(
          [this, read = std::move(next)]
          {
            try
            {
              auto frame = read();
              while (frame && frames_.push(std::move(*frame)))
              {
                frame = read();
              }
              frames_.close();
            }
            catch (...)
            {
              frames_.fail(std::current_exception());
            }
          })
{
}

ReadAhead::~ReadAhead()
{
  frames_.stop();
  thread_.join();
}
}  // namespace dyslam
