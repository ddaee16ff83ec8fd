#include "server/source/redis_link.h"

#include <hiredis/hiredis.h>

#include <cerrno>

namespace mirage {
namespace {

timeval time_of(std::int64_t us) {
  return {static_cast<time_t>(us / 1'000'000), static_cast<suseconds_t>(us % 1'000'000)};
}

}  // namespace

void RedisLink::FreeReply::operator()(redisReply* reply) const { freeReplyObject(reply); }

RedisLink::~RedisLink() { redisFree(context_); }

Result<std::unique_ptr<RedisLink>> RedisLink::connect(const StoreAddress& address,
                                                      std::int64_t limit_us) {
  const timeval limit = time_of(limit_us);
  redisContext* const context = redisConnectWithTimeout(address.host.c_str(), address.port, limit);
  if (!context) return make_error(ErrorId::kNetworkConnect, "no memory for a connection");
  std::unique_ptr<RedisLink> link(new RedisLink(context));
  if (context->err != 0) return make_error(ErrorId::kNetworkConnect, context->errstr);
  if (redisSetTimeout(context, limit) != REDIS_OK) {
    return make_error(ErrorId::kNetworkConnect, "no time limit can be set");
  }
  if (!address.password.empty()) {
    const Result<Reply> said =
        link->checked(redisCommand(context, "AUTH %s", address.password.c_str()));
    if (!said) return make_error(ErrorId::kNetworkConnect, said.error().text);
  }
  if (address.database != 0) {
    const Result<Reply> said = link->checked(redisCommand(context, "SELECT %d", address.database));
    if (!said) return make_error(ErrorId::kNetworkConnect, said.error().text);
  }
  return link;
}

Result<RedisLink::Reply> RedisLink::checked(void* reply) {
  Reply out(static_cast<redisReply*>(reply));
  if (!out) {
    const bool late = context_->err == REDIS_ERR_IO && errno == EAGAIN;
    if (late) return make_error(ErrorId::kNetworkTimeout, "no answer in time");
    return make_error(ErrorId::kNetworkClosed, context_->errstr);
  }
  if (out->type == REDIS_REPLY_ERROR) {
    return make_error(ErrorId::kNetworkClosed, std::string(out->str, out->len));
  }
  return out;
}

Result<std::optional<Bytes>> RedisLink::get(const std::string& key) {
  const Result<Reply> reply = checked(redisCommand(context_, "GET %b", key.data(), key.size()));
  if (!reply) return reply.error();
  const redisReply& said = **reply;
  if (said.type != REDIS_REPLY_STRING) return std::optional<Bytes>();
  return std::optional<Bytes>(Bytes(said.str, said.str + said.len));
}

Result<void> RedisLink::set(const std::string& key, const Bytes& value) {
  const Result<Reply> reply = checked(
      redisCommand(context_, "SET %b %b", key.data(), key.size(), value.data(), value.size()));
  if (!reply) return reply.error();
  return {};
}

Result<std::string> RedisLink::hold(const std::string& key, const std::string& holder,
                                    std::int64_t life_ms) {
  const Result<Reply> taken =
      checked(redisCommand(context_, "SET %b %b NX PX %lld", key.data(), key.size(), holder.data(),
                           holder.size(), static_cast<long long>(life_ms)));
  if (!taken) return taken.error();
  if ((*taken)->type != REDIS_REPLY_NIL) return holder;
  const Result<std::optional<Bytes>> other = get(key);
  if (!other) return other.error();
  // The lease ended between the two calls. The first server that sets it holds it.
  if (!*other) return std::string();
  return std::string((*other)->begin(), (*other)->end());
}

}  // namespace mirage
