/// Negotiation by which the loader finds the runtime's functions. Debian's headers lack its structures; they
/// are those of the loader's specification ("Loader Design", runtime interface version 1).

#include "tests/headset/parts.hpp"

namespace {

enum LoaderStructure : std::uint32_t { loader_info = 1, runtime_request = 3 };

struct LoaderInfo {
  LoaderStructure type;
  std::uint32_t version;
  std::size_t size;
  std::uint32_t least_interface, most_interface;
  XrVersion least_api, most_api;
};

struct RuntimeRequest {
  LoaderStructure type;
  std::uint32_t version;
  std::size_t size;
  std::uint32_t interface;
  XrVersion api;
  PFN_xrGetInstanceProcAddr get;
};

XRAPI_ATTR XrResult XRAPI_CALL get_function(XrInstance, const char* name, PFN_xrVoidFunction* function) {
  const std::lock_guard held(simulated::lock());
  simulated::Functions functions;
  functions["xrGetInstanceProcAddr"] = reinterpret_cast<PFN_xrVoidFunction>(get_function);
  simulated::add_instance_functions(functions);
  simulated::add_session_functions(functions);
  simulated::add_event_functions(functions);
  simulated::add_frame_functions(functions);
  simulated::add_swapchain_functions(functions);
  simulated::add_space_functions(functions);
  simulated::add_view_functions(functions);
  simulated::add_time_functions(functions);
  simulated::add_rate_functions(functions);
  simulated::add_path_functions(functions);
  simulated::add_action_functions(functions);
  simulated::add_input_functions(functions);
  const auto found = functions.find(name);
  *function = found == functions.end() ? nullptr : found->second;
  return *function ? XR_SUCCESS : XR_ERROR_FUNCTION_UNSUPPORTED;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) XrResult xrNegotiateLoaderRuntimeInterface(
    const LoaderInfo* loader, RuntimeRequest* request) {
  const bool known = loader && request && loader->type == loader_info && request->type == runtime_request &&
                     loader->least_interface <= 1 && loader->most_interface >= 1;
  if (!known) return XR_ERROR_INITIALIZATION_FAILED;
  const std::lock_guard held(simulated::lock());
  simulated::restart();
  request->interface = 1;
  request->api = XR_CURRENT_API_VERSION;
  request->get = get_function;
  return XR_SUCCESS;
}
