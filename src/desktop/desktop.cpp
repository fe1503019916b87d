// SPDX-License-Identifier: MIT
#include "desktop/desktop.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <systemd/sd-bus.h>
#include <unistd.h>

#include <fmt/format.h>

#include "core/owned.hpp"
#include "rt/event_fd.hpp"
#include "rt/thread.hpp"

namespace tactor::desktop {
namespace {

/// Address of a library function, which converts to a pointer of any function type.
struct symbol {
    void* address;
    template <class F>
    operator F*() const noexcept // NOLINT(google-explicit-constructor)
    {
        return reinterpret_cast<F*>(address);
    }
};

/// Functions of libsystemd. The library is loaded when it is needed, because linking its eight libraries
/// would make the tool start more slowly.
struct sd_functions {
    void* library = ::dlopen("libsystemd.so.0", RTLD_NOW | RTLD_LOCAL);
    bool complete = library != nullptr;

    symbol find(const char* name) noexcept
    {
        void* const found = library != nullptr ? ::dlsym(library, name) : nullptr;
        complete = complete && found != nullptr;
        return {found};
    }

#define TACTOR_SD_BUS(name) decltype(&::sd_bus_##name) name = find("sd_bus_" #name)
    TACTOR_SD_BUS(open_system);
    TACTOR_SD_BUS(open_user);
    TACTOR_SD_BUS(close_unref);
    TACTOR_SD_BUS(process);
    TACTOR_SD_BUS(wait);
    TACTOR_SD_BUS(get_fd);
    TACTOR_SD_BUS(get_events);
    TACTOR_SD_BUS(add_object);
    TACTOR_SD_BUS(call_method_async);
    TACTOR_SD_BUS(match_signal);
    TACTOR_SD_BUS(slot_unref);
    TACTOR_SD_BUS(message_ref);
    TACTOR_SD_BUS(message_unref);
    TACTOR_SD_BUS(message_get_errno);
    TACTOR_SD_BUS(message_is_method_call);
    TACTOR_SD_BUS(message_read);
    TACTOR_SD_BUS(reply_method_return);
#undef TACTOR_SD_BUS
};

const sd_functions& sd() noexcept
{
    static const sd_functions all;
    return all;
}

struct message_end {
    void operator()(sd_bus_message* m) const noexcept { sd().message_unref(m); }
};
using message = std::unique_ptr<sd_bus_message, message_end>;

/// Object and interface of a service.
struct remote {
    const char* name;
    const char* path;
    const char* interface;
};
constexpr remote bus_daemon{"org.freedesktop.DBus", "/org/freedesktop/DBus", "org.freedesktop.DBus"};
constexpr const char* properties = "org.freedesktop.DBus.Properties";

/// A connection to a bus. One thread at a time uses it. If connecting fails, it stays closed, and each call
/// fails.
class connection {
public:
    explicit connection(bool of_system) noexcept
    {
        if (sd().complete && (of_system ? sd().open_system : sd().open_user)(&bus_) < 0)
            bus_ = nullptr;
    }
    ~connection()
    {
        if (bus_ != nullptr)
            sd().close_unref(bus_);
    }
    connection(const connection&) = delete;
    connection& operator=(const connection&) = delete;

    sd_bus* get() const noexcept { return bus_; }

    /// Calls a method. Returns the reply, or null if it is an error or does not come within a second.
    template <class... T>
    message call(const remote& to, const char* method, const char* types, T... arguments) noexcept
    {
        using clock = std::chrono::steady_clock;
        const clock::time_point end = clock::now() + std::chrono::seconds(1);
        message reply;
        sd_bus_slot* slot = nullptr;
        int done = bus_ == nullptr ? -ENOTCONN
                                   : sd().call_method_async(bus_, &slot, to.name, to.path, to.interface,
                                                            method, keep, &reply, types, arguments...);
        while (done >= 0 && reply == nullptr && clock::now() < end) {
            done = sd().process(bus_, nullptr);
            const auto left = std::chrono::ceil<std::chrono::microseconds>(end - clock::now()).count();
            if (done == 0)
                done = sd().wait(bus_, static_cast<std::uint64_t>(std::max<std::int64_t>(0, left)));
            if (done == -EINTR)
                done = 0;
        }
        if (slot != nullptr)
            sd().slot_unref(slot); // drops a later reply
        return reply != nullptr && sd().message_get_errno(reply.get()) == 0 ? std::move(reply) : nullptr;
    }

