// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <bit>
#include <cairn/io/sha256.hpp>
#include <cairn/ros/messages.hpp>
#include <cstdint>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

/// The hash of a message type by REP 2016: SHA-256 of the type's description in canonical JSON.
namespace cairn::ros {

/// Describes the members of a message and of the messages that it contains.
class TypeDescription {
 public:
  template <Message M>
  static std::string hash() {
    std::map<std::string, std::string> described;
    describe<M>(described);
    const std::string own = described.extract(std::string(M::kType)).mapped();
    std::string others;
    for (const auto& [name, text] : described) others += (others.empty() ? "" : ", ") + text;
    return "RIHS01_" + io::sha256(R"({"type_description": )" + own +
                                  R"(, "referenced_type_descriptions": [)" + others + "]}");
  }

 private:
  struct Kind {
    int id = 0;
    std::size_t capacity = 0;
    std::string nested;
  };
  template <class T>
  static Kind kind_of(std::map<std::string, std::string>& described) {
    if constexpr (Message<T>) {
      describe<T>(described);
      return {1, 0, std::string(T::kType)};
    } else if constexpr (requires { std::tuple_size<T>::value; }) {
      Kind kind = kind_of<typename T::value_type>(described);
      return {kind.id + 48, std::tuple_size_v<T>, kind.nested};
    } else if constexpr (std::is_same_v<T, std::string>) {
      return {17, 0, ""};
    } else if constexpr (requires { typename T::value_type; }) {
      Kind kind = kind_of<typename T::value_type>(described);
      return {kind.id + 144, 0, kind.nested};
    } else if constexpr (std::is_same_v<T, bool>) {
      return {15, 0, ""};
    } else if constexpr (std::is_same_v<T, std::byte>) {
      return {16, 0, ""};
    } else if constexpr (std::is_floating_point_v<T>) {
      return {sizeof(T) == 4 ? 10 : 11, 0, ""};
    } else {  // int8 2, uint8 3, int16 4, …, uint64 9
      return {2 * std::bit_width(sizeof(T)) + (std::is_unsigned_v<T> ? 1 : 0), 0, ""};
    }
  }
  template <Message M>
  static void describe(std::map<std::string, std::string>& described) {
    std::string fields;
    M message;
    M::each(message, [&](std::string_view name, auto& value) {
      const Kind kind = kind_of<std::remove_cvref_t<decltype(value)>>(described);
      fields += (fields.empty() ? R"({"name": ")" : R"(, {"name": ")") + std::string(name) +
                R"(", "type": {"type_id": )" + std::to_string(kind.id) + R"(, "capacity": )" +
                std::to_string(kind.capacity) + R"(, "string_capacity": 0, "nested_type_name": ")" +
                kind.nested + "\"}}";
    });
    described[std::string(M::kType)] =
        R"({"type_name": ")" + std::string(M::kType) + R"(", "fields": [)" + fields + "]}";
  }
};

}  // namespace cairn::ros
