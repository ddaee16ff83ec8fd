#include "tests/hostile/framing_table.h"

#include "tests/hostile/client.h"

namespace mirage::test {
namespace {

constexpr const char* kProtocolError = "closed 1002";
constexpr const char* kAnyLength =
    "libwebsockets takes a length told in more bytes than it needs, and does not tell us";
constexpr const char* kUnmasked =
    "libwebsockets takes unmasked frames of a client and does not tell us; no proxy is deceived by "
    "what only this client sends";
constexpr const char* kNewerCodes =
    "libwebsockets answers 1002 to codes that were registered after the standard";

using Cases = std::vector<FramingCase>;

/// Returns a request whose answer is one small message; its payload makes it as long as wanted.
std::string stats_request(std::size_t bytes = 0) {
  const std::size_t bare = encode_message(wire::StatsRequestT{}).size();
  return text_of(encode_message(wire::StatsRequestT{}, Bytes(bytes > bare ? bytes - bare : 0)));
}

ClientFrame binary_frame(const std::string& payload) { return {2, payload}; }
ClientFrame of(int opcode, const std::string& payload = "") { return {opcode, payload}; }
ClientFrame unfinished(ClientFrame frame) {
  frame.final = false;
  return frame;
}
ClientFrame with_reserved(ClientFrame frame, int bits) {
  frame.reserved = bits;
  return frame;
}
ClientFrame unmasked(ClientFrame frame) {
  frame.masked = false;
  return frame;
}
ClientFrame told_in(ClientFrame frame, int length_bytes) {
  frame.length_bytes = length_bytes;
  return frame;
}

std::string joined(const std::vector<ClientFrame>& frames) {
  std::string out;
  for (const ClientFrame& frame : frames) out += frame.bytes();
  return out;
}
std::string close_body(int code, const std::string& reason = "") {
  return std::string{static_cast<char>(code >> 8), static_cast<char>(code & 0xff)} + reason;
}

std::vector<std::string> in_pieces(const std::string& text, std::size_t bytes) {
  std::vector<std::string> out;
  for (std::size_t at = 0; at < text.size(); at += bytes) out.push_back(text.substr(at, bytes));
  return out;
}

/// Returns a message in `parts` fragments of about equal size.
std::vector<ClientFrame> in_fragments(const std::string& message, std::size_t parts) {
  std::vector<ClientFrame> out;
  for (std::size_t i = 0; i < parts; ++i) {
    const std::size_t begin = message.size() * i / parts, end = message.size() * (i + 1) / parts;
    ClientFrame frame{i == 0 ? 2 : 0, message.substr(begin, end - begin)};
    frame.final = i + 1 == parts;
    out.push_back(frame);
  }
  return out;
}

/// Returns a case whose bytes are sent at once.
FramingCase told(const std::string& name, const std::string& bytes, const std::string& then,
                 const std::string& why = "") {
  return {name, {bytes}, then, why};
}

}  // namespace

Cases opcode_cases() {
  Cases out;
  for (int opcode = 0; opcode < 16; ++opcode) {
    const std::string name = "opcode " + std::to_string(opcode);
    const bool known = opcode == 1 || opcode == 2 || (opcode >= 8 && opcode <= 10);
    for (int bits = 1; bits < 8 && known; ++bits) {
      const bool one = bits == 1 || bits == 2 || bits == 4;
      if (!one && opcode != 2) continue;
      const std::string payload = opcode == 2   ? stats_request()
                                  : opcode == 8 ? close_body(1000)
                                                : "a";
      out.push_back(told(name + ", reserved bits " + std::to_string(bits),
                         with_reserved(of(opcode, payload), bits).bytes(), kProtocolError));
    }
    if (known) continue;
    for (const std::size_t n : {0, 3, 200}) {
      out.push_back(told(name + " of " + std::to_string(n), of(opcode, std::string(n, 'x')).bytes(),
                         kProtocolError));
    }
    out.push_back(
        told(name + ", unfinished", unfinished(of(opcode, "abc")).bytes(), kProtocolError));
  }
  out.push_back(told("text", of(1, "hello").bytes(), kProtocolError));
  out.push_back(told("text, empty", of(1).bytes(), kProtocolError));
  out.push_back(told("text of no UTF-8", of(1, "\xff\xfe").bytes(), "closed 1007"));
  return out;
}

Cases control_cases() {
  Cases out;
  for (const std::size_t n : {0, 1, 2, 7, 63, 124, 125}) {
    const std::string size = std::to_string(n), payload(n, 'p');
    out.push_back(told("ping of " + size, of(9, payload).bytes(), "pong " + size + ", open"));
    out.push_back(told("pong of " + size, of(10, payload).bytes(), "open"));
  }
  for (const int opcode : {8, 9, 10}) {
    const std::string name = "opcode " + std::to_string(opcode);
    for (const std::size_t n : {126, 127, 128, 1000, 65535, 65536}) {
      out.push_back(told(name + " of " + std::to_string(n),
                         of(opcode, std::string(n, '\3')).bytes(), "dropped"));
    }
    const ClientFrame frame = of(opcode, "\3\xe8");
    out.push_back(told(name + ", unfinished", unfinished(frame).bytes(), kProtocolError));
    out.push_back(
        told(name + " in two", unfinished(frame).bytes() + of(0, "b").bytes(), kProtocolError));
    out.push_back(told(name + ", length 2 in 3 bytes", told_in(frame, 3).bytes(), "dropped"));
    const char* const then = opcode == 8 ? "closed 1000" : opcode == 9 ? "pong 2, open" : "open";
    out.push_back(told(name + ", unmasked", unmasked(frame).bytes(), then, kUnmasked));
  }
  std::string pings;
  for (int i = 0; i < 10; ++i) pings += of(9, std::string(i, 'x')).bytes();
  out.push_back(told("ten pings at once", pings, "pong 0, open",
                     "libwebsockets answers the first of those that wait, not the last"));
  out.push_back(told("ping and request",
                     of(9, "abc").bytes() + binary_frame(stats_request()).bytes(),
                     "pong 3, stats, open"));
  return out;
}

Cases close_cases() {
  Cases out;
  const auto add = [&](const std::string& name, const std::string& body, const std::string& then,
                       const std::string& why = "") {
    out.push_back(told(name, of(8, body).bytes(), then, why));
  };
  add("close without a body", "", "closed 1005");
  add("close with one byte", "\3", kProtocolError);
  for (const int code :
       {1000, 1001, 1002, 1003, 1007, 1008, 1009, 1010, 1011, 3000, 3999, 4000, 4999}) {
    add("close " + std::to_string(code), close_body(code), "closed " + std::to_string(code));
  }
  for (const int code : {1012, 1013, 1014}) {
    add("close " + std::to_string(code), close_body(code), kProtocolError, kNewerCodes);
  }
  for (const int code : {0, 1, 999, 1004, 1005, 1006, 1015, 1016, 1100, 2000, 2999, 5000, 65535}) {
    add("close " + std::to_string(code) + ", which is none", close_body(code), kProtocolError);
  }
  for (const std::size_t n : {1, 2, 122, 123}) {
    add("a reason of " + std::to_string(n), close_body(1000, std::string(n, 'r')), "closed 1000");
  }
  add("a reason in UTF-8", close_body(1000, "\xce\xba\xe1\xbd\xb9\xf0\x9f\x8c\xb5"), "closed 1000");
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"a lone 0xff", "\xff"},
      {"a lone continuation", "a\x80"},
      {"longer than needed", "\xc0\xaf"},
      {"a surrogate", "\xed\xa0\x80"},
      {"beyond the last", "\xf4\x90\x80\x80"},
      {"of five bytes", "\xf8\x88\x80\x80\x80"}};
  for (const auto& [name, reason] : wrong) {
    add("a reason of no UTF-8: " + name, close_body(1000, reason), "dropped");
  }
  add("a reason of no UTF-8: cut off", close_body(1000, "a\xe1\xbd"), "closed 1000",
      "libwebsockets does not look for the end of the last character");
  const std::string close = of(8, close_body(1000)).bytes();
  const std::string request = binary_frame(stats_request()).bytes();
  out.push_back(told("a request after the close", close + request, "closed 1000"));
  out.push_back(told("a request before the close", request + close, "closed 1000"));
  out.push_back(told("a ping after the close", close + of(9, "late").bytes(), "closed 1000"));
  out.push_back(told("closed twice", close + of(8, close_body(1001)).bytes(), "closed 1000"));
  return out;
}

