// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/pipeline/JobThread.h>

#include <exception>

namespace dyslam
{
JobThread::JobThread(std::size_t depth)
    : jobs_(depth),
      thread_(
          [this]
          {
            try
            {
              while (const auto job = jobs_.pop())
              {
                (*job)();
              }
            }
            catch (...)
            {
              jobs_.stop(std::current_exception());
            }
          })
{
}

JobThread::~JobThread()
{
  jobs_.close();
  if (thread_.joinable())
  {
    thread_.join();
  }
}

void JobThread::finish()
{
  jobs_.close();
  if (thread_.joinable())
  {
    thread_.join();
  }
  (void)jobs_.pop();  // all jobs are done; only an error may be left
}
}  // namespace dyslam
