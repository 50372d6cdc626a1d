// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <bit>
#include <cairn/core/pool.hpp>
#include <map>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

namespace cairn {
namespace {

constexpr std::align_val_t kAlignment{64};

std::byte* allocate(std::size_t bytes) {
  return static_cast<std::byte*>(::operator new(bytes, kAlignment));
}
void deallocate(std::byte* data) noexcept {
  ::operator delete(data, kAlignment);
}

/// The size rounded up by at most an eighth. Only buffers of one class replace each other: if a small request took a
/// larger buffer, a later large one of the same frame would have to allocate.
std::size_t of_class(std::size_t bytes) {
  const std::size_t step = std::max(std::bit_floor(bytes) / 8, std::size_t{1});
  return (bytes + step - 1) / step * step;
}

}  // namespace

struct Pool::Buffer::Store {
  std::mutex mutex;
  std::multimap<std::size_t, std::byte*> free;  // by size
  std::int64_t heap_allocations = 0;
  std::int64_t bytes = 0;
  std::vector<Pool> beside;

  Store() = default;
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;
  ~Store() {
    for (const auto& [size, data] : free) deallocate(data);
  }
};

Pool::Buffer::Buffer(std::byte* data, std::size_t bytes, std::shared_ptr<Store> store)
    : data_(data), bytes_(bytes), store_(std::move(store)) {}

Pool::Buffer::Buffer(Buffer&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)),
      bytes_(std::exchange(other.bytes_, 0)),
      store_(std::move(other.store_)) {}

Pool::Buffer& Pool::Buffer::operator=(Buffer&& other) noexcept {
  if (this != &other) {
    release();
    data_ = std::exchange(other.data_, nullptr);
    bytes_ = std::exchange(other.bytes_, 0);
    store_ = std::move(other.store_);
  }
  return *this;
}

Pool::Buffer::~Buffer() {
  release();
}

void Pool::Buffer::release() noexcept {
  if (data_ == nullptr) return;
  if (store_) {
    const std::lock_guard lock(store_->mutex);
    try {
      store_->free.emplace(bytes_, data_);
    } catch (const std::bad_alloc&) {
      store_->bytes -= static_cast<std::int64_t>(bytes_);
      deallocate(data_);
    }
  } else {
    deallocate(data_);
  }
  data_ = nullptr;
}

Pool Pool::make() {
  Pool pool;
  pool.store_ = std::make_shared<Buffer::Store>();
  return pool;
}

Pool Pool::beside(std::size_t which) const {
  if (!store_) return {};
  const std::lock_guard lock(store_->mutex);
  while (store_->beside.size() <= which) store_->beside.push_back(make());
  return store_->beside[which];
}

Pool::Buffer Pool::take(std::size_t bytes) const {
  if (!store_) return {allocate(bytes), bytes, nullptr};
  {
    const std::lock_guard lock(store_->mutex);
    bytes = of_class(bytes);
    const auto found = store_->free.find(bytes);
    if (found != store_->free.end()) {
      Buffer buffer(found->second, found->first, store_);
      store_->free.erase(found);
      return buffer;
    }
    ++store_->heap_allocations;
    store_->bytes += static_cast<std::int64_t>(bytes);
  }
  return {allocate(bytes), bytes, store_};
}

std::int64_t Pool::heap_allocations() const {
  if (!store_) return 0;
  const std::lock_guard lock(store_->mutex);
  std::int64_t all = store_->heap_allocations;
  for (const Pool& pool : store_->beside) all += pool.heap_allocations();
  return all;
}

std::int64_t Pool::bytes() const {
  if (!store_) return 0;
  const std::lock_guard lock(store_->mutex);
  std::int64_t all = store_->bytes;
  for (const Pool& pool : store_->beside) all += pool.bytes();
  return all;
}

}  // namespace cairn
