# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Input arrays: accepted types and layouts. Output arrays: ownership."""

import ctypes
import gc
import mmap
import weakref

import numpy as np
import pytest

import cairn
from cairn import _calls
from conftest import gray_of, same, same_frame


def address(array):
    return array.__array_interface__["data"][0]


def address_of_pixels(picture, bgr=False):
    """Where the library reads them."""
    return _calls.image(picture, "picture", cairn.Exec(1), bgr).address


# ---- in ----


def test_grey_images_are_not_copied():
    image = np.zeros((48, 64), np.uint8)
    assert address_of_pixels(image) == address(image)
    window = image[5:40, 7:50]  # a window of a larger image
    assert address_of_pixels(window) == address(window)
    row = image[3:4, :]
    assert address_of_pixels(row) == address(row)
    every_other_row = image[::2]
    assert address_of_pixels(every_other_row) == address(every_other_row)
    image.flags.writeable = False
    assert address_of_pixels(image) == address(image)


def test_colour_images_are_not_copied():
    image = np.zeros((48, 64, 3), np.uint8)
    for there in (image, image[5:40, 7:50], image[3:4], image[::2], image[:, :1]):
        assert address_of_pixels(there) == address(there)
    for other in (image[:, :, ::-1], image[::-1], image[:, ::2], np.asfortranarray(image)):
        assert address_of_pixels(other) != address(other)
    assert address_of_pixels(image, bgr=True) != address(image)  # another channel order needs a copy


def test_a_frame_shares_the_colour_image(sample):
    left = sample.left.copy()
    frame = cairn.segment(left, sample.right, sample.calibration)
    before = frame.overlay()
    left[:] = 255 - left  # which the guide warns against
    assert not same(frame.overlay(), before)


def test_pixels_that_are_not_adjacent_are_copied():
    image = np.zeros((48, 64), np.uint8)
    for other in (image[:, ::2], image.T, image[::-1], image[:, ::-1], np.asfortranarray(image)):
        assert address_of_pixels(other) != address(other)


def test_any_layout_gives_the_same_frame(sample):
    left, right = sample.gray()
    expected = cairn.segment(left, right, sample.calibration)

    def with_room(image):
        room = np.full((300, 400), 77, np.uint8)
        room[30:270, 40:360] = image
        return room[30:270, 40:360]

    def spread(image):
        wide = np.zeros((240, 640), np.uint8)
        wide[:, ::2] = image
        return wide[:, ::2]

    def upside_down(image):
        return np.ascontiguousarray(image[::-1])[::-1]

    for layout in (with_room, spread, upside_down, np.asfortranarray, lambda p: p[:, :, None], memoryview):
        assert same_frame(cairn.segment(layout(left), layout(right), sample.calibration), expected)


def test_colour_is_rgb_unless_bgr_is_given(sample):
    swapped = [np.ascontiguousarray(image[:, :, ::-1]) for image in (sample.left, sample.right)]
    assert same_frame(cairn.segment(*swapped, sample.calibration, bgr=True), sample.frame)
    views = [image[:, :, ::-1] for image in swapped]  # a view that is RGB, its channels backwards
    assert same_frame(cairn.segment(*views, sample.calibration), sample.frame)
    taken_for_rgb = cairn.segment(*swapped, sample.calibration)
    assert [o.mean_colour for o in taken_for_rgb.objects] != [o.mean_colour for o in sample.frame.objects]


def test_grey_from_colour_equals_load_pair(sample):
    left, right = sample.gray()
    in_grey = cairn.match(left, right, num_disparities=32)
    in_colour = cairn.match(sample.left, sample.right, num_disparities=32)
    assert same(in_grey.best, in_colour.best) and same(in_grey.cost, in_colour.cost)