    /// Calls a method and reads the single value of its reply. The value is valid until the next call of this
    /// function. `type`: type of the value, after "v" if the value is in a variant.
    template <class V, class... T>
    bool ask(V* value, std::string_view type, const remote& to, const char* method, const char* types,
             T... arguments) noexcept
    {
        last_ = call(to, method, types, arguments...);
        return last_ != nullptr &&
               (type[0] == 'v' ? sd().message_read(last_.get(), "v", type.data() + 1, value)
                               : sd().message_read(last_.get(), type.data(), value)) > 0;
    }

    /// Drops the reply whose value ask() read.
    void forget_reply() noexcept { last_.reset(); }

    /// Processes what arrives, until `stop` is signalled. After each time, calls `then` with true,
    /// or with false if the bus is gone.
    template <class Then>
    void process_until(const rt::event_fd& stop, const Then& then) noexcept
    {
        for (pollfd fds[] = {{stop.fd(), POLLIN, 0}, {sd().get_fd(bus_), 0, 0}}; fds[0].revents == 0;) {
            int done = 1;
            while (done > 0)
                done = sd().process(bus_, nullptr);
            then(done >= 0);
            if (done < 0)
                fds[1].fd = -1; // the bus is gone
            fds[1].events = static_cast<short>(sd().get_events(bus_));
            ::poll(fds, 2, -1);
        }
    }

private:
    static int keep(sd_bus_message* m, void* reply, sd_bus_error*) noexcept
    {
        static_cast<message*>(reply)->reset(sd().message_ref(m));
        return 1;
    }

    sd_bus* bus_ = nullptr;
    message last_;
};

// Lowers both limits on the time of real-time threads to `longest_us`. Keeps lower limits.
bool limit_runtime(std::int64_t longest_us) noexcept
{
    rlimit l{};
    if (longest_us <= 0 || ::getrlimit(RLIMIT_RTTIME, &l) != 0)
        return false;
    l.rlim_max = std::min(l.rlim_max, static_cast<rlim_t>(longest_us));
    l.rlim_cur = std::min(l.rlim_cur, l.rlim_max);
    return ::setrlimit(RLIMIT_RTTIME, &l) == 0;
}

constexpr const char* card_interface = "org.freedesktop.ReserveDevice1";

} // namespace

bool request_realtime(pid_t thread, int priority) noexcept
{
    constexpr remote kit{"org.freedesktop.RealtimeKit1", "/org/freedesktop/RealtimeKit1",
                         "org.freedesktop.RealtimeKit1"};
    constexpr remote facts{kit.name, kit.path, properties};
    connection bus(true);
    std::int64_t longest_us = 0;
    std::int32_t highest = 0;
    return bus.ask(&longest_us, "vx", facts, "Get", "ss", kit.interface, "RTTimeUSecMax") &&
           bus.ask(&highest, "vi", facts, "Get", "ss", kit.interface, "MaxRealtimePriority") && highest > 0 &&
           limit_runtime(longest_us) &&
           bus.call(kit, "MakeThreadRealtimeWithPID", "ttu", static_cast<std::uint64_t>(::getpid()),
                    static_cast<std::uint64_t>(thread),
                    static_cast<std::uint32_t>(std::min(priority, highest))) != nullptr;
}

struct reservation::impl {
    impl(unsigned card_index, std::function<bool()> g)
        : name(fmt::format("{}.Audio{}", card_interface, card_index)),
          path(fmt::format("/org/freedesktop/ReserveDevice1/Audio{}", card_index)),
          give_up(std::move(g))
    {
    }

    bool request_name(std::uint32_t flags) noexcept
    {
        constexpr std::uint32_t is_owner = 1;
        std::uint32_t result = 0;
        return bus.ask(&result, "u", bus_daemon, "RequestName", "su", name.c_str(), flags) &&
               result == is_owner;
    }
    int answer(sd_bus_message* m) noexcept;

