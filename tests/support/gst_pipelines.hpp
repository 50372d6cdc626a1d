// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <gst/gst.h>

#include <initializer_list>

namespace cairn::support {

/// Whether all these GStreamer elements are installed; tests skip otherwise.
inline bool has_elements(std::initializer_list<const char*> names) {
  gst_init(nullptr, nullptr);
  for (const char* name : names) {
    GstElementFactory* factory = gst_element_factory_find(name);
    if (factory == nullptr) return false;
    gst_object_unref(factory);
  }
  return true;
}

}  // namespace cairn::support
