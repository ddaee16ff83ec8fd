// The module libmirage_video.so: the video codec on libavcodec and x264.

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "client/report/video_codec.h"
#include "protocol/base/quantile.h"

namespace mirage {
namespace {

struct Free {
  void operator()(AVCodecContext* p) const { avcodec_free_context(&p); }
  void operator()(AVFrame* p) const { av_frame_free(&p); }
  void operator()(AVPacket* p) const { av_packet_free(&p); }
  void operator()(SwsContext* p) const { sws_freeContext(p); }
};
using ContextPtr = std::unique_ptr<AVCodecContext, Free>;
using FramePtr = std::unique_ptr<AVFrame, Free>;
using PacketPtr = std::unique_ptr<AVPacket, Free>;
using ScalerPtr = std::unique_ptr<SwsContext, Free>;

constexpr const char* kQuality = "4";  // constant rate factor: better than the eye can see
constexpr double kRateShare = 0.95;    // the rest is headers and what the buffer overshoots

double since_ms(std::chrono::steady_clock::time_point began) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began)
      .count();
}

int even(int size) { return size + size % 2; }  // 4:2:0 halves both sides

Error codec_error(const char* what, int code) {
  char text[AV_ERROR_MAX_STRING_SIZE] = {};
  av_strerror(code, text, sizeof(text));
  return make_error(ErrorId::kCodec, fmt::format("{}: {}", what, text));
}

Result<ContextPtr> open_encoder(int width, int height, double fps, double rate_mbps) {
  const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
  if (!codec) return make_error(ErrorId::kCodec, "libavcodec was built without x264");
  ContextPtr c(avcodec_alloc_context3(codec));
  c->width = even(width);
  c->height = even(height);
  c->pix_fmt = AV_PIX_FMT_YUV420P;
  c->time_base = {1000, static_cast<int>(std::lround(fps * 1000))};
  c->framerate = {static_cast<int>(std::lround(fps * 1000)), 1000};
  c->colorspace = AVCOL_SPC_BT709;
  c->color_range = AVCOL_RANGE_MPEG;
  // The best quality below the link's rate; a mean rate alone is approached too slowly.
  c->rc_max_rate = std::llround(kRateShare * rate_mbps * 1e6);
  c->rc_buffer_size = static_cast<int>(std::lround(static_cast<double>(c->rc_max_rate) / fps));
  c->gop_size = 1 << 20;  // one key frame: the link delivers everything
  c->max_b_frames = 0;
  c->thread_count = 1;  // the same bytes on every machine
  av_opt_set(c->priv_data, "crf", kQuality, 0);
  av_opt_set(c->priv_data, "preset", "veryfast", 0);
  av_opt_set(c->priv_data, "tune", "zerolatency", 0);
  if (const int bad = avcodec_open2(c.get(), codec, nullptr); bad < 0) {
    return codec_error("x264 does not open", bad);
  }
  return c;
}

Result<ContextPtr> open_decoder() {
  const AVCodec* codec = avcodec_find_decoder(AV_CODEC_ID_H264);
  if (!codec) return make_error(ErrorId::kCodec, "libavcodec was built without an H.264 decoder");
  ContextPtr c(avcodec_alloc_context3(codec));
  c->flags |= AV_CODEC_FLAG_LOW_DELAY;
  c->thread_count = 1;
  if (const int bad = avcodec_open2(c.get(), codec, nullptr); bad < 0) {
    return codec_error("the H.264 decoder does not open", bad);
  }
  return c;
}

ScalerPtr scaler(int width, int height, AVPixelFormat from, AVPixelFormat to) {
  ScalerPtr s(sws_getContext(width, height, from, width, height, to,
                             SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT, nullptr, nullptr,
                             nullptr));
  const int* bt709 = sws_getCoefficients(SWS_CS_ITU709);
  const int full_in = from == AV_PIX_FMT_RGBA, full_out = to == AV_PIX_FMT_RGBA;
  if (s) sws_setColorspaceDetails(s.get(), bt709, full_in, bt709, full_out, 0, 1 << 16, 1 << 16);
  return s;
}

class Coder {
 public:
  Result<void> open(int width, int height, double fps, double rate_mbps);
  Result<CodedFrame> code(const std::uint8_t* rgba, std::int64_t number);
  std::vector<double> encode_ms, decode_ms;

 private:
  Result<void> encode(const std::uint8_t* rgba, std::int64_t number);
  Result<void> decode();

  int width_ = 0, height_ = 0;
  ContextPtr encoder_, decoder_;
  ScalerPtr to_yuv_, to_rgb_;
  FramePtr yuv_, decoded_;
  PacketPtr packet_;
  std::vector<std::uint8_t> padded_;
};

