// Limits how many hold a place at once, in all and for each address.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <unordered_map>

namespace wobble::gateway {

// A place that is taken, free again when the last copy is gone. It must not outlive its Places.
using Place = std::shared_ptr<const void>;

class Places {
 public:
  Places(std::size_t inAll, std::size_t perAddress) : m_most(inAll), m_mostPerAddress(perAddress) {}

  // Null when all places are taken, or all that one address may have.
  [[nodiscard]] Place Take(const std::string& address) {
    if (!HasRoom(address)) return nullptr;
    ++m_taken;
    ++m_byAddress[address];
    return Place(this, [this, address](const void*) { Free(address); });
  }

  [[nodiscard]] bool HasRoom(const std::string& address) const {
    return m_taken < m_most && CountOf(address) < m_mostPerAddress;
  }
  [[nodiscard]] bool IsFull() const { return m_taken >= m_most; }
  [[nodiscard]] std::size_t CountTaken() const { return m_taken; }

 private:
  [[nodiscard]] std::size_t CountOf(const std::string& address) const {
    const auto found = m_byAddress.find(address);
    return found == m_byAddress.end() ? 0 : found->second;
  }

  void Free(const std::string& address) {
    --m_taken;
    const auto found = m_byAddress.find(address);
    if (--found->second == 0) m_byAddress.erase(found);
  }

  std::size_t m_most;
  std::size_t m_mostPerAddress;
  std::size_t m_taken = 0;
  std::unordered_map<std::string, std::size_t> m_byAddress;
};

}  // namespace wobble::gateway
