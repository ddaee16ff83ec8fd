#pragma once
// Modelled link: a real server behind a network that is computed, not suffered.
//
// Requests go to the server at once; its replies are held back until the model says they would
// have arrived. On virtual time the model also stands in for the server's timing (one tile every
// server_ms, worst error first) and waits for all real replies before it lets time pass, so a
// session is reproducible to the bit whatever the machine does.

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "client/link/busy_time.h"
#include "client/link/link.h"
#include "client/link/net_model.h"
#include "protocol/base/clock.h"

namespace mirage {

/// Shares of the last half second, or of the last two round trips: 0 to 1.
struct LinkUse {
  double link = 0;    ///< in which the link down transmitted; 0 where its rate is not limited
  double server = 0;  ///< in which the server was at work
};

/// A first image waits to be asked for, and yet neither is busy.
inline bool starves(bool first_waits, const LinkUse& use) {
  return first_waits && use.link < 0.8 && use.server < 0.9;
}

class ModelledLink final : public Link {
 public:
  /// `blocking`: wait for the server's replies (virtual time); `wait` blocks until the inner link
  /// has something or a while has passed, and says false when there is no hope.
  ModelledLink(Link& inner, const Clock& clock, const NetModel& model, bool blocking,
               std::function<bool()> wait);

  void send(Bytes message) override;
  std::vector<Message> receive() override;
  /// Two round trips after the inner link is.
  bool connected() const override;
  std::uint32_t generation() const override { return inner_.generation(); }
  LinkTraffic traffic() const override { return {bytes_up_, bytes_down_}; }
  /// How busy both ends of what the client waits for were till now; on virtual time only, where the
  /// server's time is the model's.
  LinkUse use();
  /// From now on the network is this one; what is on its way arrives as it would have.
  void change(const NetModel& model) {
    model_ = model;
    delays_.change(model);
  }

 private:
  struct Item {
    Message message;
    std::size_t bytes = 0;
    std::size_t left = 0;  ///< still to be transmitted
  };
  struct Ask {
    std::int64_t arrives_us = 0;  ///< at the server
    std::int64_t cancelled_us = INT64_MAX;
    float error_px = 0;
    bool view = false;
    bool made_ahead = false;  ///< a view that any server has
    bool answered = false;
    Item reply;
  };
  struct Ready {
    std::int64_t at_us = 0;  ///< at the server's socket
    bool bulk = false;
    bool view = false;  ///< goes before all that is not being transmitted
    Item item;
  };

  void note_connection(std::int64_t now_us);
  void note_sent(const Bytes& message, std::int64_t now_us);
  void ask_view(const wire::ViewRequestT& view, std::int64_t arrives_us);
  void collect_replies();
  void take_reply(Message message);
  void tell_model_times(Message& message) const;
  /// Notes what of the scene's description has come. When the server sent what is neither a tile
  /// nor asked-for geometry.
  std::int64_t note_description(const Message& message);
  bool owed() const;
  void run_server(std::int64_t now_us);
  void run_downlink(std::int64_t now_us);
  void transmit(std::deque<Item>& lane, std::int64_t start_us);

  Link& inner_;
  const Clock& clock_;
  NetModel model_;
  const bool blocking_;
  std::function<bool()> wait_;
  NetDelays delays_;
  std::map<std::uint32_t, Ask> asks_;  ///< at or on the way to the server, by request id
  /// Waiting for the downlink, by time; equal times by kind and request, whichever reply really
  /// came first.
  std::multimap<std::pair<std::int64_t, std::uint32_t>, Ready> ready_;
  std::deque<Item> tiles_lane_, bulk_lane_;
  std::deque<std::pair<std::int64_t, Message>> arrived_;
  std::vector<Message> out_of_band_;
  std::size_t owed_images_ = 0, owed_objects_ = 0;
  std::map<std::uint32_t, std::int64_t> opens_us_;  ///< requests for members, when they arrive
  bool owed_welcome_ = false;
  std::uint32_t reached_ = 0;      ///< the last connection seen
  std::int64_t connected_us_ = 0;  ///< when it stands
  std::uint32_t greeted_;  ///< connection the last hello went to: only that one owes anything
  bool owed_reference_ = false;
  std::map<std::uint32_t, std::int64_t> assets_asked_us_;  ///< geometry and images, by request id
  std::int64_t uplink_free_us_ = 0, downlink_free_us_ = 0, server_free_us_ = 0;
  BusyTime transmitting_, working_;
  std::int64_t last_arrival_us_ = 0, welcome_us_ = 0;
  std::int64_t tile_lead_bytes_ = 0;
  std::uint64_t bytes_up_ = 0, bytes_down_ = 0;
};

}  // namespace mirage
