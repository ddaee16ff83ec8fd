// The report's tables, page and plots: their form, not the measured values.
#include "client/report/table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "client/report/alpha_tested.h"
#include "client/report/page.h"
#include "client/report/pareto.h"
#include "client/report/plot.h"

namespace mirage::test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(Pareto, KeepsWhatNothingBeatsInBoth) {
  const std::vector<bool> front =
      pareto_front({{1, 5}, {2, 3}, {3, 4}, {4, 1}, {4, 2}, {0.5, kNaN}, {kNaN, 0}});
  EXPECT_EQ(front, (std::vector<bool>{true, true, false, true, false, false, false}));
}

TEST(Pareto, EqualPointsShareTheirFate) {
  EXPECT_EQ(pareto_front({{1, 1}, {1, 1}, {2, 1}}), (std::vector<bool>{true, true, false}));
  EXPECT_TRUE(pareto_front({}).empty());
}

TEST(ReportTable, WritesCsvThatReadsBack) {
  Table table({"scene", "ms"});
  table.add({"a \"forest\", large", figure(1.0 / 3)});
  table.add({"two\nlines", figure(std::nullopt)});
  EXPECT_EQ(table.csv(), "scene,ms\n\"a \"\"forest\"\", large\",0.333333\n\"two\nlines\",n/a\n");
  EXPECT_EQ(table.column("ms"), 1u);
}

TEST(ReportTable, SaysWhatIsNoNumber) {
  EXPECT_EQ(figure(std::numeric_limits<double>::infinity()), "inf");
  EXPECT_EQ(figure(kNaN), "n/a");
  EXPECT_EQ(figure(12345678.0), "1.23457e+07");
}

TEST(ReportTable, RefusesARowOfAnotherWidth) {
  Table table({"one", "two"});
  EXPECT_DEATH(table.add({"alone"}), "a row of 1 cells for 2 columns");
}

TEST(ReportPage, NothingInItIsMarkupUnlessMeant) {
  Page page;
  page.section("a\"b", "<i>");
  page.finding({"<u>", "<s>", false});
  page.falls_short("<em>");
  page.method("<q>");
  page.paragraph("x < y & z");
  Table table({"<b>"});
  table.add({"'quoted'"});
  page.table(table, {true});
  const std::string html = page.html("T & T", {"<del>"}, {"<ins>"});
  for (const char* tag : {"<i>", "<u>", "<s>", "<em>", "<q>", "<del>", "<ins>"}) {
    EXPECT_EQ(html.find(tag), std::string::npos) << tag;
  }
  EXPECT_EQ(html.find("<b>'"), std::string::npos);
  EXPECT_NE(html.find(">&lt;b&gt;</th>"), std::string::npos);
  EXPECT_NE(html.find("x &lt; y &amp; z"), std::string::npos);
  EXPECT_NE(html.find("&#39;quoted&#39;"), std::string::npos);
  EXPECT_NE(html.find("<a href=\"#a&quot;b\">&lt;i&gt;</a>"), std::string::npos);
  EXPECT_NE(html.find("<tr class=\"marked\">"), std::string::npos);
}

// A reader wants the answer before the way to it.
TEST(ReportPage, FindingsComeFirstAndTheMethodLast) {
  Page page;
  page.section("one", "One");
  page.method("how one was measured");
  page.paragraph("a plot of one");
  page.finding({"42 ms", "of one", false});
  page.finding({"43 ms", "more of one", false});
  page.falls_short("one is slow");
  page.section("two", "Two");
  page.finding({"44 ms", "of two", true});
  const std::string html = page.html("t", {"a check failed"}, {"written by me"});
  std::size_t before = 0;
  for (const char* text :
       {"a check failed", "42 ms", "44 ms", "<nav>", "42 ms", "43 ms", "one is slow",
        "a plot of one", "how one was measured", "44 ms", "written by me"}) {
    const std::size_t at = html.find(text, before);
    ASSERT_NE(at, std::string::npos) << text << " is not where it belongs";
    before = at + 1;
  }
  EXPECT_NE(html.find("<li class=\"short\">"), std::string::npos) << "what falls short is marked";
}

