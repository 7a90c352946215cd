#include "tests/faults/call_log.hpp"

#include <sys/mman.h>

#include <cstdlib>
#include <cstring>
#include <stdexcept>

namespace faults {

namespace {

constexpr std::size_t room = std::size_t{1} << 28;

struct Head {
  Call::Kind kind;
  std::uint32_t path, to, bytes;  // lengths of the texts
  std::uint64_t file;
  std::int64_t at;
};

std::string take(const char*& from, std::uint32_t length) {
  std::string text(from, length);
  from += length;
  return text;
}

}  // namespace

struct CallLog::Memory {
  std::atomic<std::size_t> used;
  char bytes[room];
};

CallLog::CallLog() {
  void* memory = ::mmap(nullptr, sizeof(Memory), PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED)
    throw std::runtime_error("no shared memory for the log of calls; mend: free memory or raise ulimit -v");
  memory_ = static_cast<Memory*>(memory);
}

CallLog::~CallLog() { ::munmap(memory_, sizeof(Memory)); }

void CallLog::clear() { memory_->used = 0; }

void CallLog::add(Call::Kind kind, std::uint64_t file, std::int64_t at, std::string_view path,
                  std::string_view to, std::string_view bytes) {
  const Head head{kind,
                  static_cast<std::uint32_t>(path.size()),
                  static_cast<std::uint32_t>(to.size()),
                  static_cast<std::uint32_t>(bytes.size()),
                  file,
                  at};
  const std::size_t used = memory_->used;
  if (used + sizeof head + path.size() + to.size() + bytes.size() > room) std::abort();
  char* out = memory_->bytes + used;
  std::memcpy(out, &head, sizeof head);
  out += sizeof head;
  for (const std::string_view part : {path, to, bytes}) {
    if (!part.empty()) std::memcpy(out, part.data(), part.size());
    out += part.size();
  }
  // A kill before this line leaves out the last call, although it was done.
  memory_->used = static_cast<std::size_t>(out - memory_->bytes);
}

std::vector<Call> CallLog::read() const {
  std::vector<Call> calls;
  const char* from = memory_->bytes;
  for (const char* const end = from + memory_->used; from < end;) {
    Head head;
    std::memcpy(&head, from, sizeof head);
    from += sizeof head;
    Call call{head.kind, head.file, head.at, {}, {}, {}};
    call.path = take(from, head.path);
    call.to = take(from, head.to);
    call.bytes = take(from, head.bytes);
    calls.push_back(std::move(call));
  }
  return calls;
}

}  // namespace faults