    std::string name;
    std::string path;
    std::function<bool()> give_up;
    rt::event_fd stop;
    connection bus{false};
    message request; // waits until the card is closed
    std::optional<rt::thread> thread;
};

int reservation::impl::answer(sd_bus_message* m) noexcept
{
    std::int32_t theirs = 0;
    if (sd().message_is_method_call(m, card_interface, "RequestRelease") > 0 &&
        sd().message_read(m, "i", &theirs) > 0) {
        if (theirs <= priority || request != nullptr || !give_up || !give_up())
            return sd().reply_method_return(m, "b", 0);
        request.reset(sd().message_ref(m));
        return 1;
    }
    const char* property = nullptr;
    if (sd().message_is_method_call(m, properties, "Get") > 0 &&
        sd().message_read(m, "ss", nullptr, &property) > 0)
        return std::string_view(property) == "Priority" ? sd().reply_method_return(m, "v", "i", priority)
                                                        : sd().reply_method_return(m, "v", "s", "tactor");
    return 0; // sd-bus replies that there is no such method
}

reservation::reservation(std::unique_ptr<impl> i) : impl_(std::move(i))
{
}

reservation::~reservation()
{
    impl_->stop.signal();
    impl_->thread.reset();
    // Releases the name before the reply, because the other program takes the name as soon as the reply
    // arrives.
    impl_->bus.call(bus_daemon, "ReleaseName", "s", impl_->name.c_str());
    if (impl_->request != nullptr)
        sd().reply_method_return(impl_->request.get(), "b", 1);
    impl_->request.reset();
}

std::unique_ptr<reservation> reservation::take(unsigned card_index, std::function<bool()> give_up,
                                               std::string& holder)
try {
    constexpr std::uint32_t replace = 2;
    constexpr std::uint32_t do_not_queue = 4;
    auto i = std::make_unique<impl>(card_index, std::move(give_up));
    const auto answer = [](sd_bus_message* m, void* self, sd_bus_error*) noexcept {
        return static_cast<impl*>(self)->answer(m);
    };
    if (i->bus.get() == nullptr ||
        sd().add_object(i->bus.get(), nullptr, i->path.c_str(), answer, i.get()) < 0 ||
        i->request_name(do_not_queue)) // the program that holds the card does not reserve cards
        return nullptr;
    const remote card{i->name.c_str(), i->path.c_str(), card_interface};
    const char* text = nullptr;
    int agrees = 0;
    if (i->bus.ask(&text, "vs", {card.name, card.path, properties}, "Get", "ss", card_interface,
                   "ApplicationName"))
        holder = text;
    if (!i->bus.ask(&agrees, "b", card, "RequestRelease", "i", priority) || agrees == 0 ||
        !i->request_name(do_not_queue | replace))
        return nullptr;
    i->thread.emplace(rt::thread_options{.name = "tactor-bus"},
                      [p = i.get()] { p->bus.process_until(p->stop, [](bool) {}); });
    return std::unique_ptr<reservation>(new reservation(std::move(i)));
} catch (const std::system_error&) { // no descriptors or threads left
    return nullptr;
}

struct sleep_watch::impl {
    explicit impl(std::function<void(bool)> c) : change(std::move(c)) {}

    /// Takes the lock that delays sleep. Returns false if logind grants none.
    bool lock() noexcept
    {
        int fd = -1; // the message closes it
        if (!bus.ask(&fd, "h", login, "Inhibit", "ssss", "sleep", "tactor", "switches the amplifier off",
                     "delay"))
            return false;
        delay = detail::owned_fd(::fcntl(fd, F_DUPFD_CLOEXEC, 0));
        bus.forget_reply();
        return true;
    }
    /// Acts when the system is about to sleep or has woken. sd-bus makes no calls inside a handler.
    void follow(bool connected) noexcept
    {
        is_asleep = is_asleep && connected; // without logind, nobody tells that the system has woken
        while (is_asleep != was_asleep) {
            was_asleep = is_asleep;
            change(is_asleep);
            if (is_asleep)
                delay = {};
            else
                lock();
        }
    }

    static constexpr remote login{"org.freedesktop.login1", "/org/freedesktop/login1",
                                  "org.freedesktop.login1.Manager"};
    std::function<void(bool)> change;
    bool is_asleep = false; ///< as logind said last
    bool was_asleep = false;
    rt::event_fd stop;
    connection bus{true};
    detail::owned_fd delay;
    std::optional<rt::thread> thread;
};

sleep_watch::sleep_watch(std::function<void(bool asleep)> change)
{
    const auto prepare = [](sd_bus_message* m, void* self, sd_bus_error*) noexcept {
        int begins = 0;
        if (sd().message_read(m, "b", &begins) > 0)
            static_cast<impl*>(self)->is_asleep = begins != 0;
        return 0;
    };
    constexpr const remote& login = impl::login;
    try {
        impl_ = std::make_unique<impl>(std::move(change));
        impl* const p = impl_.get();
        if (p->bus.get() != nullptr &&
            sd().match_signal(p->bus.get(), nullptr, login.name, login.path, login.interface,
                              "PrepareForSleep", prepare, p) >= 0 &&
            p->lock())
            p->thread.emplace(rt::thread_options{.name = "tactor-sleep"}, [p] {
                p->bus.process_until(p->stop, [p](bool connected) { p->follow(connected); });
            });
    } catch (const std::system_error&) { // no descriptors or threads left
    }
}

sleep_watch::~sleep_watch()
{
    if (impl_ != nullptr)
        impl_->stop.signal();
}

} // namespace tactor::desktop
