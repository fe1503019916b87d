// SPDX-License-Identifier: MIT
/// \file
/// Programs that speak the older protocol of the bHaptics player (SDK1), as clients of the service. Knows no
/// socket.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>

#include <tactor/array.hpp>

#include "net/rpc.hpp"
#include "server/service.hpp"

namespace tactor::server {

/// Returns the strokes of a frame as a stroke file in TOML, on the array's bounding box; empty for a frame
/// without a touch. Reads numbers that are texts, too, and ignores what is not a number.
std::string frame_to_toml(const net::json& frame, const array& on);

/// A motor of a bHaptics device that an avatar of VRChat touches.
struct vrchat_motor {
    std::int32_t number = 0; ///< for its live stroke
    point place = {};        ///< on the array
};

/// Reads an address such as /avatar/parameters/bOSC_v1_VestFront_7, also with / between its words; nothing
/// for others, and for devices that are not played.
std::optional<vrchat_motor> read_vrchat(std::string_view address, const array& on);

/// Changes a project as a submission asks: stretches its times, scales its intensities up to 1, and turns it
/// round the body and up.
void change_project(net::json& project, const net::json& parameters);

/// A program. Its strokes end when its connection ends. The protocol has no errors: what cannot be played is
/// ignored. Members are called in the context's thread.
class bhaptics_program final : public client_link, public std::enable_shared_from_this<bhaptics_program> {
public:
    /// Most registered projects, and bytes of all of them.
    static constexpr std::size_t most_projects = 1024;
    static constexpr std::size_t most_bytes = 16U << 20;
    static constexpr std::size_t longest_key = 256;
    /// Most bytes of all keys as JSON, which each status has.
    static constexpr std::size_t most_key_bytes = 64U << 10;
    /// Most entries of a message that are handled, because this happens in the thread of the sockets.
    static constexpr std::size_t most_entries = 1024;

    /// `to`: connection to the program.
    bhaptics_program(boost::asio::io_context& io, service& s, std::shared_ptr<client_link> to,
                     std::size_t most_nesting)
        : io_(io), service_(s), to_(std::move(to)), most_nesting_(most_nesting)
    {
    }

    /// Begins to send the status, as the client `number` of the service.
    void begin(client_number number);
    /// Handles a message. Calls `done`, if there is one, when it was parsed.
    void receive(std::string text, std::function<void(bool)> done = {});

    void send(std::string /*message*/) override {} // answers go to their requests
    void notify(std::string_view method, const net::reply_json& params) override;
    std::size_t queued_bytes() const override { return to_->queued_bytes(); }
    void finish() override { to_->finish(); }

private:
    /// Strokes under a key.
    struct playing {
        std::vector<std::uint32_t> strokes = {}; ///< numbers of the service
        bool is_asked = false;                   ///< a request has no answer yet
        std::optional<net::json> next = {};      ///< newest submission since
        bool is_off = false;                     ///< turned off since
    };

    void handle_message(const net::json& message);
    void add_project(const net::json& entry);
    void submit(const net::json& entry);
    void submit_project(const std::string& key, const net::json& entry);
    void play(const std::string& key, net::json params);
    void on_answer(const std::string& key, std::vector<std::uint32_t> strokes);
    void go_on(const std::string& key);
    void forget(std::map<std::string, playing>::iterator p);
    void turn_off(const std::string& key);
    void cancel(const std::vector<std::uint32_t>& strokes);
    void run_on_planner(std::function<void()> work, std::function<void()> done);
    void schedule_status();
    void send_status();

    boost::asio::io_context& io_;
    service& service_;
    std::shared_ptr<client_link> to_;
    std::size_t most_nesting_;
    client_number number_ = 0;
    std::map<std::string, std::string> projects_; ///< texts by key
    std::size_t bytes_ = 0;                       ///< of all projects and their keys
    std::size_t key_bytes_ = 0;                   ///< of all keys as JSON
    std::map<std::string, playing> playing_;
    unsigned changing_ = 0;                             ///< submissions whose project is being changed
    net::reply_json levels_ = net::reply_json::array(); ///< of the tactors, 0 to 100
    bool is_connected_ = false;                         ///< the stream is not lost
    bool tells_ = false;                                ///< a status is due
};

} // namespace tactor::server
