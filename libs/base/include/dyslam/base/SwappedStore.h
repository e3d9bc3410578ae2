// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/StateArchive.h>
#include <dyslam/base/SwapFile.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
/** A growing list of values; the most recently used ones are in memory, the others on disk.
 *
 * Its values do not depend on the limit. `T` has `std::size_t memory() const` [bytes],
 * `std::string toBytes() const` and `static T fromBytes(std::string_view)`. References are valid
 * until the next call of add(), get() or edit(). If the disk is full, values stay in memory.
 * Not thread-safe.
 */
template <typename T>
class SwappedStore
{
 public:
  explicit SwappedStore(MemoryLimit limit = {}) : limit_(std::move(limit)) {}
  ~SwappedStore() { clear(); }
  SwappedStore(SwappedStore&& other) noexcept { *this = std::move(other); }
  SwappedStore& operator=(SwappedStore&& other) noexcept
  {
    std::swap(limit_, other.limit_);
    std::swap(entries_, other.entries_);
    std::swap(newest_, other.newest_);
    std::swap(oldest_, other.oldest_);
    std::swap(edited_, other.edited_);
    std::swap(memory_, other.memory_);
    return *this;
  }

  /** Appends a value. \return its number: 0, 1, 2, ... */
  std::size_t add(T value)
  {
    settle();
    const auto i = static_cast<std::uint32_t>(entries_.size());
    entries_.emplace_back();
    entries_[i].value = std::make_unique<T>(std::move(value));
    pushNewest(i);
    edited_ = i;
    return i;
  }

  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  [[nodiscard]] const T& get(std::size_t i) const { return *use(i).value; }
  /** Value number `i`, to be changed. */
  [[nodiscard]] T& edit(std::size_t i)
  {
    Entry& entry = use(i);
    edited_ = static_cast<std::uint32_t>(i);
    return *entry.value;
  }
  void clear()
  {
    for (Entry& entry : entries_)
    {
      if (entry.slot.capacity > 0)
      {
        limit_.file->release(entry.slot);
      }
    }
    entries_.clear();
    newest_ = oldest_ = edited_ = none;
    memory_ = 0;
  }

  /** Saves or loads all values, including those on disk; saving reads these without caching. */
  void exchangeState(StateArchive& archive)
  {
    std::size_t count = entries_.size();
    archive(count);
    if (archive.isLoading())
    {
      clear();
    }
    for (std::size_t i = 0; i < count; ++i)
    {
      std::string bytes;
      if (!archive.isLoading())
      {
        const Entry& entry = entries_[i];
        bytes = entry.value != nullptr ? entry.value->toBytes() : limit_.file->read(entry.slot);
      }
      archive(bytes);
      if (archive.isLoading())
      {
        (void)add(T::fromBytes(bytes));
      }
    }
  }

  [[nodiscard]] const MemoryLimit& limit() const { return limit_; }
  /** Size of the values in memory [bytes]. */
  [[nodiscard]] std::size_t memory() const { return memory_; }

 private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  struct Entry
  {
    std::unique_ptr<T> value;  //!< null: on disk
    SwapFile::Slot slot;
    std::size_t memory = 0;      //!< size when last counted [bytes]
    bool is_on_disk = false;     //!< the slot has the present value
    std::uint32_t newer = none;  //!< next more recently used entry in memory
    std::uint32_t older = none;  //!< next less recently used entry in memory
  };

  Entry& use(std::size_t number) const
  {
    settle();
    const auto i = static_cast<std::uint32_t>(number);
    Entry& entry = entries_.at(number);
    if (entry.value == nullptr)
    {
      entry.value = std::make_unique<T>(T::fromBytes(limit_.file->read(entry.slot)));
      count(entry);
      pushNewest(i);
      makeRoom();
    }
    else if (newest_ != i)
    {
      unlink(i);
      pushNewest(i);
    }
    return entry;
  }

  /** Counts the edited value again, which may have grown. */
  void settle() const
  {
    if (edited_ == none)
    {
      return;
    }
    Entry& entry = entries_[edited_];
    edited_ = none;
    entry.is_on_disk = false;
    count(entry);
    makeRoom();
  }

  void count(Entry& entry) const
  {
    memory_ -= entry.memory;
    entry.memory = sizeof(T) + entry.value->memory();
    memory_ += entry.memory;
  }

  void makeRoom() const
  {
    while (memory_ > limit_.bytes && oldest_ != newest_)
    {
      Entry& entry = entries_[oldest_];
      if (!entry.is_on_disk && !limit_.file->write(entry.value->toBytes(), entry.slot))
      {
        limit_.bytes = std::numeric_limits<std::size_t>::max();
        return;
      }
      entry.is_on_disk = true;
      entry.value.reset();
      memory_ -= std::exchange(entry.memory, 0);
      unlink(oldest_);
    }
  }

  void unlink(std::uint32_t i) const
  {
    Entry& entry = entries_[i];
    (entry.newer == none ? newest_ : entries_[entry.newer].older) = entry.older;
    (entry.older == none ? oldest_ : entries_[entry.older].newer) = entry.newer;
    entry.newer = entry.older = none;
  }

  void pushNewest(std::uint32_t i) const
  {
    entries_[i].older = newest_;
    (newest_ == none ? oldest_ : entries_[newest_].newer) = i;
    newest_ = i;
  }

  // Mutable: reading a value moves values between memory and disk.
  mutable MemoryLimit limit_;
  mutable std::vector<Entry> entries_;
  mutable std::uint32_t newest_ = none;
  mutable std::uint32_t oldest_ = none;
  mutable std::uint32_t edited_ = none;
  mutable std::size_t memory_ = 0;
};
}  // namespace dyslam
