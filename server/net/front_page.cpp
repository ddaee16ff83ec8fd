#include "server/net/front_page.h"

#include <fmt/format.h>
#include <openssl/evp.h>
#include <zlib.h>

#include "server/net/oembed.h"
#include "server/net/picture_http.h"
#include "server/net/web_pages.h"
#include "server/tile/picture_encode.h"

namespace mirage {
namespace {

// Windows up to twice as wide as high show the whole height of the wide one, as the program does;
// phones are about half as wide as high.
constexpr std::uint32_t kLongEdge = 800, kShortEdge = 400;
// With the rest of the page, these bytes arrive within two round trips of a new connection.
constexpr std::size_t kPosterBytes = 32'000;

void put_at(std::string& page, const std::string& place, const std::string& text) {
  const std::size_t at = page.find(place);
  if (at != std::string::npos) page.replace(at, place.size(), text);
}

std::string base64(const Bytes& bytes) {
  std::string out((bytes.size() + 2) / 3 * 4 + 1, '\0');  // OpenSSL ends it with a zero
  const int n = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(out.data()), bytes.data(),
                                static_cast<int>(bytes.size()));
  out.resize(static_cast<std::size_t>(n));
  return out;
}

/// Returns what sites and messengers show of a link: Open Graph (ogp.me) and oEmbed.
std::string head_of(const std::string& address) {
  const std::string at = escaped(address);
  return fmt::format(
      R"(<meta property="og:type" content="website">
<meta property="og:title" content="{0}">
<meta property="og:url" content="{1}/">
<meta property="og:image" content="{1}{2}?size=1200x630&amp;format=jpeg">
<meta property="og:image:width" content="1200">
<meta property="og:image:height" content="630">
<meta name="twitter:card" content="summary_large_image">
<link rel="alternate" type="application/json+oembed" href="{3}" title="{0}">)",
      kPageTitle, at, kPicturePath, escaped(oembed_address(address)));
}

}  // namespace

PosterShape poster_shape(const std::string& user_agent) {
  // Browsers of phones say Mobi, Mobile or Mobile Safari.
  return user_agent.find("Mobi") != std::string::npos ? PosterShape::kTall : PosterShape::kWide;
}

PictureRequest poster_request(PosterShape shape) {
  const bool tall = shape == PosterShape::kTall;
  PictureRequest out;
  out.camera.width = tall ? kShortEdge : kLongEdge;
  out.camera.height = tall ? kLongEdge : kShortEdge;
  out.format = PictureFormat::kImpostor;
  out.most_bytes = kPosterBytes;
  out.idle = true;
  return out;
}

std::string front_page(const std::string& page, const std::string& address, PosterShape shape,
                       const std::shared_ptr<const Bytes>& poster) {
  std::string out = page, image;
  if (poster) {
    const Camera camera = poster_request(shape).camera;
    image = fmt::format(
        R"(<div id="poster" hidden><img width="{}" height="{}" alt="" src="data:{};base64,{}"></div>)",
        camera.width, camera.height, media_type(PictureFormat::kImpostor), base64(*poster));
  }
  put_at(out, "<!--head-->", address.empty() ? "" : head_of(address));
  put_at(out, "<!--poster-->", image);
  return out;
}

std::string gzipped(const std::string& text) {
  constexpr int kGzip = 16;  // added to the window's bits, it asks for gzip's header
  z_stream stream{};
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, MAX_WBITS + kGzip, MAX_MEM_LEVEL,
                   Z_DEFAULT_STRATEGY) != Z_OK) {
    return {};
  }
  std::string out(deflateBound(&stream, text.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const bool whole = deflate(&stream, Z_FINISH) == Z_STREAM_END;
  out.resize(whole ? stream.total_out : 0);
  deflateEnd(&stream);
  return out;
}

}  // namespace mirage
