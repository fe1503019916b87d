// SPDX-License-Identifier: MIT
/// \file
/// A machine with sound cards, made of files.
#pragma once

#include <filesystem>
#include <string>

#include "folder.hpp"

namespace tactor::test {

/// A folder with a /proc and a /dev.
class fake_system {
public:
    void write(const std::filesystem::path& file, const std::string& text) const { files_.write(file, text); }
    void two_cards() const
    {
        write("proc/asound/cards", " 0 [Headphones     ]: bcm2835_headpho - bcm2835 Headphones\n"
                                   "                      bcm2835 Headphones\n"
                                   " 2 [DAC8x          ]: HifiberryDac8x - snd_rpi_hifiberry_dac8x\n"
                                   "                      snd_rpi_hifiberry_dac8x\n");
        write("proc/asound/pcm", "00-00: bcm2835 Headphones : bcm2835 Headphones : playback 8\n"
                                 "02-00: HifiBerry DAC8x : : playback 1\n"
                                 "02-01: HifiBerry DAC8x : : capture 1\n"
                                 "02-03: more : : playback 1 : capture 1\n");
    }
    void process(int pid, const std::string& program, const std::filesystem::path& opened) const
    {
        const std::filesystem::path dir = root() / "proc" / std::to_string(pid);
        write(dir / "comm", program + "\n");
        std::filesystem::create_directories(dir / "fd");
        std::filesystem::create_symlink("/dev/null", dir / "fd/0");
        std::filesystem::create_symlink(opened, dir / "fd/7");
    }
    const std::filesystem::path& root() const { return files_.path(); }

private:
    folder files_;
};

} // namespace tactor::test