Result<void> Coder::open(int width, int height, double fps, double rate_mbps) {
  width_ = width;
  height_ = height;
  Result<ContextPtr> encoder = open_encoder(width, height, fps, rate_mbps);
  if (!encoder) return encoder.error();
  Result<ContextPtr> decoder = open_decoder();
  if (!decoder) return decoder.error();
  encoder_ = encoder.take();
  decoder_ = decoder.take();
  const int w = even(width), h = even(height);
  to_yuv_ = scaler(w, h, AV_PIX_FMT_RGBA, AV_PIX_FMT_YUV420P);
  to_rgb_ = scaler(w, h, AV_PIX_FMT_YUV420P, AV_PIX_FMT_RGBA);
  yuv_.reset(av_frame_alloc());
  decoded_.reset(av_frame_alloc());
  packet_.reset(av_packet_alloc());
  yuv_->format = AV_PIX_FMT_YUV420P;
  yuv_->width = w;
  yuv_->height = h;
  if (!to_yuv_ || !to_rgb_ || av_frame_get_buffer(yuv_.get(), 0) < 0) {
    return make_error(ErrorId::kCodec, "no buffers for video frames");
  }
  padded_.resize(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * 4);
  return {};
}

Result<void> Coder::encode(const std::uint8_t* rgba, std::int64_t number) {
  const int w = even(width_), h = even(height_);
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const std::size_t from =
          static_cast<std::size_t>(std::min(y, height_ - 1)) * static_cast<std::size_t>(width_) +
          static_cast<std::size_t>(std::min(x, width_ - 1));
      std::copy_n(rgba + 4 * from, 4,
                  &padded_[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(w) +
                                static_cast<std::size_t>(x))]);
    }
  }
  const auto began = std::chrono::steady_clock::now();
  const std::uint8_t* planes[] = {padded_.data()};
  const int strides[] = {4 * w};
  if (av_frame_make_writable(yuv_.get()) < 0) {
    return make_error(ErrorId::kCodec, "no buffer for a video frame");
  }
  sws_scale(to_yuv_.get(), planes, strides, 0, h, yuv_->data, yuv_->linesize);
  yuv_->pts = number;
  if (const int bad = avcodec_send_frame(encoder_.get(), yuv_.get()); bad < 0) {
    return codec_error("encoding", bad);
  }
  if (const int bad = avcodec_receive_packet(encoder_.get(), packet_.get()); bad < 0) {
    return codec_error("encoding without delay", bad);
  }
  encode_ms.push_back(since_ms(began));
  return {};
}

Result<void> Coder::decode() {
  if (const int bad = avcodec_send_packet(decoder_.get(), packet_.get()); bad < 0) {
    return codec_error("decoding", bad);
  }
  if (const int bad = avcodec_receive_frame(decoder_.get(), decoded_.get()); bad < 0) {
    return codec_error("decoding without delay", bad);
  }
  return {};
}

Result<CodedFrame> Coder::code(const std::uint8_t* rgba, std::int64_t number) {
  if (Result<void> encoded = encode(rgba, number); !encoded) return encoded.error();
  const auto began = std::chrono::steady_clock::now();
  if (Result<void> decoded = decode(); !decoded) return decoded.error();
  const int w = even(width_), h = even(height_);
  std::uint8_t* planes[] = {padded_.data()};
  const int strides[] = {4 * w};
  sws_scale(to_rgb_.get(), decoded_->data, decoded_->linesize, 0, h, planes, strides);
  decode_ms.push_back(since_ms(began));
  CodedFrame out;
  out.bytes = static_cast<std::size_t>(packet_->size);
  const std::size_t row = static_cast<std::size_t>(width_) * 4;
  for (int y = 0; y < height_; ++y) {
    const auto at = padded_.begin() + static_cast<std::ptrdiff_t>(y) * 4 * w;
    out.rgba.insert(out.rgba.end(), at, at + static_cast<std::ptrdiff_t>(row));
  }
  for (std::size_t i = 3; i < out.rgba.size(); i += 4) out.rgba[i] = 255;
  av_packet_unref(packet_.get());
  return out;
}

Result<CodedVideo> code(const std::vector<const std::uint8_t*>& frames, int width, int height,
                        double fps, double rate_mbps) {
  av_log_set_level(AV_LOG_ERROR);
  Coder coder;
  if (Result<void> open = coder.open(width, height, fps, rate_mbps); !open) return open.error();
  CodedVideo video;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    Result<CodedFrame> frame = coder.code(frames[i], static_cast<std::int64_t>(i));
    if (!frame) return frame.error();
    video.frames.push_back(frame.take());
  }
  video.encode_ms = quantile(coder.encode_ms, 0.5);
  video.decode_ms = quantile(coder.decode_ms, 0.5);
  return video;
}

}  // namespace
}  // namespace mirage

extern "C" __attribute__((visibility("default"))) void mirage_code_video_1(
    const std::vector<const std::uint8_t*>& frames, int width, int height, double fps,
    double rate_mbps, mirage::Result<mirage::CodedVideo>& out) {
  out = mirage::code(frames, width, height, fps, rate_mbps);
}
