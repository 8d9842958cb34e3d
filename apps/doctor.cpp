#include "apps/context.hpp"

namespace palpate {

namespace {

std::string_view typeName(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return "discrete";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return "integrated";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return "virtual";
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return "CPU";
    default:
      return "other";
  }
}

std::string flagNames(VkQueueFlags flags) {
  std::string names;
  const auto add = [&](VkQueueFlags bit, const char* name) {
    if (flags & bit) names += (names.empty() ? "" : "+") + std::string(name);
  };
  add(VK_QUEUE_GRAPHICS_BIT, "graphics");
  add(VK_QUEUE_COMPUTE_BIT, "compute");
  add(VK_QUEUE_TRANSFER_BIT, "transfer");
  return names;
}

Json describe(std::FILE* out, std::size_t number, VkPhysicalDevice device) {
  VkPhysicalDeviceDriverProperties driver{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &driver};
  vkGetPhysicalDeviceProperties2(device, &properties);
  VkPhysicalDeviceMemoryProperties memory;
  vkGetPhysicalDeviceMemoryProperties(device, &memory);
  std::uint64_t local = 0;
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    if (memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) local += memory.memoryHeaps[i].size;
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());

  const auto& p = properties.properties;
  fmt::print(out, "GPU {}: {} ({})\n", number, p.deviceName, typeName(p.deviceType));
  fmt::print(out, "  driver: {} {}, Vulkan {}.{}.{}, {} MiB of its own memory\n", driver.driverName, driver.driverInfo,
             VK_API_VERSION_MAJOR(p.apiVersion), VK_API_VERSION_MINOR(p.apiVersion), VK_API_VERSION_PATCH(p.apiVersion),
             local >> 20);
  Json queues = Json::array(), features = Json::object();
  for (std::uint32_t i = 0; i < count; ++i) {
    fmt::print(out, "  queue family {}: {} x {}\n", i, families[i].queueCount, flagNames(families[i].queueFlags));
    queues.push_back({{"count", families[i].queueCount}, {"flags", flagNames(families[i].queueFlags)}});
  }
  const auto roles = chooseQueues(families);
  if (roles)
    fmt::print(out, "  touch: family {} queue {}   sight: family {} queue {}   background: family {} queue {}{}\n",
               roles->touch.family, roles->touch.index, roles->sight.family, roles->sight.index,
               roles->background.family, roles->background.index,
               roles->shared()             ? "   (one queue, shared behind a lock)"
               : roles->backgroundShares() ? "   (sight and background share one behind a lock)"
                                           : "");
  bool usable = roles.has_value();
  for (const FeatureState& feature : requiredFeatures(device)) {
    fmt::print(out, "  {} {}\n", feature.present ? "has  " : "LACKS", feature.name);
    features[feature.name] = feature.present;
    usable = usable && feature.present;
  }
  fmt::print(out, "  {}\n", usable ? "palpate runs on it" : "palpate cannot run on it");
  return {{"name", p.deviceName}, {"type", typeName(p.deviceType)}, {"queues", queues},
          {"features", features}, {"memory_bytes", local},          {"usable", usable}};
}

void doctor(Context& context) {
  const Instance instance(false);
  const auto devices = instance.physicalDevices();
  Json gpus = Json::array();
  for (std::size_t i = 0; i < devices.size(); ++i) gpus.push_back(describe(context.tables(), i, devices[i]));
  Device& device = context.device();  // says what is wrong when none will do
  fmt::print(context.tables(), "In use: {}\n", device.name());
  context.writeJson({{"gpus", gpus}, {"in_use", device.name()}});
}

}  // namespace

void addDoctor(CLI::App& app, Context& context, Command& command) {
  CLI::App* sub = app.add_subcommand(
      "doctor", "the GPUs of this machine, and which of their queues serve touch, sight and background");
  sub->callback([&] { command = [&context] { doctor(context); }; });
}

}  // namespace palpate
