// SPDX-License-Identifier: Apache-2.0
// Khronos glTF 2.0 specification, sections 3.6 (binary data) and 4.4 (GLB).
#include "io/gltf_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

#include "core/error.hpp"

namespace palpate::io {
namespace {

using nlohmann::json;

constexpr int kMaxDepth = 64;                      // nesting of the JSON; real files stay below 16
constexpr std::size_t kMaxJsonValues = 4'000'000;  // bounds the memory of a hostile file
constexpr std::uint64_t kMaxInteger = std::uint64_t{1} << 40;  // no sum or product below overflows

struct TooMuch {
  const char* what;
};

std::optional<std::string> decode_base64(std::string_view text) {
  std::string out;
  out.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int held = 0;
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  for (const char c : text) {
    int v;
    if (c >= 'A' && c <= 'Z')
      v = c - 'A';
    else if (c >= 'a' && c <= 'z')
      v = c - 'a' + 26;
    else if (c >= '0' && c <= '9')
      v = c - '0' + 52;
    else if (c == '+' || c == '/')
      v = c == '+' ? 62 : 63;
    else
      return std::nullopt;
    bits = (bits << 6 | static_cast<std::uint32_t>(v)) & 0xffffff;
    held += 6;
    if (held >= 8) {
      held -= 8;
      out.push_back(static_cast<char>(bits >> held & 0xff));
    }
  }
  return out;
}

std::optional<std::string> decode_percent(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out.push_back(text[i]);
      continue;
    }
    unsigned value = 0;
    if (i + 2 >= text.size()) return std::nullopt;
    const auto [stop, error] = std::from_chars(&text[i + 1], &text[i + 1] + 2, value, 16);
    if (error != std::errc() || stop != &text[i + 1] + 2) return std::nullopt;
    out.push_back(static_cast<char>(value));
    i += 2;
  }
  return out;
}

/// Extensions that a file may require and that do not change where its vertices lie.
bool harmless(std::string_view extension) {
  return extension == "KHR_mesh_quantization" || extension == "KHR_texture_transform" ||
         extension == "KHR_texture_basisu" || extension == "EXT_texture_webp" ||
         extension == "KHR_lights_punctual" || extension.starts_with("KHR_materials_");
}

}  // namespace

double GltfAccessor::value(std::size_t element, int component) const {
  const char* at = data + element * stride + static_cast<std::size_t>(component) * byte_size(type);
  const double raw = load_scalar(at, type, false);
  if (!normalized) return raw;
  switch (type) {
    case ScalarType::i8:
      return std::max(raw / 127, -1.0);
    case ScalarType::u8:
      return raw / 255;
    case ScalarType::i16:
      return std::max(raw / 32767, -1.0);
    case ScalarType::u16:
      return raw / 65535;
    default:
      return raw;
  }
}

void GltfDocument::fail(std::string_view where, std::string_view what) const {
  source_.fail(where, what, "the file is cut or damaged; export it again");
}

GltfDocument GltfDocument::from_glb(const Source& source) {
  GltfDocument document(source);
  const std::string_view bytes = source.bytes;
  if (bytes.size() < 20 || !bytes.starts_with("glTF")) document.fail("header", "not a GLB file");
  if (const auto version = load<std::uint32_t>(bytes.data() + 4); version != 2)
    source.fail("header", fmt::format("glTF version {} is not read", version), "export glTF 2.0");
  if (const auto length = load<std::uint32_t>(bytes.data() + 8); length != bytes.size())
    document.fail("header",
                  fmt::format("announces {} bytes but the file has {}", length, bytes.size()));
  std::string_view text, binary;
  std::size_t at = 12;
  for (int chunk = 0; at < bytes.size(); ++chunk) {
    const std::string where = fmt::format("chunk {}", chunk);
    if (bytes.size() - at < 8) document.fail(where, "its header is cut");
    const std::size_t length = load<std::uint32_t>(bytes.data() + at);
    const std::string_view kind = bytes.substr(at + 4, 4);
    at += 8;
    if (length > bytes.size() - at)
      document.fail(where,
                    fmt::format("announces {} bytes but {} are left", length, bytes.size() - at));
    const std::string_view content = bytes.substr(at, length);
    at += length;
    if ((chunk == 0) != (kind == "JSON")) document.fail(where, "the JSON chunk must be the first");
    if (chunk == 0) text = content;
    if (chunk == 1 && kind == std::string_view("BIN\0", 4)) binary = content;
  }
  document.parse_json(text);
  document.load_buffers(binary);
  return document;
}

