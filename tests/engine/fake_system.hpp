// SPDX-License-Identifier: MIT
/// \file
/// A machine with sound cards, made of files.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <doctest/doctest.h>

namespace tactor::test {

/// A folder with a /proc and a /dev of its own.
class fake_system {
public:
    fake_system()
    {
        std::string name = (std::filesystem::temp_directory_path() / "tactor-system-XXXXXX").string();
        REQUIRE(::mkdtemp(name.data()) != nullptr);
        root_ = name;
    }
    ~fake_system() { std::filesystem::remove_all(root_); }
    fake_system(const fake_system&) = delete;
    fake_system& operator=(const fake_system&) = delete;

    void write(const std::filesystem::path& file, const std::string& text) const
    {
        std::filesystem::create_directories((root_ / file).parent_path());
        std::ofstream(root_ / file) << text;
    }
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
        const std::filesystem::path folder = root_ / "proc" / std::to_string(pid);
        write(folder / "comm", program + "\n");
        std::filesystem::create_directories(folder / "fd");
        std::filesystem::create_symlink("/dev/null", folder / "fd/0");
        std::filesystem::create_symlink(opened, folder / "fd/7");
    }
    const std::filesystem::path& root() const { return root_; }

private:
    std::filesystem::path root_;
};

} // namespace tactor::test
