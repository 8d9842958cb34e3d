#!/usr/bin/env bash
# Unpacks another Vulkan driver and a current validation layer for the tests, both from Debian's package
# chromium-common, below build/drivers: swiftshader.json for VK_DRIVER_FILES, the folder itself for VK_LAYER_PATH.
# Installs nothing; later calls reuse the folder. Prints the folder, or the reason of a failure.
set -euo pipefail
cd "$(dirname "$0")/.."
folder=$PWD/build/drivers
package=chromium-common

if [ ! -e "$folder/complete" ]; then
  work=$folder.unpacking
  rm -rf "$work"
  mkdir -p "$work"
  # As root: apt would warn that its sandbox user cannot write here.
  if ! problem=$(cd "$work" && apt-get -o APT::Sandbox::User=root download "$package" 2>&1); then
    echo "drivers.sh: the package $package cannot be downloaded: ${problem##*$'\n'}" >&2
    exit 1
  fi
  dpkg -x "$work"/*.deb "$work/package"
  mkdir "$work/kept"
  for library in libvk_swiftshader.so libVkLayer_khronos_validation.so; do
    found=$(find "$work/package" -name "$library" -print -quit)
    [ -n "$found" ] || { echo "drivers.sh: the package $package has no $library" >&2; exit 1; }
    mv "$found" "$work/kept/"
  done
  cat > "$work/kept/swiftshader.json" <<'JSON'
{"file_format_version": "1.0.0", "ICD": {"library_path": "./libvk_swiftshader.so", "api_version": "1.3.0"}}
JSON
  cat > "$work/kept/VkLayer_khronos_validation.json" <<'JSON'
{"file_format_version": "1.2.0",
 "layer": {"name": "VK_LAYER_KHRONOS_validation", "type": "GLOBAL",
           "library_path": "./libVkLayer_khronos_validation.so",
           "api_version": "1.4.300", "implementation_version": "1", "description": "Khronos validation",
           "instance_extensions": [{"name": "VK_EXT_debug_utils", "spec_version": "1"},
                                   {"name": "VK_EXT_validation_features", "spec_version": "6"}]}}
JSON
  touch "$work/kept/complete"
  rm -rf "$folder"
  mv "$work/kept" "$folder"
  rm -rf "$work"
fi
echo "$folder"