Cases length_cases() {
  Cases out;
  for (const std::size_t n :
       {100,  124,  125,   126,   127,   128,   129,   255,    256,    1000,
        4095, 4096, 16384, 65534, 65535, 65536, 65537, 131072, 262143, 262144}) {
    out.push_back(told("request of " + std::to_string(n), binary_frame(stats_request(n)).bytes(),
                       "stats, open"));
  }
  for (const std::size_t n : {262145, 300'000}) {
    out.push_back(told("message of " + std::to_string(n), binary_frame(std::string(n, 'x')).bytes(),
                       "closed 1009"));
  }
  for (const std::size_t n : {0, 1, 15, 16, 17, 125, 126, 65535, 65536, 262144}) {
    out.push_back(told("nonsense of " + std::to_string(n),
                       binary_frame(std::string(n, 'x')).bytes(), kProtocolError));
  }
  const auto declares = [&](const std::string& name, std::uint64_t length,
                            const std::string& then) {
    ClientFrame frame = binary_frame("abc");
    frame.declared = length;
    out.push_back({"declares " + name, {frame.bytes()}, then, "", false});
  };
  declares("256 KiB, sends 3 bytes", 262'144, "waits");
  declares("256 KiB and 1", 262'145, "closed 1009");
  declares("2^31", std::uint64_t{1} << 31, "closed 1009");
  declares("2^32", std::uint64_t{1} << 32, "closed 1009");
  declares("2^40", std::uint64_t{1} << 40, "closed 1009");
  declares("2^62", std::uint64_t{1} << 62, "closed 1009");
  declares("2^63", std::uint64_t{1} << 63, "dropped");
  declares("2^64 - 1", UINT64_MAX, "dropped");
  for (const std::size_t n : {100, 125, 126, 65535}) {
    for (const int bytes : {3, 9}) {
      if (bytes == 3 && n > 125) continue;
      out.push_back(told("length " + std::to_string(n) + " in " + std::to_string(bytes) + " bytes",
                         told_in(binary_frame(stats_request(n)), bytes).bytes(), "stats, open",
                         kAnyLength));
    }
  }
  for (const std::size_t n : {100, 126, 65536}) {
    out.push_back(told("unmasked, " + std::to_string(n),
                       unmasked(binary_frame(stats_request(n))).bytes(), "stats, open", kUnmasked));
  }
  for (const std::uint32_t mask : {0u, 0xffffffffu, 1u, 0x80000000u}) {
    ClientFrame frame = binary_frame(stats_request());
    frame.mask = mask;
    out.push_back(told("mask " + std::to_string(mask), frame.bytes(), "stats, open"));
  }
  return out;
}

Cases fragment_cases() {
  Cases out;
  const std::string request = stats_request(), large = stats_request(200'000);
  const auto add = [&](const std::string& name, const std::vector<ClientFrame>& frames,
                       const std::string& then, const std::string& why = "") {
    out.push_back(told(name, joined(frames), then, why));
  };
  for (const std::size_t parts : {2, 3, 5, 10, 40}) {
    add("in " + std::to_string(parts), in_fragments(request, parts), "stats, open");
    add("200 KB in " + std::to_string(parts), in_fragments(large, parts), "stats, open");
  }
  const std::string a = request.substr(0, 20), b = request.substr(20);
  const auto first = [](const std::string& s) { return unfinished(binary_frame(s)); };
  const auto middle = [](const std::string& s) { return unfinished(of(0, s)); };
  const auto last = [](const std::string& s) { return of(0, s); };
  add("first empty", {first(""), last(request)}, "stats, open");
  add("last empty", {first(request), last("")}, "stats, open");
  add("middle empty", {first(a), middle(""), last(b)}, "stats, open");
  add("all empty", {first(""), middle(""), last("")}, kProtocolError);
  add("ping between", {first(a), of(9, "abc"), last(b)}, "pong 3, stats, open");
  add("pong between", {first(a), of(10, "abc"), last(b)}, "stats, open");
  add("close between", {first(a), of(8, close_body(1000)), last(b)}, "closed 1000");
  add("text begun between", {first(a), of(1, "x"), last(b)}, kProtocolError);
  add("another message between", {first(a), binary_frame(request), last(b)}, kProtocolError);
  add("another begun between", {first(a), first(a), last(b)}, kProtocolError);
  add("nothing to continue", {last(request)}, kProtocolError);
  add("nothing to continue, unfinished", {middle(request)}, kProtocolError);
  add("nothing to continue any more", {first(a), last(b), last(b)}, kProtocolError);
  add("continued after a whole message", {binary_frame(request), last(b)}, kProtocolError);
  add("never finished", {first(a)}, "open");
  add("text in two", {unfinished(of(1, "he")), last("llo")}, kProtocolError);
  add("reserved bit in the second", {first(a), with_reserved(last(b), 4)}, kProtocolError);
  add("second unmasked", {first(a), unmasked(last(b))}, "stats, open", kUnmasked);
  add("first unmasked", {unmasked(first(a)), last(b)}, "stats, open", kUnmasked);
  add("300 KB in 10", in_fragments(std::string(300'000, 'x'), 10), "closed 1009");
  std::vector<ClientFrame> empty = {first("")};
  for (int i = 0; i < 2000; ++i) empty.push_back(middle(""));
  empty.push_back(last(request));
  add("2000 empty ones between", empty, "stats, open");
  add("two messages in two each", {first(a), last(b), first(a), last(b)}, "stats, stats, open");
  return out;
}

Cases chopped_cases() {
  Cases out;
  const std::string small = binary_frame(stats_request()).bytes();
  const std::string more = binary_frame(stats_request(126)).bytes();
  const std::string large = binary_frame(stats_request(65'536)).bytes();
  const std::string fragments = joined(in_fragments(stats_request(), 3));
  for (const std::size_t n : {1, 2, 3, 7, 16}) {
    const std::string by = " by " + std::to_string(n);
    out.push_back({"small" + by, in_pieces(small, n), "stats, open"});
    out.push_back({"126" + by, in_pieces(more, n), "stats, open"});
    out.push_back({"fragments" + by, in_pieces(fragments, n), "stats, open"});
    out.push_back({"ping" + by, in_pieces(of(9, "abcdef").bytes(), n), "pong 6, open"});
    out.push_back({"close" + by, in_pieces(of(8, close_body(1000)).bytes(), n), "closed 1000"});
    out.push_back({"opcode 5" + by, in_pieces(of(5, "abc").bytes(), n), kProtocolError});
  }
  for (const std::size_t n : {997, 4096, 65'535}) {
    out.push_back({"65536 by " + std::to_string(n), in_pieces(large, n), "stats, open"});
  }
  std::string many, answers;
  for (int i = 0; i < 5; ++i) {
    many += small;
    answers += "stats, ";
  }
  out.push_back(told("five at once", many, answers + "open"));
  out.push_back({"five by 50", in_pieces(many, 50), answers + "open"});
  for (const std::size_t n : {1, 2, 5, 6, 20}) {
    out.push_back({"cut after " + std::to_string(n), {small.substr(0, n)}, "waits", "", false});
  }
  return out;
}

Cases message_cases() {
  Cases out;
  const std::string request = stats_request();
  const auto add = [&](const std::string& name, std::size_t at, int byte, const std::string& then) {
    std::string changed = request;
    changed[at] = static_cast<char>(byte);
    out.push_back(told(name, binary_frame(changed).bytes(), then));
  };
  add("magic", 0, 0, kProtocolError);
  add("magic's second byte", 1, 0, kProtocolError);
  constexpr int kSpoken = limits::kProtocolVersion;
  for (const int version : {0, 1, kSpoken - 1, kSpoken + 1, 255}) {
    add("version " + std::to_string(version), 2, version, "closed 4001");
  }
  for (const int kind : {0, 3, 255}) add("kind " + std::to_string(kind), 3, kind, kProtocolError);
  add("one control byte more", 4, request[4] + 1, kProtocolError);
  add("control bytes of 4 GB", 7, 255, kProtocolError);
  add("a byte of payload that is not there", 8, 1, kProtocolError);
  add("payload of 4 GB", 11, 255, kProtocolError);
  for (const std::size_t at : {12, 13, 14, 15}) {
    add("reserved byte " + std::to_string(at), at, 1, kProtocolError);
  }
  for (const std::size_t n : {1, 2, 4, 8, 16, 20, 30}) {
    out.push_back(told("cut to " + std::to_string(n), binary_frame(request.substr(0, n)).bytes(),
                       kProtocolError));
  }
  out.push_back(told("a byte more", binary_frame(request + "x").bytes(), kProtocolError));
  const auto message = [&](const std::string& name, const Bytes& bytes) {
    out.push_back(told(name, binary_frame(text_of(bytes)).bytes(), kProtocolError));
  };
  message("a second hello", encode_message(hello()));
  message("a server's message", encode_message(wire::StatsT{}));
  return out;
}

}  // namespace mirage::test
