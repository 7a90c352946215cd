#include "libstudy/console/database_place.hpp"

#include <sys/vfs.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string_view>

namespace study {

namespace fs = std::filesystem;

namespace {

struct NetworkKind {
  std::uint32_t number;
  const char* name;
};
// Numbers of statfs's f_type. Sources: linux/magic.h and the source code of the file systems.
constexpr std::array network_kinds{NetworkKind{0x6969, "NFS"},
                                   NetworkKind{0x517B, "SMB"},
                                   NetworkKind{0xFF534D42, "SMB/CIFS"},
                                   NetworkKind{0xFE534D42, "SMB"},
                                   NetworkKind{0x01021997, "9p"},
                                   NetworkKind{0x5346414F, "AFS"},
                                   NetworkKind{0x6B414653, "AFS"},
                                   NetworkKind{0x73757245, "Coda"},
                                   NetworkKind{0x00C36400, "Ceph"},
                                   NetworkKind{0x0BD00BD0, "Lustre"},
                                   NetworkKind{0x47504653, "GPFS"},
                                   NetworkKind{0x19830326, "BeeGFS"},
                                   NetworkKind{0x786F4256, "VirtualBox shared folder"},
                                   NetworkKind{0xBACBACBC, "VMware shared folder"}};
constexpr std::uint32_t fuse = 0x65735546;

/// Mount types of network file systems through FUSE. Not every FUSE mount is a network file system: FUSE also
/// serves local disks, such as NTFS and exFAT ("fuseblk").
constexpr std::array network_mounts{"fuse.sshfs",
                                    "fuse.rclone",
                                    "fuse.glusterfs",
                                    "fuse.s3fs",
                                    "fuse.davfs",
                                    "fuse.gvfsd-fuse",
                                    "fuse.google-drive-ocamlfuse",
                                    "fuse.onedriver",
                                    "fuse.mfs",
                                    "fuse.cephfs",
                                    "fuse.smbnetfs",
                                    "fuse.vmhgfs-fuse",
                                    "fuse.curlftpfs",
                                    "fuse.gcsfuse",
                                    "fuse.dropbox"};

struct SyncFolder {
  const char* begins;  ///< a folder's name, or its beginning before " ", "(" or "-"
  const char* service;
};
constexpr std::array sync_folders{SyncFolder{"Dropbox", "Dropbox"},
                                  SyncFolder{"OneDrive", "OneDrive"},
                                  SyncFolder{"Google Drive", "Google Drive"},
                                  SyncFolder{"GoogleDrive", "Google Drive"},
                                  SyncFolder{"My Drive", "Google Drive"},
                                  SyncFolder{"Nextcloud", "Nextcloud"},
                                  SyncFolder{"ownCloud", "ownCloud"},
                                  SyncFolder{"iCloud Drive", "iCloud"},
                                  SyncFolder{"iCloudDrive", "iCloud"},
                                  SyncFolder{"Mobile Documents", "iCloud"},
                                  SyncFolder{"CloudStorage", "a cloud service"},
                                  SyncFolder{"Box Sync", "Box"},
                                  SyncFolder{"pCloudDrive", "pCloud"},
                                  SyncFolder{"MEGAsync", "MEGA"},
                                  SyncFolder{"Seafile", "Seafile"}};

/// A file or folder that a sync service creates in the folder that it copies.
struct SyncMark {
  const char *name, *service;
};
constexpr std::array sync_marks{SyncMark{".stfolder", "Syncthing"},
                                SyncMark{".dropbox", "Dropbox"},
                                SyncMark{".dropbox.cache", "Dropbox"},
                                SyncMark{".sync_journal.db", "Nextcloud"},
                                SyncMark{".nextcloudsync.log", "Nextcloud"},
                                SyncMark{".owncloudsync.log", "ownCloud"},
                                SyncMark{".sync", "Resilio Sync"},
                                SyncMark{".849C9593-D756-4E56-8D6E-42412F2A707B", "OneDrive"},
                                SyncMark{".seafile-data", "Seafile"}};

bool is_named(const std::string& folder, std::string_view begins) {
  if (!folder.starts_with(begins)) return false;
  const std::string_view rest = std::string_view(folder).substr(begins.size());
  return rest.empty() || rest.starts_with(" ") || rest.starts_with("(") || rest.starts_with("-");
}

/// The network file system of a folder; empty: local or not known.
std::string network_name(const fs::path& folder, const PlaceProbe& probe) {
  const auto kind = probe.file_system(folder);
  if (!kind) return {};
  for (const NetworkKind& one : network_kinds)
    if (one.number == *kind) return one.name;
  if (*kind != fuse) return {};
  const std::string mount = probe.mount_kind(folder);
  const bool network = std::find(network_mounts.begin(), network_mounts.end(), mount) != network_mounts.end();
  return network ? mount : std::string();
}

/// The sync service that copies a folder or one of its parents, recognised by a folder's name (sync_folders)
/// or its content (sync_marks); empty: none known.
std::string sync_service(fs::path folder, const PlaceProbe& probe) {
  for (; folder.has_relative_path(); folder = folder.parent_path()) {
    const std::string name = folder.filename().string();
    for (const SyncFolder& one : sync_folders)
      if (is_named(name, one.begins)) return one.service;
    for (const SyncMark& mark : sync_marks)
      if (probe.exists(folder / mark.name)) return mark.service;
  }
  return {};
}

/// The folder of the database, after links are resolved; if it does not exist, its nearest existing parent.
fs::path standing_folder(const fs::path& database, const PlaceProbe& probe) {
  std::error_code ignored;
  fs::path real = fs::weakly_canonical(fs::absolute(database, ignored), ignored);
  if (real.empty()) real = database;
  fs::path folder = real.parent_path();
  while (folder.has_relative_path() && !probe.exists(folder)) folder = folder.parent_path();
  return folder;
}

/// Decodes the octal escapes of /proc/self/mountinfo: "\040" is a space.
std::string unescaped(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 3 < text.size()) {
      out += static_cast<char>(std::stoi(text.substr(i + 1, 3), nullptr, 8));
      i += 3;
    } else {
      out += text[i];
    }
  }
  return out;
}

