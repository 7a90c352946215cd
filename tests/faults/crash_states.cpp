#include "tests/faults/crash_states.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <random>
#include <set>

#include "stats/base/file.hpp"

namespace faults {

namespace fs = std::filesystem;
using Kind = Call::Kind;

namespace {

constexpr std::int64_t sector = 512;

bool is_shared_memory(const std::string& path) { return path.ends_with("-shm"); }

std::string parent_of(const std::string& path) { return path.substr(0, path.rfind('/')); }

bool is_name(Kind kind) {
  return kind != Kind::Write && kind != Kind::Truncate && kind != Kind::Sync && kind != Kind::SyncFolder &&
         kind != Kind::Words && kind != Kind::Ended;
}

/// Moves a name, with everything below it, in a map by path.
template <class Value>
void move_names(std::map<std::string, Value>& names, const std::string& from, const std::string& to) {
  std::map<std::string, Value> moved;
  for (auto at = names.begin(); at != names.end();) {
    if (at->first == from || at->first.starts_with(from + '/')) {
      moved[to + at->first.substr(from.size())] = at->second;
      at = names.erase(at);
    } else {
      ++at;
    }
  }
  for (auto& [path, value] : moved) names[path] = value;
}

template <class Value>
void erase_names(std::map<std::string, Value>& names, const std::string& path) {
  std::erase_if(names,
                [&](const auto& one) { return one.first == path || one.first.starts_with(path + '/'); });
}

/// For each file and folder the index of its last sync, which makes earlier calls on it durable; `anything`
/// is the number of calls up to the last sync of any file or folder.
struct Synced {
  std::map<std::uint64_t, std::size_t> files;
  std::map<std::string, std::size_t> folders;
  std::size_t anything = 0;

  Synced(const std::vector<Call>& calls, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      if (calls[i].kind == Kind::Sync) files[calls[i].file] = i;
      if (calls[i].kind == Kind::SyncFolder) folders[calls[i].path] = i;
      if (calls[i].kind == Kind::Sync || calls[i].kind == Kind::SyncFolder) anything = i + 1;
    }
  }
  bool file_after(std::uint64_t file, std::size_t i) const {
    const auto found = files.find(file);
    return found != files.end() && found->second > i;
  }
  bool folder_after(const std::string& folder, std::size_t i) const {
    const auto found = folders.find(folder);
    return found != folders.end() && found->second > i;
  }
};

/// For each call that adds, changes or removes a name: the earlier calls without which it cannot be kept.
std::vector<std::vector<std::size_t>> foundations(const std::vector<Call>& calls, std::size_t count) {
  std::vector<std::vector<std::size_t>> all(count);
  std::map<std::string, std::size_t> maker;                 // index of the call that made the current name
  std::map<std::string, std::vector<std::size_t>> emptied;  // calls that removed names from a folder
  for (std::size_t i = 0; i < count; ++i) {
    const Call& call = calls[i];
    if (!is_name(call.kind)) continue;
    const auto needs = [&](const std::string& path) {
      if (const auto found = maker.find(path); found != maker.end()) all[i].push_back(found->second);
    };
    const std::string& made = call.to.empty() ? call.path : call.to;
    needs(parent_of(made));
    if (call.kind != Kind::Create && call.kind != Kind::Mkdir) needs(call.path);
    if (call.kind == Kind::Exchange) needs(call.to);
    if (call.kind == Kind::Rmdir)
      all[i].insert(all[i].end(), emptied[call.path].begin(), emptied[call.path].end());
    if (call.kind == Kind::Unlink || call.kind == Kind::Rmdir || call.kind == Kind::Rename)
      emptied[parent_of(call.path)].push_back(i);
    if (call.kind == Kind::Unlink || call.kind == Kind::Rmdir) {
      erase_names(maker, call.path);
    } else if (call.kind == Kind::Rename) {
      erase_names(maker, call.to);
      move_names(maker, call.path, call.to);
      maker[call.to] = i;
    } else if (call.kind == Kind::Exchange) {
      move_names(maker, call.path, "\n");
      move_names(maker, call.to, call.path);
      move_names(maker, "\n", call.to);
      maker[call.path] = maker[call.to] = i;
    } else {
      maker[made] = i;
    }
  }
  return all;
}

class Crash {
 public:
  Crash(const Tree& before, const std::vector<Call>& calls, std::size_t count, Model model, Kept kept,
        unsigned seed)
      : tree_(before),
        calls_(calls),
        count_(count),
        model_(model),
        kept_(kept),
        random_(seed),
        synced_(calls, count),
        names_(count) {
    std::erase_if(tree_.names, [](const auto& one) { return is_shared_memory(one.first); });
    if (model_ == Model::Ext4)
      keep_names_in_order();
    else
      keep_any_names();
  }

  Tree result() {
    for (std::size_t i = 0; i < count_; ++i) {
      const Call& call = calls_[i];
      if (call.kind == Kind::Write) write(call, i);
      if (call.kind == Kind::Truncate) truncate(call, i);
      if (is_name(call.kind) && names_[i]) change_name(call);
    }
    return std::move(tree_);
  }

 private:
  bool chance() { return kept_ == Kept::Most || (kept_ == Kept::Some && random_() % 2 == 0); }

