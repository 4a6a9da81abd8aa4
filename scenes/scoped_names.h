#pragma once
// Names that AttributeBegin … AttributeEnd scopes, as pbrt-v3 does, with v4's global view beside it.
#include <string>
#include <unordered_map>
#include <vector>

namespace penumbra {

class ScopedNames {
 public:
  void define(const std::string& name, int index) {
    const auto [entry, fresh] = visible_.try_emplace(name, index);
    undo_.push_back({name, fresh ? -1 : entry->second});
    entry->second = index;
    latest_[name] = index;
  }

  /// The definition that is in scope here; else the latest one anywhere before (v4 has no scopes);
  /// else -1.
  int find(const std::string& name) const {
    if (const auto entry = visible_.find(name); entry != visible_.end()) return entry->second;
    const auto entry = latest_.find(name);
    return entry != latest_.end() ? entry->second : -1;
  }

  /// Leaving a scope costs what was defined in it, not what is visible.
  size_t mark() const { return undo_.size(); }
  void undo_to(size_t mark) {
    while (undo_.size() > mark) {
      const auto& [name, before] = undo_.back();
      if (before < 0)
        visible_.erase(name);
      else
        visible_[name] = before;
      undo_.pop_back();
    }
  }

 private:
  struct Undo {
    std::string name;
    int before;  ///< -1: not visible
  };
  std::unordered_map<std::string, int> visible_, latest_;
  std::vector<Undo> undo_;
};

}  // namespace penumbra