/// File system type of the mount that contains the folder; of nested mounts, the innermost.
std::string mount_kind_of(const fs::path& folder) {
  std::ifstream mounts("/proc/self/mountinfo");
  std::string found;
  std::size_t longest = 0;
  for (std::string line; std::getline(mounts, line);) {
    std::istringstream words(line);
    std::string id, parent, device, root, point, word, kind;
    words >> id >> parent >> device >> root >> point;
    while (words >> word && word != "-") {
    }
    words >> kind;
    point = unescaped(point);
    const bool below = point == "/" || folder == point || folder.string().starts_with(point + "/");
    if (below && point.size() >= longest) {
      longest = point.size();
      found = kind;
    }
  }
  return found;
}

}  // namespace

PlaceProbe system_probe() {
  return {[](const fs::path& folder) -> std::optional<std::uint32_t> {
            struct statfs facts {};
            if (::statfs(folder.c_str(), &facts) != 0) return {};
            return static_cast<std::uint32_t>(facts.f_type);
          },
          mount_kind_of,
          [](const fs::path& path) {
            std::error_code ignored;
            return fs::exists(path, ignored);
          }};
}

std::vector<std::string> place_problems(const fs::path& database, const PlaceProbe& probe) {
  std::vector<std::string> out;
  const fs::path folder = standing_folder(database, probe);
  if (const std::string network = network_name(folder, probe); !network.empty())
    out.push_back(database.string() + ": lies on a network file system (" + network +
                  "), where locks may not hold and a write may not be on a disk: two programs can then "
                  "destroy the database\n  mend: record on a disk of this computer, and copy " +
                  database.filename().string() + "* when no program runs");
  if (const std::string service = sync_service(folder, probe); !service.empty())
    out.push_back(database.string() + ": lies in a folder that " + service +
                  " copies while it is written: copies can be torn, conflicting copies can take its place, "
                  "and a withdrawal does not reach them\n  mend: record outside of that folder, and copy " +
                  database.filename().string() + "* when no program runs");
  return out;
}

void warn_of_place(const fs::path& database) {
  for (const std::string& problem : place_problems(database))
    std::fprintf(stderr, "warning: %s\n", problem.c_str());
}

}  // namespace study
