// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Mistakes prevented by types. must_not_compile.sh compiles this file unchanged, which must succeed, and once
// per CASE, which must fail with the message after "expect:" (a regular expression of grep -E).
#include <cairn/cairn.hpp>

namespace {

[[maybe_unused]] cairn::Image<float> make_image() {
  return cairn::Image<float>({4, 3});
}
[[maybe_unused]] void needs_view(cairn::View<const float>) {}
[[maybe_unused]] void needs_region(cairn::RegionId) {}

[[maybe_unused]] void right_use() {
  const cairn::Image<float> image = make_image();
  needs_view(image);
  needs_view(image.view());
  needs_region(cairn::RegionId{1});
}

[[maybe_unused]] void wrong_use() {
#if defined(CASE_view_of_a_temporary)
  // expect: use of deleted function
  const auto dangling = make_image().view();
#elif defined(CASE_temporary_kept_as_a_view)
  // expect: use of deleted function
  const cairn::View<const float> dangling = make_image();
#elif defined(CASE_copy_by_accident)
  // expect: use of deleted function
  const cairn::Image<float> image = make_image();
  const cairn::Image<float> copy = image;
#elif defined(CASE_write_through_a_const_image)
  // expect: (assignment of read-only|is not assignable)
  const cairn::Image<float> image = make_image();
  image(0, 0) = 1.0F;
#elif defined(CASE_object_where_a_region_is_due)
  // expect: (could not convert|cannot convert|no matching function)
  needs_region(cairn::ObjectId{1});
#elif defined(CASE_number_where_a_region_is_due)
  // expect: (could not convert|cannot convert|no matching function)
  needs_region(1);
#elif defined(CASE_image_where_a_map_is_due)
  // expect: (could not convert|invalid initialization|no matching function)
  cairn::reject_speckles(make_image(), {}, {});
#endif
}

}  // namespace
