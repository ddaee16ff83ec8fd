#pragma once
// Rent or buy: decides for which objects geometry is asked for, instead of tile after tile.
// Input:  the tiles that instances want now, with their bytes and life; tiles that arrived.
// Output: the objects whose geometry is bought.
// Thread: the frame loop's.
// Full:   never; one account an object.
//
// Tiles are rent: they cost bytes again whenever the view has moved on, for each instance. Geometry
// is bought: it costs bytes once, for all instances. Buying as soon as the rent paid has reached
// the price costs at most twice the least (the ski-rental problem; A. R. Karlin et al.,
// "Competitive snoopy caching", Algorithmica 1988). This class buys sooner, because it also counts
// the rent to come: the present rent for as long as the object will be seen. It expects that to be
// as long as the object has been seen so far.
//
// A link that would otherwise idle makes the price small. If few objects wanted tiles lately, and
// it brings the geometry of all of them in a moment, all is bought: geometry is right from
// everywhere.

#include <cstdint>
#include <vector>

namespace mirage {

class RentOrBuy {
 public:
  /// Forgets all accounts. `objects` is the number of objects in the scene.
  void reset(std::size_t objects) {
    accounts_.assign(objects, {});
    told_.clear();
    recent_.clear();
  }
  void grow(std::size_t objects) { accounts_.resize(objects); }

  /// Notes that a tile of the object has arrived.
  void paid(std::uint32_t object, double bytes);
  /// A tile that is wanted, beside geometry fit for the same.
  struct Wanted {
    double bytes = 0;
    double life_s = 0;       ///< for which the tile will serve
    double price_bytes = 0;  ///< of the geometry
    double gain = 0;         ///< of the tile (ask_gain.h)
  };
  /// Notes that an instance of the object wants a tile.
  void want(std::uint32_t object, const Wanted& tile, std::int64_t now_us);
  /// Decides what to buy, once all wants of the frame have been noted. `spare_bytes` the link would
  /// bring in a moment, beside all that is asked for.
  void decide(std::int64_t now_us, double spare_bytes = 0);
  bool bought(std::uint32_t object, std::int64_t now_us) const;
  /// Returns the gain of the tiles last wanted of the object, now and in the time to come.
  double worth(std::uint32_t object) const { return accounts_[object].worth; }
  /// Returns that gain divided by the bytes of the geometry; +inf if the geometry takes no bytes.
  double worth_a_byte(std::uint32_t object) const;
  /// Returns the bytes of the geometry when a tile of it was last wanted.
  double price(std::uint32_t object) const { return accounts_[object].price; }
  /// Notes that an instance of the object is in view, so that bought geometry is kept.
  void used(std::uint32_t object, std::int64_t now_us);

 private:
  struct Account {
    double paid = 0;      ///< bytes of tiles since it was last bought or forgotten
    double wanted = 0;    ///< bytes of tiles wanted in this frame, now and in the time to come
    double price = 0;     ///< bytes of geometry, at the nearest instance that last wanted a tile
    double worth = 0;     ///< gain of the tiles last wanted, now and in the time to come
    bool recent = false;  ///< it is in `recent_`
    std::int64_t since_us = 0, seen_us = INT64_MIN / 2;
    std::int64_t bought_us = -1;  ///< when it was bought or last used; < 0: not bought
  };
  /// Returns the bytes of the geometry of all objects that wanted a tile lately and have none.
  double price_of_recent(std::int64_t now_us);
  double horizon_s(const Account& account, std::int64_t now_us) const;

  std::vector<Account> accounts_;
  std::vector<std::uint32_t> told_;    ///< objects with a want in this frame
  std::vector<std::uint32_t> recent_;  ///< objects with a want in the last 10 s, each once
};

}  // namespace mirage