GltfDocument GltfDocument::from_gltf(const Source& source) {
  GltfDocument document(source);
  document.parse_json(source.bytes);
  document.load_buffers({});
  return document;
}

void GltfDocument::parse_json(std::string_view text) {
  std::size_t values = 0;
  const auto guard = [&values](int depth, json::parse_event_t, json&) {
    if (depth > kMaxDepth) throw TooMuch{"nested more than 64 levels deep"};
    if (++values > kMaxJsonValues) throw TooMuch{"more than 4 million values"};
    return true;
  };
  try {
    json_ = json::parse(text.begin(), text.end(), guard);
  } catch (const json::exception& error) {
    std::string what = error.what();
    std::replace_if(
        what.begin(), what.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    fail("JSON", what.substr(0, 160));
  } catch (const TooMuch& limit) {
    source_.fail("JSON", limit.what, "export the mesh alone");
  }
  if (!json_.is_object()) fail("JSON", "is not an object");
  const auto asset = json_.find("asset");
  if (asset == json_.end() || !asset->is_object()) fail("JSON", "has no 'asset'");
  const auto version = asset->find("version");
  if (version == asset->end() || !version->is_string() ||
      !version->get_ref<const std::string&>().starts_with("2."))
    source_.fail("asset", "is not glTF 2", "export glTF 2.0");
  const auto required = json_.find("extensionsRequired");
  if (required == json_.end()) return;
  if (!required->is_array()) fail("extensionsRequired", "is not an array");
  for (const json& name : *required)
    if (!name.is_string() || !harmless(name.get_ref<const std::string&>()))
      source_.fail(
          "extensionsRequired",
          fmt::format("the file needs {}, which is not read",
                      name.is_string() ? in_quotes(name.get_ref<const std::string&>()) : "?"),
          "export without compression");
}

const json& GltfDocument::entry(std::string_view array, std::uint64_t index) const {
  const auto found = json_.find(array);
  if (found == json_.end() || !found->is_array() || index >= found->size())
    fail(fmt::format("{}[{}]", array, index), "is referred to but not there");
  const json& item = (*found)[index];
  if (!item.is_object()) fail(fmt::format("{}[{}]", array, index), "is not an object");
  return item;
}

std::uint64_t GltfDocument::integer(const json& object, std::string_view key,
                                    std::string_view where) const {
  const auto found = object.find(key);
  if (found == object.end()) fail(where, fmt::format("has no '{}'", key));
  if (!found->is_number_unsigned() || found->get<std::uint64_t>() > kMaxInteger)
    fail(where, fmt::format("'{}' is not a whole number in range", key));
  return found->get<std::uint64_t>();
}

std::uint64_t GltfDocument::integer(const json& object, std::string_view key,
                                    std::string_view where, std::uint64_t missing) const {
  return object.contains(key) ? integer(object, key, where) : missing;
}

std::string GltfDocument::load_uri(const std::string& uri, const std::string& where) {
  constexpr std::string_view kBase64 = ";base64,";
  if (uri.starts_with("data:")) {
    const std::size_t comma = uri.find(kBase64);
    auto bytes = comma < 200 ? decode_base64(std::string_view(uri).substr(comma + kBase64.size()))
                             : std::nullopt;
    if (!bytes) fail(where, "its data URI is not base64");
    return std::move(*bytes);
  }
  const auto name = decode_percent(uri);
  if (!name || name->empty() || name->find(':') != std::string::npos ||
      name->find('\0') != std::string::npos || name->front() == '/' || name->front() == '\\' ||
      name->find("..") != std::string::npos)
    source_.fail(where, fmt::format("{} is not a file beside the scan", in_quotes(uri)),
                 "export as GLB, one self-contained file");
  return load_bytes(source_.folder / *name);
}

void GltfDocument::load_buffers(std::string_view binary_chunk) {
  const auto list = json_.find("buffers");
  if (list == json_.end()) return;
  if (!list->is_array()) fail("buffers", "is not an array");
  constexpr std::size_t kMaxBuffers = 1000;
  if (list->size() > kMaxBuffers) source_.fail("buffers", "more than 1000", "export as GLB");
  decoded_.reserve(list->size());
  files_.reserve(list->size());
  for (std::size_t i = 0; i < list->size(); ++i) {
    const std::string where = fmt::format("buffers[{}]", i);
    const json& buffer = entry("buffers", i);
    const std::uint64_t length = integer(buffer, "byteLength", where);
    std::string_view bytes = binary_chunk;
    if (const auto uri = buffer.find("uri"); uri != buffer.end()) {
      if (!uri->is_string()) fail(where, "'uri' is not text");
      const auto& text = uri->get_ref<const std::string&>();
      auto& store = text.starts_with("data:") ? decoded_ : files_;
      store.push_back(load_uri(text, where));
      bytes = store.back();
    } else if (i > 0) {
      fail(where, "has no 'uri'");
    }
    if (length > bytes.size())
      fail(where, fmt::format("announces {} bytes but has {}", length, bytes.size()));
    buffers_.push_back(bytes.substr(0, length));
  }
}

namespace {
std::optional<ScalarType> component_type(std::uint64_t code) {
  switch (code) {
    case 5120:
      return ScalarType::i8;
    case 5121:
      return ScalarType::u8;
    case 5122:
      return ScalarType::i16;
    case 5123:
      return ScalarType::u16;
    case 5125:
      return ScalarType::u32;
    case 5126:
      return ScalarType::f32;
    default:
      return std::nullopt;
  }
}

int component_count(const json& accessor) {
  const auto type = accessor.find("type");
  if (type == accessor.end() || !type->is_string()) return 0;
  constexpr std::array<std::string_view, 4> kTypes = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  for (std::size_t i = 0; i < kTypes.size(); ++i)
    if (type->get_ref<const std::string&>() == kTypes[i]) return static_cast<int>(i) + 1;
  return 0;
}
}  // namespace

GltfAccessor GltfDocument::accessor(std::uint64_t index) const {
  const std::string where = fmt::format("accessors[{}]", index);
  const json& item = entry("accessors", index);
  if (item.contains("sparse"))
    source_.fail(where, "sparse accessors are not read", "export without morph targets");
  const auto type = component_type(integer(item, "componentType", where));
  GltfAccessor out;
  out.components = component_count(item);
  if (!type || out.components == 0) fail(where, "has no known type");
  out.type = *type;
  if (const auto flag = item.find("normalized"); flag != item.end())
    out.normalized = flag->is_boolean() && flag->get<bool>();
  out.count = integer(item, "count", where);
  const std::uint64_t offset = integer(item, "byteOffset", where, 0);

  const std::uint64_t view_index = integer(item, "bufferView", where);
  const json& view = entry("bufferViews", view_index);
  const std::string view_where = fmt::format("bufferViews[{}]", view_index);
  const std::uint64_t buffer = integer(view, "buffer", view_where);
  if (buffer >= buffers_.size()) fail(view_where, fmt::format("buffer {} is not there", buffer));
  const std::uint64_t begin = integer(view, "byteOffset", view_where, 0);
  const std::uint64_t length = integer(view, "byteLength", view_where);
  if (begin + length > buffers_[buffer].size())
    fail(view_where, "reaches beyond the end of its buffer");

  const std::uint64_t size = byte_size(*type) * static_cast<std::uint64_t>(out.components);
  out.stride = integer(view, "byteStride", view_where, size);
  if (out.stride < size || out.stride > 65536) fail(view_where, "'byteStride' is out of range");
  if (out.count == 0 || out.count > length / size + 1 ||
      offset + (out.count - 1) * out.stride + size > length)
    fail(where, fmt::format("its {} elements reach beyond its buffer view", out.count));
  out.data = buffers_[buffer].data() + begin + offset;
  return out;
}

}  // namespace palpate::io