  void keep_names_in_order() {
    const std::size_t open = count_ - synced_.anything;
    committed_ = kept_ == Kept::Most    ? count_
                 : kept_ == Kept::Least ? synced_.anything
                                        : synced_.anything + random_() % (open + 1);
    for (std::size_t i = 0; i < committed_; ++i) names_[i] = true;
  }

  void keep_any_names() {
    const auto needs = foundations(calls_, count_);
    for (std::size_t i = count_; i-- > 0;) {
      const Call& call = calls_[i];
      if (!is_name(call.kind)) continue;
      const bool goes = call.kind == Kind::Unlink || call.kind == Kind::Rmdir;
      const bool sure = synced_.folder_after(parent_of(call.path), i) ||
                        (!call.to.empty() && synced_.folder_after(parent_of(call.to), i)) ||
                        (!goes && synced_.file_after(call.file, i));
      if (!names_[i]) names_[i] = sure || chance();
      for (const std::size_t one : names_[i] ? needs[i] : std::vector<std::size_t>()) names_[one] = true;
    }
  }

  void write(const Call& call, std::size_t i) {
    std::string& file = tree_.files[call.file];
    const bool sure = synced_.file_after(call.file, i);
    if (!sure && torn_off_.contains(call.file)) return;
    const auto size = static_cast<std::int64_t>(file.size());
    const auto end = call.at + static_cast<std::int64_t>(call.bytes.size());
    for (std::int64_t at = call.at; at < end;) {
      const std::int64_t next = std::min(end, (at / sector + 1) * sector);
      const bool grows = model_ == Model::Ext4 && next > size;
      if (!sure && grows && (ends_.contains(call.file) || !chance())) {
        ends_.insert(call.file);
        return;
      }
      if (sure || grows || chance()) put(file, at, call.bytes.data() + (at - call.at), next - at);
      at = next;
    }
  }

  static void put(std::string& file, std::int64_t at, const char* bytes, std::int64_t size) {
    const auto from = static_cast<std::size_t>(at), length = static_cast<std::size_t>(size);
    if (file.size() < from + length) file.resize(from + length);
    file.replace(from, length, bytes, length);
  }

  void truncate(const Call& call, std::size_t i) {
    const bool sure = synced_.file_after(call.file, i);
    const bool kept = model_ == Model::Ext4 ? i < committed_ : sure || chance();
    if (kept || sure)
      tree_.files[call.file].resize(static_cast<std::size_t>(call.at));
    else if (model_ == Model::Ext4)
      torn_off_.insert(call.file);  // as the truncation is lost, unsynced writes after it are lost too
  }

  void change_name(const Call& call) {
    auto& names = tree_.names;
    if (is_shared_memory(call.path)) return;
    switch (call.kind) {
      case Kind::Create:
        names[call.path] = {call.file, false};
        tree_.files.try_emplace(call.file);
        break;
      case Kind::Mkdir:
        names[call.path] = {call.file, true};
        break;
      case Kind::Link:
        if (names.contains(call.path)) names[call.to] = names[call.path];
        break;
      case Kind::Rename:
        if (!names.contains(call.path)) break;
        erase_names(names, call.to);
        move_names(names, call.path, call.to);
        break;
      case Kind::Exchange:
        move_names(names, call.path, "\n");
        move_names(names, call.to, call.path);
        move_names(names, "\n", call.to);
        break;
      default:
        erase_names(names, call.path);
    }
  }

  Tree tree_;
  const std::vector<Call>& calls_;
  const std::size_t count_;
  const Model model_;
  const Kept kept_;
  std::mt19937 random_;
  const Synced synced_;
  std::vector<bool> names_;    // kept calls on names
  std::size_t committed_ = 0;  // Ext4: number of first calls whose changes of names are durable
  std::set<std::uint64_t> ends_, torn_off_;
};

}  // namespace

Tree read_tree(const fs::path& folder) {
  Tree tree;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    struct stat found {};
    if (::lstat(entry.path().c_str(), &found) != 0) continue;
    tree.names[entry.path().string()] = {found.st_ino, S_ISDIR(found.st_mode)};
    if (S_ISREG(found.st_mode)) tree.files[found.st_ino] = base::read_file(entry.path(), 1u << 30);
  }
  return tree;
}

void write_tree(const Tree& tree, const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) fs::remove_all(entry.path());
  for (const auto& [path, name] : tree.names) {  // folders precede their content
    if (name.folder) {
      fs::create_directories(path);
      fs::permissions(path, fs::perms::owner_all);
      continue;
    }
    const auto bytes = tree.files.find(name.file);
    std::ofstream out(path, std::ios::binary);
    if (bytes != tree.files.end()) out << bytes->second;
    out.close();
    fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
  }
}

std::size_t hash_of(const Tree& tree) {
  std::size_t hash = 0;
  const auto add = [&](std::string_view text) {
    hash = hash * 1099511628211u ^ std::hash<std::string_view>()(text);
  };
  for (const auto& [path, name] : tree.names) {
    add(path);
    if (const auto bytes = tree.files.find(name.file); bytes != tree.files.end()) add(bytes->second);
  }
  return hash;
}

const char* name_of(Model model) { return model == Model::Ext4 ? "ext4" : "posix"; }

Tree crash_state(const Tree& before, const std::vector<Call>& calls, std::size_t count, Model model,
                 Kept kept, unsigned seed) {
  return Crash(before, calls, count, model, kept, seed).result();
}

}  // namespace faults
