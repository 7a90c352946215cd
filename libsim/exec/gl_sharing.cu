#include "libsim/exec/gl_sharing.hpp"

#include <cuda_gl_interop.h>

#include "libsim/exec/space.hpp"

namespace sim::SIM_BACKEND {

namespace {

cudaGraphicsResource_t resource_of(void* pointer) { return static_cast<cudaGraphicsResource_t>(pointer); }

/// The pointers as driver handles, in the array that cudaGraphicsMapResources needs.
std::vector<cudaGraphicsResource_t> resources_of(const std::vector<void*>& pointers) {
  std::vector<cudaGraphicsResource_t> out;
  for (void* pointer : pointers) out.push_back(resource_of(pointer));
  return out;
}

}  // namespace

GlSharing::~GlSharing() { forget(); }

/// Unmaps and unregisters all buffers. If the GL context or the buffers are already destroyed, CUDA reports
/// an error, which is cleared so that the next launch does not report it.
void GlSharing::forget() {
  auto resources = resources_of(resources_);
  if (!memory_.empty() &&
      cudaGraphicsUnmapResources(static_cast<int>(resources.size()), resources.data()) != cudaSuccess)
    cudaGetLastError();
  memory_.clear();
  for (const auto& resource : resources) {
    if (cudaGraphicsUnregisterResource(resource) != cudaSuccess) cudaGetLastError();
  }
  resources_.clear();
}

bool GlSharing::accept(const std::vector<GlBufferRef>& buffers) {
  if (buffers == buffers_) return !resources_.empty();
  forget();
  buffers_ = buffers;
  const unsigned flags =
      access_ == Access::Read ? cudaGraphicsRegisterFlagsReadOnly : cudaGraphicsRegisterFlagsWriteDiscard;
  for (const GlBufferRef& buffer : buffers) {
    cudaGraphicsResource_t resource = nullptr;
    if (cudaGraphicsGLRegisterBuffer(&resource, buffer.name, flags) != cudaSuccess) {
      cudaGetLastError();  // clears the error: the return value reports it, and the next launch must not
      forget();
      return false;
    }
    resources_.push_back(resource);
  }
  return true;
}

const std::vector<void*>& GlSharing::map() {
  if (!memory_.empty()) return memory_;
  auto resources = resources_of(resources_);
  check(cudaGraphicsMapResources(static_cast<int>(resources.size()), resources.data()), "map GL buffers");
  for (const auto& resource : resources) {
    void* pointer = nullptr;
    std::size_t size = 0;
    check(cudaGraphicsResourceGetMappedPointer(&pointer, &size, resource), "map GL buffers");
    memory_.push_back(pointer);
  }
  return memory_;
}

void GlSharing::unmap() {
  if (memory_.empty()) return;
  memory_.clear();
  auto resources = resources_of(resources_);
  check(cudaGraphicsUnmapResources(static_cast<int>(resources.size()), resources.data()), "unmap GL buffers");
}

}  // namespace sim::SIM_BACKEND
