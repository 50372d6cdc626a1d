// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
// jpeglib.h requires the next two headers
#include <cstddef>
#include <cstdio>

#include <jerror.h>
#include <jpeglib.h>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/io/raster.hpp>
#include <cerrno>
#include <csetjmp>
#include <exception>
#include <string>
#include <utility>

// libjpeg is used directly because OpenCV only prints a warning for a truncated file, and fills the rest with
// grey.
namespace cairn::io {
namespace {

struct Complaints {
  jpeg_error_mgr manager{};  // first member, so that libjpeg's pointer to it also points to this
  std::jmp_buf way_out{};
  char text[JMSG_LENGTH_MAX] = {};
};

void complain(j_common_ptr jpeg) {
  auto* complaints = reinterpret_cast<Complaints*>(jpeg->err);
  complaints->manager.format_message(jpeg, complaints->text);
  std::longjmp(complaints->way_out, 1);
}
/// A warning (level −1) means invented pixels, except the one about an unusual Adobe marker.
void judge(j_common_ptr jpeg, int level) {
  if (level < 0 && jpeg->err->msg_code != JWRN_ADOBE_XFORM) complain(jpeg);
}
void keep_quiet(j_common_ptr) {}

jpeg_error_mgr* prepared(Complaints& complaints) {
  errno = 0;
  jpeg_std_error(&complaints.manager);
  complaints.manager.error_exit = complain;
  complaints.manager.emit_message = judge;
  complaints.manager.output_message = keep_quiet;
  return &complaints.manager;
}

struct Reader {
  Reader() { jpeg.err = prepared(complaints); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader() { jpeg_destroy_decompress(&jpeg); }
  jpeg_decompress_struct jpeg{};
  Complaints complaints;
};

/// Destination in memory. libjpeg's own (jpeg_mem_dest) leaves a dangling pointer if a reallocation fails.
struct Destination {
  jpeg_destination_mgr manager{};  // first member, so that libjpeg's pointer to it also points to this
  std::string file;
};

Destination& destination(j_compress_ptr jpeg) {
  return *reinterpret_cast<Destination*>(jpeg->dest);
}
/// Grows the buffer beyond `used` bytes. No exception may cross libjpeg, and no destructor its longjmp.
void make_room(j_compress_ptr jpeg, std::size_t used) {
  constexpr std::size_t kMin = std::size_t{1} << 16;
  bool has_room = true;
  try {
    destination(jpeg).file.resize(std::max(kMin, 2 * used));
  } catch (const std::exception&) {
    has_room = false;
  }
  if (!has_room) {
    errno = ENOMEM;
    ERREXIT1(jpeg, JERR_OUT_OF_MEMORY, 0);
  }
  Destination& to = destination(jpeg);
  to.manager.next_output_byte = reinterpret_cast<JOCTET*>(to.file.data()) + used;
  to.manager.free_in_buffer = to.file.size() - used;
}
void begin_file(j_compress_ptr jpeg) {
  make_room(jpeg, 0);
}
boolean grow_file(j_compress_ptr jpeg) {
  make_room(jpeg, destination(jpeg).file.size());  // libjpeg calls this when the buffer is full
  return TRUE;
}
void end_file(j_compress_ptr jpeg) {
  Destination& to = destination(jpeg);
  to.file.resize(to.file.size() - to.manager.free_in_buffer);
}

struct Writer {
  Writer() {
    jpeg.err = prepared(complaints);
    to.manager.init_destination = begin_file;
    to.manager.empty_output_buffer = grow_file;
    to.manager.term_destination = end_file;
  }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer() { jpeg_destroy_compress(&jpeg); }
  jpeg_compress_struct jpeg{};
  Destination to;
  Complaints complaints;
};

/// Runs `steps`, which must own nothing, since libjpeg leaves it by longjmp; the caller owns all objects.
/// False if libjpeg failed other than by lack of memory.
template <class Steps>
bool succeeds(Complaints& complaints, const Steps& steps) {
  if (setjmp(complaints.way_out) != 0) {  // NOLINT(cert-err52-cpp): libjpeg's only way out
    check_memory();
    return false;
  }
  steps();
  return true;
}

void run(Reader& reader, const auto& steps) {
  if (!succeeds(reader.complaints, steps)) {
    throw Error(std::string("is a truncated or damaged JPEG: ") + reader.complaints.text);
  }
}

/// Each block of 8x8 samples takes at least one bit, so a short file that claims a huge size is rejected
/// before memory is allocated. Arithmetic coding, which is rare, may take less.
void check_plausible(const jpeg_decompress_struct& jpeg, std::size_t file_bytes) {
  const auto samples = std::size_t{jpeg.image_width} * jpeg.image_height;
  if (jpeg.arith_code || samples / 64 / 8 <= file_bytes) return;
  throw Error("is a truncated or damaged JPEG: " + std::to_string(file_bytes) + " bytes cannot hold " +
              std::to_string(jpeg.image_width) + "x" + std::to_string(jpeg.image_height) + " pixels");
}

}  // namespace

Raster decode_jpeg(std::string_view file) {
  Reader reader;
  jpeg_decompress_struct& jpeg = reader.jpeg;
  run(reader, [&] {
    jpeg_create_decompress(&jpeg);
    jpeg_mem_src(&jpeg, reinterpret_cast<const unsigned char*>(file.data()), file.size());
    jpeg_read_header(&jpeg, TRUE);
  });
  check_sides(jpeg.image_width, jpeg.image_height);
  if (jpeg.num_components != 1 && jpeg.num_components != 3) {
    throw Error("is a JPEG with " + std::to_string(jpeg.num_components) +
                " channels, expected 1 (grey) or 3 (colour)");
  }
  check_plausible(jpeg, file.size());
  Raster raster;
  raster.size = {static_cast<int>(jpeg.image_width), static_cast<int>(jpeg.image_height)};
  raster.channels = jpeg.num_components;
  const auto step = static_cast<std::size_t>(raster.row_length());
  raster.bytes.resize(step * jpeg.image_height);
  run(reader, [&] {
    jpeg.out_color_space = raster.channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
    jpeg_start_decompress(&jpeg);
    while (jpeg.output_scanline < jpeg.output_height) {
      JSAMPROW row = raster.bytes.data() + jpeg.output_scanline * step;
      jpeg_read_scanlines(&jpeg, &row, 1);
    }
    jpeg_finish_decompress(&jpeg);
  });
  return raster;
}

std::string encode_jpeg(const PixelRows& rows, int quality) {
  Writer writer;
  jpeg_compress_struct& jpeg = writer.jpeg;
  const auto steps = [&] {
    jpeg_create_compress(&jpeg);
    jpeg.dest = &writer.to.manager;
    jpeg.image_width = static_cast<JDIMENSION>(rows.size.width);
    jpeg.image_height = static_cast<JDIMENSION>(rows.size.height);
    jpeg.input_components = rows.channels;
    jpeg.in_color_space = rows.channels == 3 ? JCS_RGB : JCS_GRAYSCALE;
    jpeg_set_defaults(&jpeg);
    jpeg_set_quality(&jpeg, quality, TRUE);
    jpeg_start_compress(&jpeg, TRUE);
    for (int y = 0; y < rows.size.height; ++y) {
      // libjpeg lacks const here; it only reads these rows.
      auto* row = const_cast<JSAMPROW>(rows.first + y * rows.stride_bytes);
      jpeg_write_scanlines(&jpeg, &row, 1);
    }
    jpeg_finish_compress(&jpeg);
  };
  if (!succeeds(writer.complaints, steps)) {
    throw Error(std::string("cannot be encoded as JPEG: ") + writer.complaints.text);
  }
  return std::move(writer.to.file);
}

}  // namespace cairn::io
