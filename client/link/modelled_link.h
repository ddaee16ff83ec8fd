#pragma once
// Modelled link: a real server behind a network that is computed.
//
// Requests go to the server at once. Its replies are held back until the model says that they would
// have arrived. On virtual time the model also replaces the server's timing: one tile every
// server_ms, worst error first. It then waits for all real replies before time advances, so a
// session is reproducible to the bit on any machine.

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

/// Busy shares, 0 to 1, of the last half second, or of the last two round trips if they are longer.
struct LinkUse {
  double link = 0;    ///< share in which the downlink transmitted; 0 if its rate is unlimited
  double server = 0;  ///< share in which the server worked
};

/// True if a first image waits although neither link nor server is busy.
inline bool starves(bool first_waits, const LinkUse& use) {
  return first_waits && use.link < 0.8 && use.server < 0.9;
}

class ModelledLink final : public Link {
 public:
  /// `blocking` (virtual time): it waits for the server's replies. `wait` blocks until the inner
  /// link has something or a while has passed; it returns false if there is no hope of a reply.
  ModelledLink(Link& inner, const Clock& clock, const NetModel& model, bool blocking,
               std::function<bool()> wait);

  void send(Bytes message) override;
  std::vector<Message> receive() override;
  /// Returns true from two round trips after the inner link has connected.
  bool connected() const override;
  std::uint32_t generation() const override { return inner_.generation(); }
  LinkTraffic traffic() const override { return {bytes_up_, bytes_down_}; }
  /// Returns how busy link and server were until now. Only on virtual time, where the server's time
  /// is the model's.
  LinkUse use();
  /// Replaces the network model. Messages under way still arrive as the former one said.
  void change(const NetModel& model) {
    model_ = model;
    delays_.change(model);
  }

 private:
  struct Item {
    Message message;
    std::size_t bytes = 0;
    std::size_t left = 0;  ///< bytes not transmitted yet
  };
  struct Ask {
    std::int64_t arrives_us = 0;  ///< when the ask reaches the server
    std::int64_t cancelled_us = INT64_MAX;
    float error_px = 0;
    bool view = false;
    bool made_ahead = false;  ///< the home view, which every server holds
    bool answered = false;
    Item reply;
  };
  struct Ready {
    std::int64_t at_us = 0;  ///< when the reply is ready at the server's socket
    bool bulk = false;
    bool view = false;  ///< a view goes before all that is not being transmitted
    Item item;
  };

  void note_connection(std::int64_t now_us);
  void note_sent(const Bytes& message, std::int64_t now_us);
  void ask_view(const wire::ViewRequestT& view, std::int64_t arrives_us);
  void collect_replies();
  void take_reply(Message message);
  void tell_model_times(Message& message) const;
  /// Notes which part of the scene's description has arrived. Returns the time at which the server
  /// sent the message, for messages that are neither tiles nor requested geometry.
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
  std::map<std::uint32_t, Ask> asks_;  ///< asks at the server or on the way to it, by request id
  /// Replies that wait for the downlink, by time. Equal times are ordered by kind and request, so
  /// the order in which they really arrived does not matter.
  std::multimap<std::pair<std::int64_t, std::uint32_t>, Ready> ready_;
  std::deque<Item> tiles_lane_, bulk_lane_;
  std::deque<std::pair<std::int64_t, Message>> arrived_;
  std::vector<Message> out_of_band_;
  std::size_t owed_images_ = 0, owed_objects_ = 0;
  std::map<std::uint32_t, std::int64_t> opens_us_;  ///< requests for members, and when they arrive
  bool owed_welcome_ = false;
  std::uint32_t reached_ = 0;      ///< generation of the last connection seen
  std::int64_t connected_us_ = 0;  ///< when that connection is up
  std::uint32_t greeted_;  ///< generation that the last hello went to; only that one owes replies
  bool owed_reference_ = false;
  /// Asks for geometry and images, by request id.
  std::map<std::uint32_t, std::int64_t> assets_asked_us_;
  std::int64_t uplink_free_us_ = 0, downlink_free_us_ = 0, server_free_us_ = 0;
  BusyTime transmitting_, working_;
  std::int64_t last_arrival_us_ = 0, welcome_us_ = 0;
  std::int64_t tile_lead_bytes_ = 0;
  std::uint64_t bytes_up_ = 0, bytes_down_ = 0;
};

}  // namespace mirage
