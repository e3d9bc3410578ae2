// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Error.h>
#include <dyslam/base/Options.h>
#include <dyslam/base/Words.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
class ThreadPool;

/** The implementations of an interface that a config chooses by name: one row each. */
template <typename Interface>
class Registry
{
 public:
  using Factory = std::function<std::unique_ptr<Interface>(ThreadPool&)>;
  struct Row
  {
    const char* name;
    /** Loads the implementation's options and returns a function that makes the implementation. */
    std::function<Factory(ConfigLoader&)> load;
    /** Whether the implementation is in the module `networks`, which loads libtorch. */
    bool needs_networks = false;
  };

  explicit Registry(std::vector<Row> rows) : rows_(std::move(rows)) {}

  [[nodiscard]] std::vector<std::string> names() const
  {
    std::vector<std::string> names;
    for (const Row& row : rows_)
    {
      names.emplace_back(row.name);
    }
    return names;
  }

  /** Whether the implementation `name` is in the module `networks`; false for an unknown name. */
  [[nodiscard]] bool needsNetworks(const std::string& name) const
  {
    return std::any_of(rows_.begin(), rows_.end(),
                       [&name](const Row& row) { return row.needs_networks && name == row.name; });
  }

  /** Makes the implementation `name`. The options of all rows are loaded and checked, so that one
   * ini serves all. \param key the option that chooses, for the error message, e.g.
   * "odometry.method" \throws UserError for an unknown name, naming the nearest, and for bad
   * options. */
  [[nodiscard]] std::unique_ptr<Interface> make(const std::string& name,
                                                const std::string& key,
                                                ConfigLoader& config,
                                                ThreadPool& pool) const
  {
    Factory chosen;
    for (const Row& row : rows_)
    {
      Factory factory = row.load(config);
      if (name == row.name)
      {
        chosen = std::move(factory);
      }
    }
    if (!chosen)
    {
      throw UserError(key + ": " + unknownWord("name", name, names()));
    }
    return chosen(pool);
  }

 private:
  std::vector<Row> rows_;
};
}  // namespace dyslam