def test_reads_stop_at_the_last_pixel():
    """Images that end at the end of mapped memory."""
    libc = ctypes.CDLL(None, use_errno=True)
    random = np.random.default_rng(5)

    def at_the_end(height, width):
        area = height * width
        pages = -(-area // mmap.PAGESIZE) + 1
        memory = mmap.mmap(-1, pages * mmap.PAGESIZE)
        everything = np.frombuffer(memory, np.uint8)
        last_page = everything[(pages - 1) * mmap.PAGESIZE :]
        if libc.mprotect(ctypes.c_void_p(address(last_page)), mmap.PAGESIZE, 0) != 0:
            pytest.skip("memory cannot be protected here")
        image = everything[(pages - 1) * mmap.PAGESIZE - area : (pages - 1) * mmap.PAGESIZE].reshape(height, width)
        image[:] = random.integers(0, 256, image.shape)
        return image

    for height, width in ((40, 61), (33, 64), (50, 97)):
        left, right = at_the_end(height, width), at_the_end(height, width)
        for preset in cairn.preset_names():
            for method in ("window", "semi_global"):
                cairn.segment(left, right, preset=preset, match={"num_disparities": 17, "method": method})
        cairn.match(left, right, method="window", cost="sad", prefilter="xsobel", num_disparities=9, row_band=2)


@pytest.mark.parametrize("height, width", [(1, 1), (1, 40), (40, 1), (9, 9), (17, 33)])
def test_any_size_that_fits_the_window_is_accepted_and_others_name_the_option(height, width):
    image = np.zeros((height, width), np.uint8)
    for preset, option in (("default", "match.method"), ("paper", "match.window_size")):
        if min(height, width) >= 9:
            assert cairn.segment(image, image, preset=preset, match={"num_disparities": 5}).shape == (height, width)
            continue
        with pytest.raises(cairn.Error, match=f"option {option}"):
            cairn.segment(image, image, preset=preset, match={"num_disparities": 1})


BAD_IMAGES = [
    (None, "left: found None, expected an image"),
    (3, "left: found a value of type int"),
    ("left.png", "left: found a value of type str"),
    (b"left", "left: found a value of type bytes"),
    ([[1, 2], [3, 4]], "left: found a value of type list"),
    (np.zeros((4, 5)), r"left: found an array of shape \(4, 5\) and type float64"),
    (np.zeros((4, 5), np.uint16), "type uint16, expected an image: an array .* of uint8"),
    (np.zeros((4, 5), np.int8), "type int8"),
    (np.zeros(5, np.uint8), r"left: found an array of shape \(5,\)"),
    (np.zeros((4, 5, 4), np.uint8), r"shape \(4, 5, 4\)"),
    (np.zeros((2, 4, 5, 3), np.uint8), r"shape \(2, 4, 5, 3\)"),
    (np.zeros((0, 5), np.uint8), "at least one pixel"),
    (np.zeros((5, 0, 3), np.uint8), "at least one pixel"),
    (np.broadcast_to(np.zeros((1, 1), np.uint8), (1 << 15, 1 << 14)), r"at most 2\^28 pixels"),
]


@pytest.mark.parametrize("image, words", BAD_IMAGES)
def test_a_bad_image_is_refused_by_name(sample, image, words):
    with pytest.raises(cairn.Error, match=words):
        cairn.segment(image, sample.right)
    with pytest.raises(cairn.Error, match=words.replace("left: ", "right: ")):
        cairn.segment(sample.left, image)


def test_images_of_two_sizes_are_refused(sample):
    with pytest.raises(cairn.Error, match="left image is 320x240, right image is 319x240"):
        cairn.segment(sample.left, sample.right[:, 1:])


def test_disparities_may_be_any_float_type_but_not_integers(sample):
    truth = cairn.load_disparity(sample.folder / "disp_left.png")
    expected = cairn.segment(sample.left, disparity_map=truth)
    for other in (truth.astype(np.float64), np.asfortranarray(truth), truth.astype(">f4"), cairn.external_disparity(truth)):
        assert same_frame(cairn.segment(sample.left, disparity_map=other), expected)
    with pytest.raises(cairn.Error, match="disparity_map: found an array .* type int16, expected .* float32"):
        cairn.segment(sample.left, disparity_map=np.zeros((240, 320), np.int16))
    with pytest.raises(cairn.Error, match="the map is 319x240, the left image 320x240"):
        cairn.segment(sample.left, disparity_map=truth[:, 1:])
    with pytest.raises(cairn.Error):
        cairn.segment(sample.left, disparity_map=np.full((240, 320), 1e9, np.float32))


def test_a_disparity_map_is_compared_with_the_pair(sample):
    truth = cairn.load_disparity(sample.folder / "disp_left.png")
    rig = sample.calibration.rig
    given = cairn.segment(sample.left, sample.right, rig, disparity_map=truth)
    assert same_frame(given, cairn.segment(sample.left, rig=rig, disparity_map=truth))
    depth_mm = np.float32(1000 * rig.focal_px * rig.baseline_m) / (truth + np.float32(rig.doffs_px)) / np.float32(256)
    for wrong, word in ((depth_mm, "depth in mm"), (16 * truth, "16 times"), (truth[::-1].copy(), "upside down")):
        with pytest.raises(cairn.Error, match=f"disparity_map: no disparity of these images: .*{word}"):
            cairn.segment(sample.left, sample.right, rig, disparity_map=wrong)
        cairn.segment(sample.left, rig=rig, disparity_map=wrong)  # without the right image nothing can be compared


# ---- out ----


def test_arrays_of_a_frame_share_its_memory_and_outlive_it(sample):
    frame = cairn.segment(sample.left, sample.right, sample.calibration)
    assert address(frame.disparity) == address(frame.disparity)
    assert address(frame.disparity) == address(frame.disparity_map.disparity_px)
    disparity, labels, objects = frame.disparity, frame.groups.labels, frame.objects
    before = disparity.copy()
    del frame
    gc.collect()
    [cairn.segment(sample.left[::-1], sample.right) for _ in range(3)]  # would overwrite freed memory
    np.testing.assert_array_equal(disparity, before)
    assert labels.max() == len(sample.frame.groups) - 1
    assert repr(objects) == repr(sample.frame.objects)


def test_arrays_have_the_types_and_shapes_of_the_guide(sample):
    frame = sample.frame
    for name, kind in (("disparity", np.float32), ("reject", np.uint16), ("confidence", np.float32), ("floor", np.uint8),
                       ("objects_map", np.int32)):
        array = getattr(frame, name)
        assert array.dtype == kind and array.shape == frame.shape == (240, 320), name
    np.testing.assert_array_equal(np.isnan(frame.disparity), frame.reject != 0)
    assert frame.confidence.min() >= 0 and frame.confidence.max() <= 1
    assert not frame.confidence[frame.reject != 0].any()
    assert set(np.unique(frame.floor)) == {0, 255}
    assert sorted(set(np.unique(frame.objects_map)) - {0}) == [o.id for o in frame.objects]
    assert frame.by_intensity is None and frame.by_disparity is None and frame.fusion is None
    paper = cairn.segment(sample.left, sample.right, sample.calibration, preset="paper")
    assert paper.superpixels is None and paper.groups is None
    for made in (frame.superpixels, frame.groups, paper.by_intensity, paper.by_disparity, paper.fusion):
        assert made.labels.dtype == np.int32 and made.labels.max() == len(made) - 1
    assert frame.overlay().dtype == np.uint8 and frame.overlay().shape[2] == 3


def test_arrays_that_stages_rely_on_are_read_only(sample):
    for array in (sample.frame.disparity, sample.frame.objects_map, sample.frame.groups.labels):
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 1
        with pytest.raises(ValueError):
            array.flags.writeable = True
        array.copy()[0, 0] = 1
    refined = cairn.refine_subpixel(cairn.match(sample.left, sample.right, num_disparities=8))
    refined[0, 0] = 3  # a separate array


def test_a_frame_releases_the_left_image_when_it_is_deleted(sample):
    left, right = sample.gray()
    kept, unkept = weakref.ref(left), weakref.ref(right)
    frame = cairn.segment(left, right)
    del left, right
    gc.collect()
    assert kept() is not None and unkept() is None
    frame.overlay()
    del frame
    gc.collect()
    assert kept() is None


def test_memory_does_not_grow_with_the_number_of_frames(sample):
    def resident():
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * mmap.PAGESIZE

    left, right = sample.left[80:160], sample.right[80:160]
    for _ in range(10):
        cairn.segment(left, right, match={"num_disparities": 8})
    before = resident()
    for _ in range(60):
        frame = cairn.segment(left, right, match={"num_disparities": 8})
        frame.disparity, frame.groups.labels, frame._repr_png_(), frame.disparity_view()
    per_frame = sample.left[80:160].nbytes * 10
    assert resident() - before < 30 * per_frame


def test_the_helper_gray_of_equals_the_library(sample):
    colour = np.random.default_rng(1).integers(0, 256, (20, 40, 3)).astype(np.uint8)
    np.testing.assert_array_equal(
        cairn.gradient(gray_of(colour), 1.0), cairn.gradient(colour, 1.0)
    )
