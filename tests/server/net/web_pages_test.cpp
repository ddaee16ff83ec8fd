// Web pages: the files of the browser page, which form is sent, and with which headers.
#include "server/net/web_pages.h"

#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"

namespace mirage::test {
namespace {

TEST(WebPages, EncodingsAreThoseABrowserNames) {
  EXPECT_TRUE(accepts_encoding("gzip, deflate, br", "br"));
  EXPECT_TRUE(accepts_encoding("gzip;q=0.5,br;q=1.0", "gzip"));
  EXPECT_FALSE(accepts_encoding("gzip, br;q=0", "br"));
  EXPECT_FALSE(accepts_encoding("gzip, br; q=0.000", "br"));
  EXPECT_FALSE(accepts_encoding("brotli, xbr", "br"));
  EXPECT_FALSE(accepts_encoding("", "gzip"));
}

TEST(WebPages, TheSmallestFormThatIsTaken) {
  const TempFolder folder;
  std::filesystem::create_directory(folder.path() / "w-1");
  for (const char* name : {"index.html", "w-1/a.js"}) {
    folder.write(name, "plain");
    folder.write(std::string(name) + ".gz", "zipped");
    folder.write(std::string(name) + ".br", "small");
  }
  folder.write("w-1/secret.txt", "of no type that is served");
  const Result<WebPages> pages = WebPages::read(folder.path().string());
  ASSERT_TRUE(pages);
  EXPECT_EQ(*pages->find("/", "gzip, br")->body, "small");
  EXPECT_EQ(*pages->find("/w-1/a.js", "gzip")->body, "zipped");
  EXPECT_EQ(*pages->find("/w-1/a.js", "")->body, "plain");
  EXPECT_EQ(pages->find("/w-1/a.js", "")->type, "text/javascript; charset=utf-8");
  for (const char* none : {"/w-1", "/w-1/", "/w-1/b.js", "/../index.html", "/w-1/secret.txt", "",
                           "/w-1/a.js.gz", "/index.html/"}) {
    EXPECT_EQ(pages->find(none, "br"), nullptr) << none;
  }
}

TEST(WebPages, ThePageIsNeverCachedItsPartsForEver) {
  WebFile page, part;
  page.page = true;
  part.encoding = "br";
  const std::string of_page = WebPages::headers(page, "host.example:9870", {});
  EXPECT_NE(of_page.find("Cache-Control: no-cache\r\n"), std::string::npos);
  EXPECT_NE(of_page.find("default-src 'none'"), std::string::npos);
  EXPECT_NE(of_page.find("ws://host.example:9870 wss://host.example:9870;"), std::string::npos);
  const std::string of_part = WebPages::headers(part, "host", {});
  EXPECT_NE(of_part.find("immutable"), std::string::npos);
  EXPECT_NE(of_part.find("Content-Encoding: br\r\n"), std::string::npos);
  for (const std::string& both : {of_page, of_part}) {
    EXPECT_NE(both.find("X-Content-Type-Options: nosniff"), std::string::npos);
  }
}

// The hashes are those of `printf %s body | openssl dgst -sha256 -binary | base64`.
TEST(WebPages, AllowsTheStyleAndTheScriptInThePageAndNoOthers) {
  const TempFolder folder;
  folder.write("index.html", "<style>p{}</style><p><script>a()</script>");
  folder.write("index.html.br", "small");
  const Result<WebPages> pages = WebPages::read(folder.path().string());
  ASSERT_TRUE(pages);
  for (const char* form : {"", "br"}) {
    const std::string headers = WebPages::headers(*pages->find("/", form), "host", {});
    EXPECT_NE(
        headers.find("style-src 'self' 'sha256-gG2yISYereRMiG2lMXrbiUgi0Ubw9p7QCeWcroOvy9Y=';"),
        std::string::npos)
        << headers;
    EXPECT_NE(
        headers.find("'wasm-unsafe-eval' 'sha256-qVpDBgj7bpq5hMAcGp3AOc79J3Y1Z4HvySTwKrWDoy4=';"),
        std::string::npos);
    EXPECT_EQ(headers.find("unsafe-inline"), std::string::npos);
  }
}

TEST(WebPages, AScriptBesideThePageIsForOtherSites) {
  const TempFolder folder;
  for (const char* name : {"index.html", "impostor.js"}) folder.write(name, "plain");
  const Result<WebPages> pages = WebPages::read(folder.path().string());
  ASSERT_TRUE(pages);
  const WebFile* const script = pages->find("/impostor.js", "");
  ASSERT_TRUE(script && script->shared);
  EXPECT_FALSE(pages->find("/", "")->shared);
  const std::string headers = WebPages::headers(*script, "host", {});
  EXPECT_NE(headers.find("Access-Control-Allow-Origin: *\r\n"), std::string::npos);
  EXPECT_EQ(headers.find("immutable"), std::string::npos) << "its name stays";
}

TEST(WebPages, AnAddressIsOfAHostThatBrowsersSend) {
  EXPECT_EQ(address_of({"example.org:9870", false, ""}), "http://example.org:9870");
  EXPECT_EQ(address_of({"[::1]", true, ""}), "https://[::1]");
  for (const char* host : {"", "x\" onload=\"", "<b>", "a b", "x/y", "x?y", "x@y", "a'"}) {
    EXPECT_EQ(address_of({host, true, ""}), "") << host;
  }
  EXPECT_EQ(escaped("<a b=\"c\" d='e'>&"), "&lt;a b=&quot;c&quot; d=&#39;e&#39;&gt;&amp;");
}

TEST(WebPages, AHostCannotAddToThePolicy) {
  WebFile page;
  page.page = true;
  for (const char* host :
       {"x; script-src *", "a b", "x\r\nSet-Cookie: a=b", "'unsafe-inline'", ""}) {
    const std::string headers = WebPages::headers(page, host, {});
    EXPECT_EQ(headers.find("ws://"), std::string::npos) << host;
    EXPECT_EQ(headers.find("Cookie"), std::string::npos) << host;
  }
}

TEST(WebPages, AFolderWithoutAPageIsSaidSo) {
  const TempFolder folder;
  folder.write("a.js", "alone");
  const Result<WebPages> pages = WebPages::read(folder.path().string());
  ASSERT_FALSE(pages);
  EXPECT_EQ(pages.error().id, ErrorId::kIo);
  EXPECT_FALSE(WebPages::read("/nowhere/at/all"));
}

}  // namespace
}  // namespace mirage::test
