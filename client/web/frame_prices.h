#pragma once
// Frame prices: learns what frames take on this device, from the graphics card's clock or from the
// pace of the display.
// Input:  the work of each drawn frame; times, as they become known.
// Output: prices of the client.
// Thread: the page's.
// Full:   it forgets the oldest frame whose time is not known.

#include <cstdint>
#include <deque>

#include "client/price/frame_work.h"
#include "protocol/impostor/camera.h"

namespace mirage {

class Client;
struct CostModel;

class FramePrices {
 public:
  /// `client` must outlive this. `display_ms` is the time between two pictures of the display.
  FramePrices(Client& client, double display_ms) : client_(client), display_ms_(display_ms) {}

  /// Notes that what compiled programs so far is no part of a frame.
  void begin();
  /// Notes that the client has drawn a new picture from this pose.
  void note_drawn(const Pose& pose);
  /// Notes that the graphics card took `ms` for this one of the last drawn frames.
  void note_gpu_ms(std::uint64_t drawn_frame, double ms);
  /// Notes that the display showed a picture `ms` after the one before; both were drawn.
  void note_interval_ms(double ms);
  /// Scales all prices: draws only a background a few times with this camera, waits for it, and
  /// compares the time.
  void probe(const Camera& camera);

  std::uint64_t drawn_frames() const { return drawn_frames_; }

 private:
  struct Drawn {
    std::uint64_t frame = 0;
    FrameWork work;
    bool compiled = false;  ///< it compiled a program
  };
  /// Frames drawn one after the other.
  struct Paced {
    int frames = 0;
    FrameWork work;
    double ms = 0;
  };
  bool rest() const;
  const CostModel& prices() const;

  Client& client_;
  double display_ms_;
  std::deque<Drawn> drawn_;
  Paced paced_;
  bool timed_ = false;  ///< the graphics card's clock can be read
  std::uint64_t drawn_frames_ = 0;
  std::uint64_t programs_ = 0;
  Pose pose_;             ///< of the last drawn frames
  int seen_from_it_ = 0;  ///< number of frames from that pose
};

}  // namespace mirage
