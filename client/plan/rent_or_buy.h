#pragma once
// Rent or buy: of which objects geometry is asked for, rather than tile after tile.
// Input:  the tiles that instances want now, with what they weigh and how long they last; tiles
//         that came. Output: the objects whose geometry is bought.
// Thread: the frame loop's. Never full: one account an object.
//
// Tiles are rent: bytes again whenever the view has moved on, for each instance. Geometry is
// bought: bytes once, for all instances. Who buys as soon as the rent paid has reached the price
// pays at most twice the least (the ski-rental problem; A. R. Karlin et al., "Competitive snoopy
// caching", Algorithmica 1988). What is wanted now is counted for as long as the object will be
// seen, taken to be as long as it has been seen so far: who knows more buys sooner.

#include <cstdint>
#include <vector>

namespace mirage {

class RentOrBuy {
 public:
  /// Forgets all accounts; `objects` of the scene.
  void reset(std::size_t objects) { accounts_.assign(objects, {}); }
  void grow(std::size_t objects) { accounts_.resize(objects); }

  /// A tile of the object has come.
  void paid(std::uint32_t object, double bytes);
  /// An instance of the object wants a tile of `bytes` that will serve for `life_s`, where geometry
  /// fit for it would take `price_bytes`; `gain`: of the tile (ask_gain.h).
  void want(std::uint32_t object, double bytes, double life_s, double price_bytes, double gain,
            std::int64_t now_us);
  /// All that is wanted in this frame has been told.
  void decide(std::int64_t now_us);
  bool bought(std::uint32_t object, std::int64_t now_us) const;
  /// What the tiles would be worth that were wanted of the object last, and in the time to come.
  double worth(std::uint32_t object) const { return accounts_[object].worth; }
  /// The same a byte of geometry; +inf where that takes none.
  double worth_a_byte(std::uint32_t object) const;
  /// An instance of the object is in view: what was bought is kept.
  void used(std::uint32_t object, std::int64_t now_us);

 private:
  struct Account {
    double paid = 0;    ///< bytes of tiles since it was last bought or forgotten
    double wanted = 0;  ///< of tiles, in this frame and in the time to come
    double price = 0;   ///< of geometry, at the nearest instance that wanted a tile last
    double worth = 0;   ///< of the tiles wanted last, and in the time to come
    std::int64_t since_us = 0, seen_us = INT64_MIN / 2;
    std::int64_t bought_us = -1;  ///< when it was bought or last used; < 0: it is not
  };
  double horizon_s(const Account& account, std::int64_t now_us) const;

  std::vector<Account> accounts_;
  std::vector<std::uint32_t> told_;  ///< objects of this frame
};

}  // namespace mirage