// A column that says the same in every row takes the place of others.
TEST(ReportPage, ColumnsHaveWordsAndOnlyTheFiguresThatDiffer) {
  Page page;
  Table table({"scene", "commit", "flip_mean"});
  table.add({"forest", "abc", "0.1"});
  table.add({"city", "abc", "0.2"});
  page.table(table);
  const std::string html = page.html("t", {}, {});
  EXPECT_NE(html.find("In all rows: commit abc."), std::string::npos);
  EXPECT_EQ(html.find(">commit</th>"), std::string::npos);
  EXPECT_NE(html.find(">FLIP, mean</th>"), std::string::npos);
  EXPECT_NE(html.find("title=\"Visible difference"), std::string::npos);
  EXPECT_EQ(html.find("flip_mean"), std::string::npos);
}

TEST(ReportPage, PicturesAreInTheFileItself) {
  Page page;
  const std::vector<std::uint8_t> grey(8 * 4 * 4, 100);
  ASSERT_TRUE(page.pictures("three", {8, 4, grey, grey}).ok());  // drawn, true, map of FLIP
  const std::string html = page.html("t", {}, {});
  std::size_t images = 0;
  for (std::size_t at = 0;
       (at = html.find("src=\"data:image/jpeg;base64,/9j/", at)) != std::string::npos; ++at) {
    ++images;
  }
  EXPECT_EQ(images, 3u);
}

TEST(ReportPage, AStripHasEachPictureAboveItsTruth) {
  Page page;
  const std::vector<std::uint8_t> grey(8 * 4 * 4, 100), white(8 * 4 * 4, 255);
  ASSERT_TRUE(
      page.strip("two", {{"<1 s>", {8, 4, grey, white}}, {"2 s", {8, 4, white, grey}}}).ok());
  const std::string html = page.html("t", {}, {});
  EXPECT_EQ(html.find("<1 s>"), std::string::npos);
  const auto picture = [&](const std::string& alt) {
    const std::size_t at = html.find("src=\"", html.find("alt=\"" + alt + "\""));
    return html.substr(at, html.find('>', at) - at);
  };
  EXPECT_EQ(picture("&lt;1 s&gt;, as drawn").rfind("src=\"data:image/jpeg;base64,/9j/", 0), 0u);
  EXPECT_EQ(picture("&lt;1 s&gt;, as drawn"), picture("2 s, full render"));
  EXPECT_EQ(picture("&lt;1 s&gt;, full render"), picture("2 s, as drawn"));
  EXPECT_NE(picture("2 s, as drawn"), picture("2 s, full render"));
}

// Values of RFC 4648, section 10.
TEST(ReportPage, Base64) {
  const auto of = [](const std::string& text) {
    return base64(std::vector<std::uint8_t>(text.begin(), text.end()));
  };
  EXPECT_EQ(of(""), "");
  EXPECT_EQ(of("f"), "Zg==");
  EXPECT_EQ(of("fo"), "Zm8=");
  EXPECT_EQ(of("foo"), "Zm9v");
  EXPECT_EQ(of("foobar"), "Zm9vYmFy");
}

Panel panel() {
  Panel p{"title", "cost, ms", "error, px", true, true, {}, 0.125, {{1, 2}}};
  p.series = {{"auto", {{1, 2}, {0, 3}, {4, -1}, {5, kNaN}, {8, 0.5}}}, {"quad", {}}};
  return p;
}

TEST(ReportPlot, ScriptNamesAxesMethodsFloorAndFront) {
  const std::string script = plot_script({panel()}, 1, "out.svg");
  for (const char* part : {"set xlabel \"cost, ms\"", "set ylabel \"error, px\"", "title \"auto\"",
                           "title \"quad\"", "0.125 with lines", "title \"Pareto front\"",
                           "title \"error floor", "set logscale x", "set logscale y"}) {
    EXPECT_NE(script.find(part), std::string::npos) << part;
  }
}

TEST(ReportPlot, ANameLooksTheSameInAllPanelsAndTheLegend) {
  Panel one = panel(), two = panel();
  one.series = {{"rain", {{1, 2}}}, {"snow", {{1, 2}}}};
  two.series = {{"snow", {{1, 2}}}, {"fog", {{1, 2}}}};
  const std::string script = plot_script({one, two}, 2, "out.svg");
  const auto look_after = [&](const std::string& text) {
    const std::size_t at = script.find(" pt ", script.find(text));
    return script.substr(at, script.find('"', script.find('"', at) + 1) - at);
  };
  const std::string in_first = look_after("$d0_1 using");
  EXPECT_NE(in_first, look_after("$d0_0 using"));
  EXPECT_EQ(look_after("$d1_0 using"), in_first);
  EXPECT_NE(look_after("$d1_1 using"), in_first);
  EXPECT_NE(script.find("NaN with linespoints lw 1.4" + in_first + "\" title \"snow\""),
            std::string::npos)
      << in_first;
}

