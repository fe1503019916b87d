// SPDX-License-Identifier: MIT
// Definitions of experiments, and the outlines that the analysis needs.
#include <string>
#include <utility>

#include <doctest/doctest.h>

#include "caught.hpp"
#include "folder.hpp"
#include "has.hpp"
#include "study/experiment/read_definition.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study::test_definition {
namespace {

const std::string head = "[experiment]\nname = \"e\"\n";
const std::string motion = "[[motion]]\nname = \"m\"\npreset = \"park2016-1\"\n";
const std::string methods = "[[method]]\nname = \"a\"\nalgorithm = \"tactile-brush\"\n"
                            "[[method]]\nname = \"b\"\nalgorithm = \"park2016\"\n";
const std::string run = "[[run]]\nname = \"r\"\ntask = \"choose\"\nattribute = \"similarity\"\ntrials = 4\n";

experiment_definition read(const std::string& text)
{
    return read_definition(text, "e.toml", {});
}

std::string refusal(const std::string& text)
{
    return caught_message([&] { read(text); });
}

TEST_CASE("the shipped experiment is the paper's")
{
    const experiment_definition d = load_definition("park2016");
    CHECK_FALSE(d.array); // the configuration's holds
    CHECK(!d.level_dbfs);
    CHECK(d.sl_db == 7.0);
    CHECK(d.gap_s == 1.0);
    REQUIRE(d.runs.size() == 4);
    for (const run_definition& r : d.runs) {
        CHECK(r.outline.trials == 40);
        CHECK(r.motions == std::vector<std::size_t>{0, 1, 2, 3});
        CHECK(r.methods == std::vector<std::size_t>{0, 1});
        CHECK(r.animation == (r.attribute == "similarity"));
    }
    CHECK(d.runs[2].outline.task == &find_task("rate"));
    CHECK(d.runs[2].outline.scale == 5);
    CHECK(d.methods[0].options.plan.algorithm == algorithm_kind::tactile_brush);
    CHECK(d.text == park2016_text());
    CHECK(d.masking.noise->color == noise_color::white);
}

TEST_CASE("a recording of a motion may have intensities of another scale")
{
    const folder f;
    f.write("r.csv", "t_s,x_mm,y_mm,intensity\n0,0,0,255\n0.5,20,0,51\n");
    const auto with = [&f](const std::string& more) {
        return read_definition(head + "[[motion]]\nname = \"m\"\n" + more + methods + run, "e.toml",
                               f.path());
    };
    const experiment_definition d = with("file = \"r.csv\"\nintensity_max = 255\n");
    CHECK(d.motions[0].strokes[0].motion.intensity(0.5) == doctest::Approx(0.2));
    has(caught_message([&] { with("file = \"r.csv\"\n"); }), "intensity_max");
    has(caught_message([&] { with("file = \"r.csv\"\nintensity_max = 255\nposition = \"Left\"\n"); }),
        "has no positions");
    has(caught_message([&] { with("preset = \"park2016-1\"\nintensity_max = 255\n"); }),
        "[[motion]] has no file");
}

TEST_CASE("missing keys have defaults")
{
    const experiment_definition d = read(head + motion + methods + run);
    CHECK(d.title == "e");
    CHECK(d.sl_db == 7.0);
    CHECK(d.gap_s == 1.0);
    CHECK(!d.seed);
    CHECK(!d.array);
    CHECK(!d.masking.noise);
    for (const page_word& w : english_page_words())
        CHECK(d.page[w.key] == w.english);
    CHECK(d.runs[0].practice == 0);
    CHECK(!d.runs[0].outline.question.empty());
    CHECK(d.runs[0].break_s == 0.0);
}

TEST_CASE("a motion takes the keys of a stroke, with the unit in the key or without")
{
    const auto duration = [](const std::string& m) {
        return read(head + "[[motion]]\nname = \"m\"\n" + m + methods + run)
            .motions[0]
            .strokes[0]
            .motion.duration_s();
    };
    CHECK(duration("preset = \"park2016-1\"\nduration = 2.8\n") == 2.8);
    CHECK(duration("preset = \"park2016-1\"\nduration_s = 2.8\n") == 2.8);
    CHECK(duration("path = \"M0 0H40\"\nspeed = 20\n") == doctest::Approx(2.0));
    CHECK(duration("path = \"M0 0H30\"\n") == doctest::Approx(0.5)); // 60 mm/s
}

TEST_CASE("a method takes the options of a plan")
{
    const experiment_definition d =
        read(head + motion +
             "[[method]]\nname = \"a\"\nalgorithm = \"continuous\"\nphantom = \"gaussian\"\ncarrier = 200\n"
             "[[method]]\nname = \"b\"\nsoa = 0.06\nslope = 0.3\nintercept = 0.04\ndrop-points = true\nsnap "
             "= true\nfaces = \"nearest\"\n" +
             run);
    CHECK(d.methods[0].options.plan.phantom == phantom_kind::gaussian);
    CHECK(d.methods[0].options.plan.carrier_hz == 200.0);
    const plan_options& b = d.methods[1].options.plan;
    CHECK(b.soa_s == 0.06);
    CHECK(b.profile.max_soa_s == doctest::Approx(0.04 / 0.7));
    CHECK(b.drop_points);
    CHECK(b.snap);
    CHECK(b.faces == faces_kind::nearest);
}

TEST_CASE("a method takes the sound, the level, the pace and the stroke of a stroke")
{
    const std::string level = "level = { dbfs = -18 }\n";
    const experiment_definition d =
        read(head + level + motion +
             "[[method]]\nname = \"a\"\nwaveform = \"square\"\nam = \"30:0.5\"\nenvelope = \"tukey:0.3\"\n"
             "phase = \"burst\"\ncompensate = \"low-speed\"\nsigma_mm = 4\nlevel_dbfs = -20\nduration_s = 2\n"
             "[[method]]\nname = \"b\"\nintensity_scale = \"sl\"\nsl_db = 10\nattack_s = 0.01\n"
             "path = \"M0 0H30\"\nspeed = 20\n" +
             run);
    const method_definition& a = d.methods[0];
    CHECK(a.options.plan.wave.kind == waveform_kind::square);
    CHECK(a.options.plan.am == modulation{30.0, 0.5});
    CHECK(a.options.render.envelope == burst_envelope{.kind = envelope_kind::tukey, .tukey_part = 0.3});
    CHECK(a.options.render.phase == phase_kind::burst);
    CHECK(a.options.compensate);
    CHECK(a.options.low_speed.sigma_mm == 4.0);
    CHECK(a.options.render.level_dbfs == -20.0);
    CHECK(!a.options.render.sl_db);
    CHECK(a.options.duration_s == 2.0);
    CHECK(a.strokes.empty());
    const method_definition& b = d.methods[1];
    CHECK(b.options.render.sl_db == 10.0);
    CHECK(b.options.plan.scale.sl_db == 10.0);
    CHECK(b.options.render.envelope.attack_s == 0.01);
    REQUIRE(b.strokes.size() == 1);
    CHECK(b.strokes[0].motion.duration_s() == doctest::Approx(1.5));
    CHECK(a.has_level());
    CHECK(uses_thresholds(d));
    const experiment_definition plain = read(head + level + motion + methods + run);
    CHECK(!plain.methods[0].has_level());
    CHECK(!uses_thresholds(plain));
    CHECK(uses_thresholds(read(head + motion + methods + run)));
}

TEST_CASE("a session's text is read without the files of its methods")
{
    const std::string named = head + motion +
                              "[[method]]\nname = \"a\"\nwaveform = \"gone.wav\"\ntexture = \"time\"\n"
                              "[[method]]\nname = \"b\"\nfile = \"gone.csv\"\n" +
                              run;
    const experiment_definition d = read_design(named, "session.json");
    CHECK(d.methods[0].options.plan.wave.recorded->file == "gone.wav");
    CHECK(d.methods[1].strokes.empty());
    has(refusal(named), "gone.wav");
}

TEST_CASE("an attribute is any words, and says what an observer judges where it is a known one")
{
    const experiment_definition known = read(head + motion + methods + run);
    CHECK(known.runs[0].simulate_as == "similarity");
    CHECK(known.runs[0].min_response_s == 0.15);
    const std::string pleasant =
        "[[run]]\nname = \"r\"\ntask = \"rate\"\nattribute = \"pleasant, or not\"\ntrials = 4\n";
    const std::string asked = "question = \"How pleasant?\"\nmin_response_s = 0.3\n";
    const experiment_definition d = read(head + motion + methods + pleasant + asked);
    CHECK(d.runs[0].attribute == "pleasant, or not");
    CHECK(d.runs[0].simulate_as.empty());
    CHECK(d.runs[0].min_response_s == 0.3);
    const std::string as = "simulate_as = \"uniformity\"\n";
    CHECK(read(head + motion + methods + pleasant + asked + as).runs[0].simulate_as == "uniformity");
    has(refusal(head + motion + methods + pleasant), "no question");
}

TEST_CASE("a rest is one time, or two between which it is drawn")
{
    const auto rest = [](const std::string& text) {
        const rest_range r = read(head + "rest_s = " + text + "\n" + motion + methods + run).rest;
        return std::pair(r.least_s, r.most_s);
    };
    CHECK(rest("2.5") == std::pair(2.5, 2.5));
    CHECK(rest("[2, 4]") == std::pair(2.0, 4.0));
    for (const char* wrong : {"[4, 2]", "[2]", "[1, 2, 3]", "[-1, 2]", "[1, 61]", "\"2\""})
        has(refusal(head + "rest_s = " + wrong + "\n" + motion + methods + run), "e.toml:3:");
}

const std::string group = "[[group]]\nname = \"g\"\n";

TEST_CASE("a group has some of the runs, motions and methods")
{
    const std::string text =
        head + motion + "[[motion]]\nname = \"n\"\npreset = \"park2016-2\"\n" + methods + run +
        "[[run]]\nname = \"s\"\ntask = \"rate\"\nattribute = \"similarity\"\ntrials = 4\n"
        "motions = [\"n\"]\n[[group]]\nname = \"all\"\n[[group]]\nname = \"some\"\nruns = [\"s\"]\n"
        "methods = [\"b\"]\n";
    const experiment_definition d = read(text);
    REQUIRE(d.outline.groups.size() == 2);
    CHECK(d.outline.groups[0] == group_outline{"all", d.outline.runs});
    CHECK(d.outline.groups[1].name == "some");
    CHECK(describe_group(d.outline.groups[1]) == "s: motions n, methods b");
    CHECK(read_outline(text, "e.toml") == d.outline);
}

TEST_CASE("the words that stay English are listed where others are given")
{
    CHECK(read(head + motion + methods + run).page.warning().empty());
    std::string words = "[page]\n";
    for (const page_word& w : english_page_words())
        if (w.key != "felt" && w.key != "calibrate_which")
            words += std::string(w.key) + " = \"x\"\n";
    CHECK(read(head + words + motion + methods + run).page.warning() ==
          "[page] lacks felt, calibrate_which, which stay English");
}

TEST_CASE("faults have their line")
{
    const auto says = [](const std::string& text, const char* where, const char* what) {
        const std::string message = refusal(text);
        CHECK_MESSAGE(has(message, where), message);
        CHECK_MESSAGE(has(message, what), message);
    };
    says(head + "gap = 1\n" + motion + methods + run, "e.toml:3:", "did you mean 'gap_s'");
    says(head + motion + methods + run + "trails = 3\n", "e.toml:17:", "did you mean 'trials'");
    says(motion + methods + run, "e.toml", "no [experiment]");
    says(head + methods + run, "e.toml", "no [[motion]]");
    says(head + motion + run, "e.toml", "no [[method]]");
    says(head + motion + methods, "e.toml", "no [[run]]");
    const std::string form = "[[run]]\nname = \"f\"\ntask = \"questionnaire\"\n";
    const std::string item = "[[run.item]]\nname = \"i\"\nquestion = \"?\"\nkind = ";
    const std::string choice = "\"choice\"\nchoices = [\"a\", \"b\"]\n";
    says(head + motion + methods + form + item + choice, "e.toml", "each [[run]] is a questionnaire");
    const auto form_says = [&](const std::string& own, int line, const char* what) {
        // The run with trials ends in line 16.
        says(head + motion + methods + run + form + own, ("e.toml:" + std::to_string(line) + ":").c_str(),
             what);
    };
    form_says("trials = 3\n" + item + choice, 20, "unknown key 'trials'");
    form_says("when = \"later\"\n" + item + choice, 20, "later");
    form_says("", 17, "has no question");
    form_says(item + choice + form + item + choice, 26, "\"f\" occurs twice");
    form_says(item + choice + item + choice, 26, "\"i\" occurs twice");
    form_says("[[run.item]]\nname = \"a b\"\n", 21, "name is 'a b'");
    form_says("[[run.item]]\nname = \"after\"\nquestion = \"?\"\nkind = " + choice, 21, "occurs twice");
    form_says(item + "\"choice\"\nchoices = [\"a\"]\n", 24, "a choice has 1 text");
    form_says(item + "\"text\"\nrange = [1, 2]\n", 24, "range does not apply to a text");
    form_says(item + "\"number\"\n", 20, "no range");
    form_says(item + "\"number\"\nrange = [2, 1]\n", 24, "give the smallest and the largest");
    form_says(item + "\"number\"\nrange = [0, 10000]\n", 24, "give the smallest and the largest");
    form_says(item + "\"scale\"\n", 23, "a scale has 0 labels");
    form_says(item + "\"scale\"\nscale = \"vas\"\n", 23, "0 labels");
    form_says(item + "\"scale\"\nscale = 4\nlabels = [\"a\", \"b\", \"c\"]\n", 25, "3 labels");
    says(head + "level = { sl_db = 7, dbfs = -18 }\n" + motion + methods + run, "e.toml:3:", "both");
    says(head + "level = { dbfs = 3 }\n" + motion + methods + run, "e.toml:3:", "dbfs is 3");
    says(head + "seed = -1\n" + motion + methods + run, "e.toml:3:", "seed is -1");
    says(head + "array = \"palm-9x9\"\n" + motion + methods + run, "e.toml:3:", "palm-9x9");
    says(head + "[page]\nlanguage = 7\n" + motion + methods + run, "e.toml:4:", "language");
    says(head + "[page]\nfell = \"?\"\n" + motion + methods + run, "e.toml:4:", "did you mean 'felt'");
    says(head + "[masking]\nnoise = \"brown\"\n" + motion + methods + run, "e.toml:4:", "brown");
    says(head + "[[motion]]\nname = \"m\"\npreset = \"park2016-9\"\n" + methods + run,
         "e.toml:5:", "park2016-9");
    says(head + "[[motion]]\nname = \"m\"\npreset = \"park2016-1\"\npath = \"M0 0H9\"\n" + methods + run,
         "e.toml:6:", "both preset and path");
    says(head + "[[motion]]\nname = \"m\"\npreset = \"park2016-1\"\nduration = 1\nspeed = 9\n" + methods +
             run,
         "e.toml:7:", "both duration and speed");
    says(head + "[[motion]]\nname = \"m\"\npreset = \"park2016-1\"\nspeed = 9\nspeed_mm_s = 9\n" + methods +
             run,
         "e.toml:7:", "both speed and speed_mm_s");
    says(head + "[[motion]]\nname = \"m\"\nfile = \"none.csv\"\n" + methods + run, "e.toml:5:", "none.csv");
    says(head + "[[motion]]\nname = \"a\\tb\"\npreset = \"park2016-1\"\n" + methods + run,
         "e.toml:4:", "tabs");
    // A present key in its other spelling is not reported as unknown.
    says(head + motion + "[[method]]\nname = \"a\"\ndrop-points = true\nsoa_s = 0.06\nburts = 0.05\n" + run,
         "e.toml", "unknown key 'burts' in [[method]] (did you mean 'burst'?)");
    struct bad_method {
        const char* keys;
        const char* where;
        const char* what;
    };
    for (const bad_method& m : {
             bad_method{"algorithm = \"brush\"", "e.toml:8:", "tactile-brush"},
             bad_method{"mirror = true", "e.toml:8:", "unknown key 'mirror' in [[method]]"},
             bad_method{"carrier_hz = 0", "e.toml:8:", "carrier_hz: 0 is out of range"},
             bad_method{"sl_db = 200", "e.toml:8:", "sl_db: 200 is out of range"},
             bad_method{"level_dbfs = -20\nsl_db = 7",
                        "e.toml:9:", "sl_db: it cannot be combined with level_dbfs"},
             bad_method{"duration = 1\nspeed = 9", "e.toml:9:", "speed: it cannot be combined with duration"},
             bad_method{"carrier = 100\ncarrier_hz = 100", "e.toml:9:", "has carrier twice"},
             bad_method{"snap = true\nnoise_seed = 2",
                        "e.toml:9:", "nothing here uses it (add waveform = \"noise:LO-HI\")"},
             bad_method{"sigma_mm = 3", "e.toml:8:", "(add compensate = \"low-speed\")"},
             bad_method{"envelope = \"tukey\"\nattack = 0.01", "e.toml:9:", "has its own ramps"},
             bad_method{"intensity_scale = \"sl\"\nlevel_dbfs = -20", "e.toml:8:", "such as sl = 7)"},
             bad_method{"waveform = \"none.wav\"", "e.toml:8:", "waveform: none.wav"},
             bad_method{"am = \"fast\"", "e.toml:8:", "am: \"fast\" is not HZ"},
             bad_method{"file = \"none.csv\"", "e.toml:8:", "none.csv"},
             bad_method{"preset = \"park2016-1\"\npath = \"M0 0H9\"", "e.toml:9:", "both preset and path"},
             bad_method{"intensity_max = 2", "e.toml:8:", "[[method]] has no file"},
         })
        says(head + motion + "[[method]]\nname = \"a\"\n" + m.keys + "\n" + run, m.where, m.what);
    says(head + motion + "[[method]]\nname = \"a\"\n" + run, "e.toml",
         "run \"r\" has one method to choose from");
    says(head + motion + methods + "[[run]]\nname = \"r\"\ntask = \"guess\"\ntrials = 4\n",
         "e.toml:14:", "guess");
    says(head + motion + methods + "[[run]]\nname = \"r\"\ntask = \"rate\"\ntrials = 4\n",
         "e.toml:12:", "no attribute");
    says(head + motion + methods + run + "scale = 7\n", "e.toml:17:",
         "scale does not apply to runs with task \"choose\" (leave out scale, or set task to \"rate\")");
    says(head + motion + methods + "[[run]]\nname = \"r\"\ntask = \"rate\"\nattribute = \"similarity\"\n",
         "e.toml:12:", "no trials");
    const std::string rate =
        "[[run]]\nname = \"r\"\ntask = \"rate\"\nattribute = \"similarity\"\ntrials = 4\n";
    says(head + motion + methods + "[[run]]\nname = \"r\"\ntask = \"rate\"\nattribute = \"a\"\ntrials = 0\n",
         "e.toml:16:", "trials is 0");
    for (const char* none : {"[\"a\"]", "[\"a\", \"b\", \"c\"]"})
        says(head + motion + methods + rate + "labels = " + none + "\n",
             "e.toml:17:", "for a scale of 5 (give one for each end, or one for each step)");
    const std::string line = rate + "scale = \"vas\"\n";
    says(head + motion + methods + line,
         "e.toml:17:", "labels has 0 texts for a visual analogue scale (give one for each end)");
    says(head + motion + methods + line + "labels = [\"a\"]\n", "e.toml:18:", "labels has 1 text for");
    says(head + motion + methods + line + "labels = [\"a\", \"b\", \"c\"]\n",
         "e.toml:18:", "labels has 3 texts for a visual analogue scale");
    says(head + motion + methods + rate + "choices = [\"a\", \"b\"]\n", "e.toml:17:",
         "choices does not apply to runs with task \"rate\" (leave out choices, or set task to one of "
         "\"choose\"");
    says(head + motion + methods + run + "choices = [\"a\"]\n",
         "e.toml:17:", "choices has 1 text, but there are two answers (give one text for each answer)");
    says(head + motion + methods + run + "choices = [\"a\", \"b\", \"c\"]\n",
         "e.toml:17:", "choices has 3 texts");
    says(head + motion + methods + run + "methods = [\"a\", \"c\"]\n", "e.toml:17:", "undefined name");
    says(head + motion + methods + run + run, "e.toml:18:", "the same name");
    says(head + "order = \"latn\"\n" + motion + methods + run, "e.toml:3:", "did you mean 'latin'");
    says(head + motion + methods + run + "blocks = \"motion\"\n", "e.toml:17:", "did you mean 'motions'");
    says(head + motion + methods + run + "blocks = \"methods\"\n",
         "e.toml:17:", "run \"r\" has two methods in each trial");
    const std::string with_group = head + motion + methods + run + group;
    says(with_group + "runs = [\"s\"]\n", "e.toml:19:", "runs has an undefined name (use one of r)");
    says(with_group + "method = [\"a\"]\n", "e.toml:19:", "did you mean 'methods'");
    says(with_group + "methods = [\"a\"]\n",
         "e.toml:17:", "run \"r\" has one method to choose from (name two or more in methods)");
    says(head + motion + "[[motion]]\nname = \"n\"\npreset = \"park2016-2\"\n" + methods + run +
             "motions = [\"m\"]\n" + group + "motions = [\"n\"]\n",
         "e.toml:21:",
         "r has no motion or no method (leave this run out of runs, or name motions and methods for it)");
    says(with_group + group, "e.toml:20:", "the group \"g\" occurs twice");
}

TEST_CASE("a missing experiment lists the existing ones")
{
    has(caught_message([] { load_definition("park2017"); }), "park2016, or name a file");
    has(caught_message([] { load_definition("./none.toml"); }), "none.toml");
}

const std::string outline_head =
    "[experiment]\nname = \"e\"\n"
    "[[motion]]\nname = \"a\"\n[[motion]]\nname = \"b\"\n"
    "[[method]]\nname = \"old\"\n[[method]]\nname = \"other\"\n[[method]]\nname = \"new\"\n";

std::string outline_refusal(const std::string& text)
{
    return caught_message([&] { read_outline(text, "e.toml"); });
}

TEST_CASE("runs in order, motions and methods in the order of the definition")
{
    const experiment_outline e = read_outline(
        outline_head + "[[run]]\nname = \"how good\"\ntask = \"rate\"\nscale = 7\ntrials = 12\n"
                       "[[run]]\nname = \"which-one\"\ntask = \"choose\"\nmethods = [\"new\", \"old\"]\n"
                       "[[run]]\nname = \"what\"\ntask = \"identify\"\nmotions = [\"b\", \"a\"]\n",
        "e.toml");
    CHECK(e.name == "e");
    REQUIRE(e.runs.size() == 3);
    CHECK(e.runs[0].file_name == "howgood");
    CHECK(e.runs[0].methods == std::vector<std::string>{"old", "other", "new"});
    CHECK(e.runs[0].scale == 7);
    CHECK(e.runs[0].trials == 12);
    CHECK(e.runs[1].task == &find_task("choose"));
    CHECK(e.runs[1].methods == std::vector<std::string>{"old", "new"});
    CHECK(e.runs[2].motions == std::vector<std::string>{"a", "b"});
}

TEST_CASE("ratings begin with 1, on a visual analogue scale with 0")
{
    const auto range = [](const std::string& scale) {
        const std::string text = outline_head + "[[run]]\nname = \"r\"\ntask = \"rate\"\n" + scale;
        return rating_range(read_outline(text, "e.toml").runs[0]);
    };
    CHECK(range("") == "1 to 5");
    CHECK(range("scale = 101\n") == "1 to 101");
    CHECK(range("scale = \"vas\"\n") == "0 to 100 on a visual analogue scale");
}

TEST_CASE("faults have their line")
{
    const auto with = [](const std::string& keys) {
        return outline_refusal(outline_head + "[[run]]\n" + keys);
    };
    CHECK(with("task = \"rate\"\n").find("[[run]] has no name") != std::string::npos);
    CHECK(with("name = \"-\"\ntask = \"rate\"\n").find("no letter or digit") != std::string::npos);
    has(with("name = \"r\"\ntask = \"choose\"\nmethods = [\"new\"]\n"),
        "run \"r\" has one method to choose from");
    CHECK(with("name = \"r\"\ntask = \"choose\"\n").empty()); // of three
    has(with("name = \"r\"\ntask = \"rate\"\nmotions = [\"c\"]\n"),
        "motions has an undefined name (use one of a, b)");
    for (const char* beyond :
         {"scale = 1", "scale = 102", "scale = 7.5", "scale = \"line\"", "trials = 0", "trials = 10001"})
        CHECK(with(std::string("name = \"r\"\ntask = \"rate\"\n") + beyond + "\n").find("e.toml:16:") == 0);
    has(with("name = \"r\"\ntask = \"identify\"\nmotions = [\"a\"]\n"), "one motion to identify");
    has(with("name = \"r 1\"\ntask = \"rate\"\n[[run]]\nname = \"r-1\"\ntask = \"rate\"\n"),
        "\"r 1\" and \"r-1\" would have the same name");
    has(outline_refusal(outline_head + "[[method]]\nname = \"old\"\n"), "the method \"old\" occurs twice");
}

TEST_CASE("keys that the analysis does not need are skipped")
{
    CHECK(
        outline_refusal("[masking]\nnoise = 7\n" + outline_head +
                        "algorithm = 7\nnew = true\n[[run]]\nname = \"r\"\ntask = \"choose\"\nscale = 7\n"
                        "attribute = \"likeness\"\nmethods = [\"old\", \"new\"]\nbreak = \"long\"\n[other]\n")
            .empty());
}

} // namespace
} // namespace tactor::study::test_definition
