#include "client/price/cost_model.h"

namespace mirage {

double CostModel::ms_of(const FrameWork& work) const {
  double sum = 0;
  for (std::size_t i = 0; i < kWorks; ++i) sum += work.amount[i] * ms[i];
  return sum;
}

}  // namespace mirage
