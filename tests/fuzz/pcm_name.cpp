// SPDX-License-Identifier: MIT
// Names of PCMs as an array file may say them: what passes is a name, and leads to no file and no command.
#include <cstring>
#include <memory>
#include <string>

#include <alsa/asoundlib.h>

#include "holds.hpp"
#include "sink/alsa/error_text.hpp"
#include "sink/alsa/handle.hpp"
#include "sink/alsa/plain_name.hpp"
#include "sink/alsa/route.hpp"

using namespace tactor;

namespace {

using configuration = std::unique_ptr<snd_config_t, alsa::deleter<snd_config_delete>>;

// Returns the stock definitions that take names, files and commands.
configuration stock()
{
    constexpr const char* text =
        "pcm.hw { @args [ CARD DEV ] @args.CARD { type string default 0 } @args.DEV { type integer default 0 "
        "}\n"
        " type hw card $CARD device $DEV }\n"
        "pcm.plug { @args [ SLAVE ] @args.SLAVE { type string } type plug slave.pcm $SLAVE }\n"
        "pcm.file { @args [ FILE FORMAT ] @args.FILE { type string } @args.FORMAT { type string default raw "
        "}\n"
        " type file slave.pcm null file $FILE format $FORMAT }\n"
        "pcm.tee { @args [ SLAVE FILE ] @args.SLAVE { type string } @args.FILE { type string }\n"
        " type file slave.pcm $SLAVE file $FILE format raw }\n"
        "pcm.null { type null }\n";
    snd_config_t* top = nullptr;
    HOLDS(snd_config_load_string(&top, text, 0) == 0);
    return configuration(top);
}

// Looks at a whole definition, the one that ALSA would open, and at those that it names. A card may be called
// "file".
void check_tree(snd_config_t* top, snd_config_t* node, const std::string& id, int depth)
{
    const char* said = nullptr;
    if (snd_config_get_string(node, &said) >= 0 && said != nullptr) {
        HOLDS(std::strpbrk(said, "|/{}\"\n;$@\\") == nullptr);
        HOLDS(id != "type" || std::strcmp(said, "file") != 0);
        snd_config_t* next = nullptr;
        if (id == "pcm" && depth < 4 && snd_config_search_definition(top, "pcm", said, &next) >= 0)
            check_tree(top, configuration(next).get(), "", depth + 1);
    }
    alsa::for_each_member(node,
                          [&](const std::string& of, snd_config_t* m) { check_tree(top, m, of, depth); });
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    static const configuration top = stock();
    const alsa::library_messages silent;
    const std::string name(fuzz::as_text(data, size));
    if (!alsa::find_plain_name_fault(name).empty())
        return 0;
    HOLDS(name.find('\0') == name.npos && name.size() <= 200);
    const auto route = alsa::find_route(top.get(), name);
    snd_config_t* definition = nullptr;
    if (snd_config_search_definition(top.get(), "pcm", name.c_str(), &definition) < 0) {
        HOLDS(route.empty());
        return 0;
    }
    const stream_wiring w = alsa::find_wiring(top.get(), name, 9, 9);
    HOLDS(w.outputs.empty() || w.hidden_by.empty());
    const configuration owned(definition);
    if (alsa::unsafe_type(route).empty())
        check_tree(top.get(), definition, "", 0);
    return 0;
}
