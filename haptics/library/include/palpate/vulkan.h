/* palpate's C interface: a Vulkan device that a program has made, and lends. palpate.h includes this; no header of
 * Vulkan's is needed for it. */
#ifndef PALPATE_VULKAN_H
#define PALPATE_VULKAN_H
#ifndef PALPATE_H
#error "include <palpate/palpate.h>, which has this"
#endif

/* A queue that is lent. It must be able to compute. */
typedef struct pp_vulkan_queue {
  void* handle; /* VkQueue; null: there is none */
  uint32_t family;
  uint32_t reserved;
} pp_vulkan_queue;

/* What a program has made, and what it made it with, which Vulkan tells nobody afterwards. All of it outlives what is
 * opened on it and is left as it is; the chain of features is read while that is opened, and no longer. One program has
 * one loader: get_instance_proc_addr is the same in all calls. The device needs bufferDeviceAddress, scalarBlockLayout,
 * synchronization2 and computeFullSubgroups; what is missing is named in the error. */
typedef struct pp_vulkan_device {
  uint32_t size;
  uint32_t api_version;         /* VkApplicationInfo::apiVersion that the instance was made for; 1.3 or later */
  void* get_instance_proc_addr; /* PFN_vkGetInstanceProcAddr */
  void* instance;               /* VkInstance */
  void* physical_device;        /* VkPhysicalDevice */
  void* device;                 /* VkDevice */
  const void* features;         /* VkPhysicalDeviceFeatures2 as VkDeviceCreateInfo had it, with its chain */
  pp_vulkan_queue throughput;   /* with graphics, where pictures are to be drawn by hardware */
  pp_vulkan_queue latency;      /* none: that of throughput */
  pp_vulkan_queue background;   /* none: that of throughput */
  uint32_t validated;           /* 1: a validation layer watches the instance */
  uint32_t debug_utils;         /* 1: the instance has VK_EXT_debug_utils: objects and passes get names */
  /* Called around every submission to a queue, by the thread that submits, for as long as vkQueueSubmit2 takes: the
   * program holds the same lock where it uses the queue itself. Both or neither; null where it never does. */
  void (*lock)(void* user, void* queue);
  void (*unlock)(void* user, void* queue);
  void* lock_user;
} pp_vulkan_device;
PP_OPTIONS(vulkan_device)

#endif
