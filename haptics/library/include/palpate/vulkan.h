/** @file
 * palpate's C interface: a Vulkan device that the program has created and lends to palpate. palpate.h includes this; it
 * requires no Vulkan header. */
#ifndef PALPATE_VULKAN_H
#define PALPATE_VULKAN_H
#ifndef PALPATE_H
#error "include <palpate/palpate.h>, which includes this header"
#endif

/** @defgroup vulkan A Vulkan device of the program
 * @{ */

/** A lent queue. It must support compute. */
typedef struct pp_vulkan_queue {
  void* handle;      /**< VkQueue; null: none */
  uint32_t family;   /**< index of its queue family */
  uint32_t reserved; /**< not used */
} pp_vulkan_queue;

/** A device of the program, and the parameters of its creation, which Vulkan cannot report afterwards. Everything must
 * outlive the sessions and scenes opened on it and is left unchanged; the chain of features is read only while one is
 * opened. get_instance_proc_addr must be the same in all calls of a program. The device requires bufferDeviceAddress,
 * scalarBlockLayout, synchronization2 and computeFullSubgroups; an error names what is missing. With
 * subgroupSizeControl enabled, palpate requires the subgroup size that suits the GPU. */
typedef struct pp_vulkan_device {
  uint32_t size;                /**< bytes of this struct */
  uint32_t api_version;         /**< VkApplicationInfo::apiVersion of the instance; 1.3 or later */
  void* get_instance_proc_addr; /**< PFN_vkGetInstanceProcAddr */
  void* instance;               /**< VkInstance */
  void* physical_device;        /**< VkPhysicalDevice */
  void* device;                 /**< VkDevice */
  const void* features;         /**< VkPhysicalDeviceFeatures2 given to VkDeviceCreateInfo, with its chain */
  pp_vulkan_queue throughput;   /**< with graphics, if pictures are to be drawn by hardware */
  pp_vulkan_queue latency;      /**< none: the queue `throughput` */
  pp_vulkan_queue background;   /**< none: the queue `throughput` */
  uint32_t validated;           /**< 1: the instance has a validation layer */
  uint32_t debug_utils;         /**< 1: the instance has VK_EXT_debug_utils: objects and passes get names */
  /** Called before every submission to a queue, by the submitting thread, with `unlock` after vkQueueSubmit2: the
   * program must hold the same lock while it uses the queue. Set both or neither; null if the program never uses the
   * queue. */
  void (*lock)(void* user, void* queue);
  void (*unlock)(void* user, void* queue); /**< called after the submission */
  void* lock_user;                         /**< passed to `lock` and `unlock` */
} pp_vulkan_device;
PP_OPTIONS(vulkan_device)

/** @} */

#endif
