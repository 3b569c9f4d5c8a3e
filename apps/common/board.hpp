// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Values by their types: how parts of a program share what they know without knowing each other.
#pragma once

#include <map>
#include <memory>
#include <typeindex>

namespace edged {

/// Each value is made when it is first asked for, and stays where it is. Not for several threads; the values may be.
class Board {
 public:
  template <typename T>
  T& get() {
    std::shared_ptr<void>& value = values_[typeid(T)];
    if (!value) value = std::make_shared<T>();
    return *static_cast<T*>(value.get());
  }
  /// The value must be there.
  template <typename T>
  const T& get() const {
    return *static_cast<const T*>(values_.at(typeid(T)).get());
  }

 private:
  std::map<std::type_index, std::shared_ptr<void>> values_;
};

}  // namespace edged
