// TOML reader that checks types, ranges and keys. Every error has a line and a column.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <toml++/toml.h>

#include <tactor/error.hpp>
#include <tactor/path.hpp>

#include "core/bounds.hpp"
#include "core/kind_names.hpp"
#include "core/path/shape.hpp"
#include "files/text_file.hpp"

namespace tactor::detail {

/// Hints for a document that is not TOML.
struct toml_hints {
    std::string_view manual = "tactor.toml(5)";
    std::string_view kinds = {}; ///< hint for other kinds of text; empty: see refuse_non_text()
};

/// Parses a document. `name` is the name of the file in messages.
/// \throws error (bad_input) with file, line and column.
toml::table parse_toml(std::string_view text, const std::string& name, const toml_hints& hints = {});

/// Allowed rotations and angles, degrees.
inline constexpr bounds turn_deg{-3600.0, 3600.0};

/// A table of a document. The document and the file's name must outlive this object.
class toml_table {
public:
    /// Constructs a view of a table. `title` names the table in messages, e.g. "[output]".
    toml_table(const toml::table& t, std::string title, const std::string& file);

    /// Refuses keys that are not in `known`. \throws error that suggests the most similar known key.
    void refuse_other_keys(const std::vector<std::string_view>& known) const;

    /// A key of the table with its value.
    struct key_value {
        std::string_view key;
        const toml::node* value = nullptr;
        source_place key_at;
    };
    /// Returns the keys in the order of the file.
    std::vector<key_value> entries() const;

    bool has(std::string_view key) const { return node(key) != nullptr; }
    const std::string& title() const noexcept { return title_; }

    source_place where() const { return where(*table_); } ///< start of the table
    source_place where(std::string_view key) const;       ///< start of a key's value
    source_place where(const toml::node& n) const;

    /// Return the value of a key, or nothing if the key is missing. All throw error for a value of the wrong
    /// type or out of range.
    std::optional<double> number(std::string_view key, bounds b) const;
    std::optional<unsigned> whole(std::string_view key, unsigned low, unsigned high) const;
    std::optional<unsigned> whole(std::string_view key, bounds b) const
    {
        return whole(key, static_cast<unsigned>(b.low), static_cast<unsigned>(b.high));
    }
    std::optional<bool> boolean(std::string_view key) const;
    std::optional<std::string> text(std::string_view key) const; ///< a text that is not empty
    std::optional<std::string> choice(std::string_view key, const std::vector<std::string_view>& of) const;
    /// Reads the name of an enumeration's value, and returns the value.
    template <class Kind>
    std::optional<Kind> kind(std::string_view key) const
    {
        const auto name = choice(key, kind_names<Kind>());
        return name ? find_kind<Kind>(*name) : std::nullopt;
    }
    /// Returns a table, or nothing if the key is missing. If the value has another type, the error shows
    /// `example`.
    std::optional<toml_table> table(std::string_view key, std::string title, std::string_view example) const;
    /// Returns the tables of an array of tables, [[key]]. The list is empty if the key is missing.
    std::vector<toml_table> tables(std::string_view key) const;
    const toml::array* list(std::string_view key, std::string_view of_what) const;
    /// Returns a list of at most `most` texts. It is empty if the key is missing.
    std::vector<std::string> texts(std::string_view key, std::size_t most) const;
    const toml::node* node(std::string_view key) const { return table_->get(key); }

    /// Reads mirror and rotate_deg, which array and stroke files have in common. Returns the map that first
    /// scales by `scale`, then mirrors, then rotates about the origin.
    affine turn(double scale = 1.0) const;
    /// Reads [x, y] in mm.
    std::optional<point> place(std::string_view key) const;
    /// Returns a list after checking that it has two values.
    const toml::array& pair(const toml::node& entry, std::string_view called) const;
    point to_point(const toml::node& xy, std::string_view called) const;
    /// Reads a flag, a number or a text. Refuses integers that a double cannot represent.
    std::variant<std::monostate, bool, double, std::string> read_scalar(const toml::node& n,
                                                                        std::string_view called) const;
    double to_number(const toml::node& n, std::string_view called, bounds b) const;
    /// Returns the value of a required key.
    /// \throws error if the key is missing.
    template <class T>
    T need(std::optional<T> value, std::string_view key) const
    {
        if (!value)
            refuse_missing_key(key);
        return *std::move(value);
    }

    /// Returns the only key of `keys` that the table has.
    /// \throws error if the table has none of the keys or more than one.
    std::string_view one_of(const std::vector<std::string_view>& keys) const;

    /// Returns make(). Errors from make() get the key and its place.
    template <class F>
    auto add_key_to_errors(std::string_view key, F make) const
    {
        try {
            return make();
        } catch (const error& e) {
            fail(key, e.what(), {});
        }
    }

    [[noreturn]] void fail(std::string_view why, std::string_view hint = {}) const;
    [[noreturn]] void fail(std::string_view key, std::string_view why, std::string_view hint) const;

private:
    [[noreturn]] void refuse_missing_key(std::string_view key) const;
    [[noreturn]] void refuse_type(std::string_view called, const toml::node& n, std::string_view want) const;

    const toml::table* table_;
    std::string title_;
    const std::string* file_;
};

/// Returns a value in the form for messages: 12.5, 'text', "a list".
std::string shown(const toml::node& n);

[[noreturn]] void fail_at(const source_place& at, std::string_view why, std::string_view hint = {},
                          std::string_view field = {});

} // namespace tactor::detail