TEST(ReportPlot, AVariantHasTheColourOfItsNameOtherPointsAndNoEntryOfItsOwn) {
  Panel both = panel();
  both.series = {{"quad", {{1, 2}}}, {"quad, 1 sample", {{1, 3}}}, {"hull, 1 sample", {{1, 4}}}};
  const std::string script = plot_script({both}, 1, "out.svg");
  EXPECT_NE(script.find("pt 5 ps 0.8 lc rgb \"#e69f00\""), std::string::npos) << script;
  EXPECT_NE(script.find("pt 4 ps 0.8 lc rgb \"#e69f00\""), std::string::npos) << script;
  EXPECT_NE(script.find("title \"quad\""), std::string::npos);
  EXPECT_EQ(script.find("title \"quad, 1 sample\""), std::string::npos);
  EXPECT_NE(script.find("title \"hull, 1 sample\""), std::string::npos) << "it stands alone";
}

TEST(ReportPlot, LeavesOutWhatALogarithmCannotShow) {
  const std::string script = plot_script({panel()}, 1, "out.svg");
  EXPECT_NE(script.find("$d0_0 << EOD\n1 2\n8 0.5\nEOD"), std::string::npos) << script;
  EXPECT_NE(script.find("$d0_1 << EOD\nNaN NaN\nEOD"), std::string::npos);
}

TEST(ReportPlot, ShowsNoErrorOnALinearAxis) {
  Panel flat{"", "x", "y", true, true, {{"auto", {{1, 0}, {2, 0}}}}, {}, {}};
  const std::string script = plot_script({flat}, 1, "out.svg");
  EXPECT_EQ(script.find("set logscale y"), std::string::npos);
  EXPECT_NE(script.find("1 0\n2 0\n"), std::string::npos);
}

TEST(ReportPlot, IdsOfSeveralPicturesDoNotMeet) {
  const std::string svg = inline_svg(
      "<?xml version=\"1.0\"?>\n<svg><g id=\"gnuplot_canvas\"/><circle id='gpDot'/>"
      "<use xlink:href='#gpDot'/></svg>",
      "one");
  EXPECT_EQ(svg,
            "<svg><g id=\"one_gnuplot_canvas\"/><circle id='one_gpDot'/>"
            "<use xlink:href='#one_gpDot'/></svg>");
}

std::vector<std::uint8_t> glb(std::string json) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::vector<std::uint8_t> out;
  const auto word = [&](std::size_t v) {
    for (int i = 0; i < 4; ++i) out.push_back(static_cast<std::uint8_t>(v >> (8 * i)));
  };
  word(0x46546c67), word(2), word(12 + 8 + json.size() + 12), word(json.size()), word(0x4e4f534a);
  out.insert(out.end(), json.begin(), json.end());
  word(4), word(0x004e4942), word(0x04030201);
  return out;
}

TEST(AlphaTested, ChangesBlendedMaterialsAndNothingElse) {
  const auto changed = alpha_tested(glb(
      R"({"materials":[{"alphaMode":"BLEND","name":"leaf"},{"alphaMode":"OPAQUE"},{}],"x":[1.5]})"));
  ASSERT_TRUE(changed.ok());
  EXPECT_EQ(*changed, glb(R"({"materials":[{"alphaMode":"MASK","name":"leaf","alphaCutoff":0.5},)"
                          R"({"alphaMode":"OPAQUE"},{}],"x":[1.5]})"));
}

TEST(AlphaTested, RefusesWhatIsNoGlb) {
  std::vector<std::uint8_t> cut = glb("{}");
  cut[12] = 255;  // a chunk longer than the file
  EXPECT_EQ(alpha_tested(cut).error().id, ErrorId::kSceneFormat);
  EXPECT_EQ(alpha_tested({}).error().id, ErrorId::kSceneFormat);
  EXPECT_EQ(alpha_tested(glb("{")).error().id, ErrorId::kSceneFormat);
}

}  // namespace
}  // namespace mirage::test
