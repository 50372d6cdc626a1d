// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>
#include <string_view>

/// Tiny files, in base64, of formats that the library reads but does not write. Unless stated otherwise they
/// have 5x3 pixels: grey 17·i, colour (17·i, 255 − 17·i, 40), 16 bits 4369·i, palette indices i mod 4, for
/// the i-th pixel in raster order.
namespace cairn::support {

// colours (0,0,0) (255,0,0) (0,255,0) (10,20,30), the first transparent
inline constexpr std::string_view kPalettePng =
    "iVBORw0KGgoAAAANSUhEUgAAAAUAAAADCAMAAABs6DXKAAAADFBMVEUAAAD/AAAA/wAKFB5v9JOxAAAAAXRSTlMAQObYZgAA"
    "ABRJREFUeNpjYGBkYmYAE4wMIIIJAADFABaLOWRQAAAAAElFTkSuQmCC";
// i mod 2
inline constexpr std::string_view kOneBitPng =
    "iVBORw0KGgoAAAANSUhEUgAAAAUAAAADAQAAAABzTfhVAAAADklEQVR42mMIYFjBEAAAA94BSWqoxpcAAAAASUVORK5CYII=";
inline constexpr std::string_view kGreyAlphaPng =
    "iVBORw0KGgoAAAANSUhEUgAAAAUAAAADCAQAAADxPw1zAAAAKUlEQVR42mNgYBdkV2I3ZndhZwhlT2MvZ+9gn8nOsIp9N/sZ"
    "9rvs79gBVLgHY2F9UGYAAAAASUVORK5CYII=";
// blue 0x2828
inline constexpr std::string_view kColourAlpha16Png =
    "iVBORw0KGgoAAAANSUhEUgAAAAUAAAADEAYAAAALphm7AAAAXElEQVR42h3KMREAMQgFUSxgIdX1WMACCm4mFmIBC1jAQixg"
    "IRawkJt/1dtiieje56GXuRuOcQ4UqYKqe0Myy0TMGQHXcofua8GIOf8x0wyxtyqsEoHnjAG7meEH1J0oYEv0CQkAAAAASUVO"
    "RK5CYII=";
inline constexpr std::string_view kInterlacedPng =
    "iVBORw0KGgoAAAANSUhEUgAAAAUAAAADCAAAAAEJWqqyAAAAHklEQVR42mNgYHBhUGJYdeYdg6Axw+67DKFp5R0zAT2DBvoh"
    "OaqfAAAAAElFTkSuQmCC";
// every checksum is right, but the compressed data have only one row
inline constexpr std::string_view kShortDataPng =
    "iVBORw0KGgoAAAANSUhEUgAAAAUAAAADCAAAAAB+XZokAAAAC0lEQVR42mNgAAMAAAcAASEi2xMAAAAASUVORK5CYII=";
// claims 60000x60000
inline constexpr std::string_view kHugePng =
    "iVBORw0KGgoAAAANSUhEUgAA6mAAAOpgCAAAAACluSqeAAAAC0lEQVR42mNggAEAAAoAAewkA7kAAAAASUVORK5CYII=";
// claims 16000x16000 in a few bytes
inline constexpr std::string_view kBombPng =
    "iVBORw0KGgoAAAANSUhEUgAAPoAAAD6ACAAAAABkFYACAAAAC0lEQVR42mNggAEAAAoAAewkA7kAAAAASUVORK5CYII=";
// a colour profile that libpng warns about
inline constexpr std::string_view kWarningPng =
    "iVBORw0KGgoAAAANSUhEUgAAAAUAAAADCAAAAAB+XZokAAAAEWlDQ1B4AAB4nMvLzytOBSIAD30DaiGEbyoAAAAaSURBVHja"
    "Y2AQVDJ2YQhNK++YybBq95m77wAo6Qb6z6tdKAAAAABJRU5ErkJggg==";
// 9x7, all 90
inline constexpr std::string_view kGreyJpeg =
    "/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDAAMCAgMCAgMDAwMEAwMEBQgFBQQEBQoHBwYIDAoMDAsKCwsNDhIQDQ4RDgsLEBYQ"
    "ERMUFRUVDA8XGBYUGBIUFRT/wAALCAAHAAkBAREA/8QAHwAAAQUBAQEBAQEAAAAAAAAAAAECAwQFBgcICQoL/8QAtRAAAgED"
    "AwIEAwUFBAQAAAF9AQIDAAQRBRIhMUEGE1FhByJxFDKBkaEII0KxwRVS0fAkM2JyggkKFhcYGRolJicoKSo0NTY3ODk6Q0RF"
    "RkdISUpTVFVWV1hZWmNkZWZnaGlqc3R1dnd4eXqDhIWGh4iJipKTlJWWl5iZmqKjpKWmp6ipqrKztLW2t7i5usLDxMXGx8jJ"
    "ytLT1NXW19jZ2uHi4+Tl5ufo6erx8vP09fb3+Pn6/9oACAEBAAA/APGqK//Z";
// 9x7, all about (200, 100, 50)
inline constexpr std::string_view kProgressiveJpeg =
    "/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDAAIBAQEBAQIBAQECAgICAgQDAgICAgUEBAMEBgUGBgYFBgYGBwkIBgcJBwYGCAsI"
    "CQoKCgoKBggLDAsKDAkKCgr/2wBDAQICAgICAgUDAwUKBwYHCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoK"
    "CgoKCgoKCgoKCgoKCgr/wgARCAAHAAkDASIAAhEBAxEB/8QAFQABAQAAAAAAAAAAAAAAAAAAAAT/xAAUAQEAAAAAAAAAAAAA"
    "AAAAAAAH/9oADAMBAAIQAxAAAAGcFbZ//8QAFBABAAAAAAAAAAAAAAAAAAAAEP/aAAgBAQABBQI//8QAFBEBAAAAAAAAAAAA"
    "AAAAAAAAAP/aAAgBAwEBPwF//8QAFBEBAAAAAAAAAAAAAAAAAAAAAP/aAAgBAgEBPwF//8QAFBABAAAAAAAAAAAAAAAAAAAA"
    "EP/aAAgBAQAGPwI//8QAFBABAAAAAAAAAAAAAAAAAAAAEP/aAAgBAQABPyE//9oADAMBAAIAAwAAABAD/8QAFBEBAAAAAAAA"
    "AAAAAAAAAAAAAP/aAAgBAwEBPxB//8QAFBEBAAAAAAAAAAAAAAAAAAAAAP/aAAgBAgEBPxB//8QAFBABAAAAAAAAAAAAAAAA"
    "AAAAEP/aAAgBAQABPxA//9k=";
// 9x7
inline constexpr std::string_view kCmykJpeg =
    "/9j/7gAOQWRvYmUAZAAAAAAA/9sAQwAQCwwODAoQDg0OEhEQExgoGhgWFhgxIyUdKDozPTw5Mzg3QEhcTkBEV0U3OFBtUVdf"
    "YmdoZz5NcXlwZHhcZWdj/8AAFAgABwAJBEMRAE0RAFkRAEsRAP/EABcAAQEBAQAAAAAAAAAAAAAAAAAGBAf/xAAUEAEAAAAA"
    "AAAAAAAAAAAAAAAA/9oADgRDAE0AWQBLAAA/AKRhTDoAA//Z";

inline std::string decoded(std::string_view base64) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0;
  int count = 0;
  for (const char digit : base64.substr(0, base64.find('='))) {
    bits = (bits << 6 | static_cast<unsigned>(kDigits.find(digit))) & 0xFFFFU;
    if ((count += 6) < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 0xFFU);
  }
  return bytes;
}

}  // namespace cairn::support
