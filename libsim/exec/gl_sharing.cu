#include "libsim/exec/gl_sharing.hpp"

#include <cuda_gl_interop.h>

#include "libsim/exec/space.hpp"

namespace sim::SIM_BACKEND {

GlSharing::~GlSharing() { forget(); }

void GlSharing::forget() {
  if (resource_) cudaGraphicsUnregisterResource(static_cast<cudaGraphicsResource_t>(resource_));
  resource_ = nullptr;
}

void* GlSharing::map(unsigned buffer, std::size_t bytes) {
  if (refused_ && buffer == buffer_) return nullptr;
  if (buffer != buffer_ || !resource_) {
    forget();
    buffer_ = buffer;
    cudaGraphicsResource_t resource = nullptr;
    refused_ =
        cudaGraphicsGLRegisterBuffer(&resource, buffer, cudaGraphicsRegisterFlagsWriteDiscard) != cudaSuccess;
    if (refused_) {
      cudaGetLastError();  // said by the return value; not an error of the next launch
      return nullptr;
    }
    resource_ = resource;
  }
  auto resource = static_cast<cudaGraphicsResource_t>(resource_);
  check(cudaGraphicsMapResources(1, &resource), "map GL buffer");
  void* pointer = nullptr;
  std::size_t size = 0;
  check(cudaGraphicsResourceGetMappedPointer(&pointer, &size, resource), "map GL buffer");
  if (size >= bytes) return pointer;
  unmap();
  return nullptr;
}

void GlSharing::unmap() {
  auto resource = static_cast<cudaGraphicsResource_t>(resource_);
  check(cudaGraphicsUnmapResources(1, &resource), "unmap GL buffer");
}

}  // namespace sim::SIM_BACKEND
